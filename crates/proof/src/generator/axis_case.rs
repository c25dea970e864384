//! A case of a driven axis.

use super::axis::{Axis, Driven};
use super::axis_effects::{ENTRIES, Forces};
use super::integrate::integrate;
use super::programme::{Programme, Style};
use super::random::Draw;
use super::recorded::rounded;
use super::sensors::{Colour, Noise};
use super::size::SHARES;
use super::{Case, Oracle, Plan};
use crate::families::family;
use crate::truth::{HiddenEffect, Truth};
use quell_recording::{Channel, Recording, Role};
use quell_trajectories::PlanError;
use serde_json::json;
use std::f64::consts::TAU;

/// Step of the integration, s.
const STEP: f64 = 1e-4;

pub(super) fn generate(draw: &mut Draw) -> Result<Case, PlanError> {
    let plan = Plan::draw(draw);
    let mut axis = axis(draw);
    let style = Style {
        natural_frequency: draw.uniform(20.0, 60.0),
        acceleration: draw.log_uniform(0.8, 5.0),
        velocity: draw.uniform(0.2, 0.8),
        range: draw.uniform(0.1, 0.4),
        rich: true,
    };
    let (train, test) = (
        Programme::draw(draw, &style)?,
        Programme::draw(draw, &style)?,
    );
    let model = model(draw, &axis);
    let nominal = [axis.mass, axis.viscous];
    let effects = conceal(draw, plan, &mut axis, &train);
    let rate = draw.pick(&[500.0, 1000.0]).copied().unwrap_or(1000.0);
    let noise = Noise {
        std: draw.uniform(5e-6, 2e-5),
        colour: if draw.chance(0.6) {
            Colour::White
        } else {
            Colour::Quantised
        },
    };
    let truth = truth(&noise, effects, nominal);
    let (recorded, _) = record(draw, &axis, &train, (rate, &noise), "train");
    let (tested, predicted) = record(draw, &axis, &test, (rate, &noise), "test");
    Ok(Case {
        model,
        train: recorded,
        test: tested,
        truth,
        oracle: Oracle::Axis { predicted },
    })
}

fn axis(draw: &mut Draw) -> Axis {
    let mass = draw.log_uniform(5.0, 200.0);
    Axis {
        mass,
        viscous: mass / draw.log_uniform(0.2, 2.0),
        believed_mass: mass * draw.uniform(0.85, 1.15),
        bandwidth: TAU * draw.uniform(4.0, 12.0),
        ..Axis::default()
    }
}

fn conceal(
    draw: &mut Draw,
    plan: Plan,
    axis: &mut Axis,
    programme: &Programme,
) -> Vec<HiddenEffect> {
    let forces = forces(axis, programme);
    let (count, known) = plan.effects();
    let mut hidden: Vec<HiddenEffect> = Vec::new();
    while hidden.len() < count {
        let strange = |name: &str| {
            hidden
                .iter()
                .all(|other| family(&other.effect) != family(name))
        };
        let suitable = ENTRIES
            .iter()
            .filter(|entry| entry.1 == known && strange(entry.0));
        let Some(&&(name, _, hide)) = draw.pick(&suitable.collect::<Vec<_>>()) else {
            break;
        };
        let share = draw.log_uniform(SHARES[0], SHARES[1]);
        let shape = [(); 3].map(|()| draw.uniform(0.0, 1.0));
        let parameters = hide(axis, &forces, share, shape);
        let named = parameters
            .iter()
            .map(|(name, value)| (name.to_string(), *value));
        hidden.push(HiddenEffect {
            effect: name.into(),
            place: "drive".into(),
            parameters: named.collect(),
        });
    }
    hidden
}

fn run(axis: &Axis, programme: &Programme, times: &[f64], shows_impulse: bool) -> Vec<f64> {
    let driven = Driven {
        axis,
        programme,
        shows_impulse,
    };
    let mut breaks: Vec<f64> = programme.corners().collect();
    breaks.sort_by(f64::total_cmp);
    integrate(&driven, [0.0; 14], STEP, &breaks, times)
}

