//! What a driven axis can hide beside the catalogue: laws of one coordinate, and named ones of another shape, which
//! have the share and the numbers of the textbook's.

use super::axis::Axis;
use super::axis_effects::{self, Entry, Forces, Parameters};
use super::laws::{Bell, Detent, PowerFriction, SLIDERS, Slider};
use super::plan::Table;
use std::f64::consts::TAU;

/// What can be hidden in an axis, of one table.
pub fn entries(table: Table) -> impl Iterator<Item = &'static Entry> {
    let within = move |entry: &&Entry| match table {
        Table::Outside => [Table::Outside, Table::Strange].contains(&entry.1),
        _ => entry.1 == table,
    };
    axis_effects::ENTRIES.iter().chain(ENTRIES).filter(within)
}

const ENTRIES: &[Entry] = &[
    ("local_damper", Table::Outside, local_damper),
    ("detent", Table::Outside, detent),
    ("power_friction", Table::Outside, power_friction),
    ("maxwell_slip_friction", Table::Outside, maxwell_slip),
    ("periodic_force", Table::Outside, periodic_force),
    ("coulomb_friction", Table::Shaped, compliant_friction),
    ("cogging", Table::Shaped, cogging_with_harmonics),
];

/// What a named law has beside the textbook's, in words.
pub fn shape_of(name: &str) -> &'static str {
    match name {
        "coulomb_friction" => "over a contact with compliance",
        _ => "with harmonics",
    }
}

fn log_between(low: f64, high: f64, share: f64) -> f64 {
    low * (high / low).powf(share)
}

fn on_the_way(forces: &Forces, share: f64) -> f64 {
    let [low, high] = forces.span;
    low + (high - low) * (0.1 + 0.8 * share)
}

fn local_damper(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let height = 4.0 * share * forces.rms / forces.speed;
    let place = on_the_way(forces, shape[0]);
    let width = (forces.span[1] - forces.span[0]) * (0.03 + 0.12 * shape[1]);
    axis.laws.local_damper = Some(Bell {
        height,
        place,
        width,
    });
    vec![("damping", height), ("position", place), ("width", width)]
}

fn detent(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let depth = 3.0 * share * forces.rms;
    let place = on_the_way(forces, shape[0]);
    let width = log_between(0.004, 0.03, shape[1]);
    axis.laws.detent = Some(Detent {
        depth,
        place,
        width,
    });
    vec![("force", depth), ("position", place), ("width", width)]
}

/// A power well apart from 0 (Coulomb) and 1 (viscous).
fn power_friction(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let power = match shape[0] {
        low if low < 0.5 => 0.4 + 0.7 * low,
        high => 1.0 + 0.6 * high,
    };
    let coefficient = 1.5 * share * forces.rms / forces.speed.powf(power);
    axis.laws.power_friction = Some(PowerFriction {
        coefficient,
        power,
        linear_below: 0.01 * forces.speed,
    });
    vec![("coefficient", coefficient), ("power", power)]
}

/// Sliders that give way after 0.2 to 20 mm, of unequal strength.
fn maxwell_slip(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let slider = |k: usize| {
        let draw = shape[k % 3];
        let level = share * forces.rms / SLIDERS as f64 * (0.5 + draw);
        let distance = log_between(2e-4, 2e-2, (k as f64 + draw) / SLIDERS as f64);
        Slider {
            stiffness: level / distance,
            time_constant: 5e-4,
            level,
        }
    };
    axis.laws.sliders = (0..SLIDERS).map(slider).collect();
    let friction = axis.laws.sliders.iter().map(|slider| slider.level).sum();
    vec![("friction", friction), ("elements", SLIDERS as f64)]
}

/// Four harmonics of about the same size.
fn periodic_force(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let order = TAU / (0.05 + 0.15 * shape[0]);
    let wave = |k: usize| {
        let draw = (shape[1] + 0.382 * k as f64).fract();
        let amplitude = share * forces.rms * (0.6 + 0.4 * draw);
        [
            amplitude,
            order * (k + 1) as f64,
            TAU * (7.0 * draw).fract(),
        ]
    };
    axis.laws.waves = (0..4).map(wave).collect();
    vec![
        ("force", share * forces.rms),
        ("order", order),
        ("harmonics", 4.0),
    ]
}

/// Coulomb's friction over a contact that bends by 20 to 500 um before it slides.
fn compliant_friction(axis: &mut Axis, forces: &Forces, share: f64, shape: [f64; 3]) -> Parameters {
    let friction = share * forces.rms;
    let distance = log_between(2e-5, 5e-4, shape[0]);
    let time_constant = log_between(5e-4, 4e-3, shape[1]);
    axis.laws.sliders = vec![Slider {
        stiffness: friction / distance,
        time_constant,
        level: friction,
    }];
    vec![
        ("friction", friction),
        ("contact_deflection", distance),
        ("contact_time_constant", time_constant),
    ]
}

/// The second and the third harmonic beside the first wave.
fn cogging_with_harmonics(
    axis: &mut Axis,
    forces: &Forces,
    share: f64,
    shape: [f64; 3],
) -> Parameters {
    let (pitch, phase) = (0.02 + 0.06 * shape[0], TAU * shape[1]);
    let (amplitude, order) = (share * forces.rms * 2f64.sqrt(), TAU / pitch);
    let shares = [0.3 + 0.4 * shape[2], 0.15 + 0.3 * shape[1]];
    axis.cogging = [amplitude, order, phase];
    axis.laws.waves = vec![
        [amplitude * shares[0], 2.0 * order, phase + TAU * shape[2]],
        [amplitude * shares[1], 3.0 * order, phase + TAU * shape[0]],
    ];
    vec![
        ("amplitude", amplitude),
        ("order", order),
        ("second_harmonic", shares[0]),
        ("third_harmonic", shares[1]),
    ]
}