fn forces(axis: &Axis, programme: &Programme) -> Forces {
    let spacing = 2e-3;
    let count = (programme.duration / spacing) as usize;
    let times: Vec<f64> = (1..count).map(|k| k as f64 * spacing).collect();
    let force = told(axis, programme, spacing, count - 1);
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|x| x * x).sum::<f64>() / count as f64).sqrt()
    };
    let greatest = |values: &mut dyn Iterator<Item = f64>| {
        values.fold(1e-9, |most: f64, value| most.max(value.abs()))
    };
    let level = rms(&mut force.iter().copied());
    Forces {
        rms: level,
        most: greatest(&mut force.iter().copied()),
        rate: rms(&mut force.windows(2).map(|pair| (pair[1] - pair[0]) / spacing)) / level,
        speed: greatest(&mut times.iter().map(|&t| programme.at(t)[1])),
    }
}

/// The recording, and the positions without noise.
fn record(
    draw: &mut Draw,
    axis: &Axis,
    programme: &Programme,
    (rate, noise): (f64, &Noise),
    name: &str,
) -> (Recording, Vec<f64>) {
    let count = (programme.duration * rate) as usize;
    let time: Vec<f64> = (0..count).map(|k| k as f64 / rate).collect();
    let position = run(axis, programme, &time, false);
    let mut seen = position.clone();
    noise.add(draw, &mut seen);
    let channel = |role, unit: &str, column| Channel {
        role,
        unit: unit.into(),
        time: time.clone(),
        columns: vec![column],
    };
    let force = told(axis, programme, 1.0 / rate, count);
    let force = force.iter().map(|force| rounded(*force, 1e-6)).collect();
    let channels = vec![
        channel(Role::Force, "N", force),
        channel(Role::MotorPosition, "m", seen),
    ];
    (
        Recording {
            name: name.into(),
            payload: None,
            channels,
        },
        position,
    )
}

/// The force as a drive tells it: its mean over the cycle that begins at each stamp. So a record at the
/// rate of the cycle holds all of the impulse, whatever the force does within one.
fn told(axis: &Axis, programme: &Programme, cycle: f64, count: usize) -> Vec<f64> {
    let times: Vec<f64> = (0..=count).map(|k| k as f64 * cycle).collect();
    let impulse = run(axis, programme, &times, true);
    impulse
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / cycle)
        .collect()
}

fn truth(noise: &Noise, effects: Vec<HiddenEffect>, [mass, viscous]: [f64; 2]) -> Truth {
    let in_catalogue = effects.iter().all(|effect| {
        ENTRIES
            .iter()
            .any(|entry| entry.0 == effect.effect && entry.1)
    });
    let more = json!({
        "noise_colour": noise.colour.name(),
        "programme": "rich",
        "mass": mass,
        "viscous": viscous,
    });
    // Of a linear axis it is all the same whether the force or the position is late.
    let late = effects.iter().any(|effect| effect.effect == "drive_lag");
    let equivalents = late.then(|| "sensor_lag".to_string());
    Truth {
        effects,
        equivalents: equivalents.into_iter().collect(),
        in_catalogue,
        noise: noise.std,
        noise_unit: "m".into(),
        more: more.as_object().cloned().unwrap_or_default(),
        ..Truth::default()
    }
}

fn model(draw: &mut Draw, axis: &Axis) -> String {
    let mass = axis.mass * (1.0 + draw.uniform(-0.05, 0.05));
    let viscous = axis.viscous * (1.0 + draw.uniform(-0.25, 0.25));
    format!(
        "# the nominal model: a driven axis, force in and position out\n\
         kind = \"rigid_axis\"\n\
         input_hold = \"zero_order\"\n\
         mass = {mass:.4}\n\
         viscous = {viscous:.4}\n"
    )
}
