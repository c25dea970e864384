//! Programmes of moves in which a sensor fails: what was refused, and what became of the robot.

use std::fmt::Write;

use quell::estimators::ESTIMATORS;
use quell::plant::{Damping, Robot};
use quell::service::contract::Quantity;
use quell_shapers::{Mode, shaper_by_name};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::fault::{Fault, Kind, Sensor};
use super::rig::{JointCase, Ran, run};

/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;
/// Vibration below which a move counts as one that left as much, m: what noise of 10 um lets a tracker
/// tell, at three standard deviations.
const FLOOR: f64 = 30e-6;
/// Moves of a programme.
const MOVES: usize = 5;

/// The outcome for the robot under one fault.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub kind: Kind,
    pub case: String,
    pub refused: bool,
    pub noticed: bool,
    /// Whether the joint whose sensor failed shapes for a mode that is off by more than a tenth.
    pub misled: bool,
    /// Residual of each move after the fault's beginning over that of the move unshaped.
    pub ratios: Vec<f64>,
    pub missed: f64,
    /// Largest peak of a command over what is allowed.
    pub peak: f64,
}

/// One programme.
pub fn case(kind: Kind, number: u64) -> Outcome {
    let mut random = ChaCha8Rng::seed_from_u64(number * Kind::ALL.len() as u64 + kind as u64);
    let mut robot = Robot::rx170();
    robot.control_rate = [250.0, 500.0][random.random_range(0..2)];
    robot.encoder.rate = robot.control_rate;
    let axes = if random.random_bool(0.7) { 1 } else { 3 };
    let cases: Vec<_> = (0..axes).map(|_| joint(&robot, &mut random)).collect();
    // A move of the programme takes about a second.
    let duration = MOVES as f64 * (1.0 + cases[0].rest);
    let fault = Fault::draw(kind, duration, axes, cases[0].sensor, random);
    let from = fault.from;
    let case = describe(kind, number, &cases[0], &fault);
    let unshaped = run(&robot, &cases, None, false).expect(&case);
    let shaped = run(&robot, &cases, Some(fault), true).expect(&case);
    let both = || {
        unshaped
            .iter()
            .zip(&shaped)
            .flat_map(|(a, b)| a.moves.iter().zip(&b.moves))
    };
    let hit = both().filter(|(_, moved)| moved.end > from);
    let off = shaped[0].mode.natural_frequency() / cases[0].truth.natural_frequency() - 1.0;
    Outcome {
        kind,
        case,
        refused: shaped.iter().any(|ran: &Ran| ran.refused > 0),
        noticed: shaped.iter().any(|ran| ran.frozen || ran.silent),
        misled: shaped[0].retunes > 0 && off.abs() > 0.1,
        ratios: hit
            .map(|(a, b)| b.residual / a.residual.max(FLOOR))
            .collect(),
        missed: both().map(|(_, moved)| moved.missed).fold(0.0, f64::max),
        peak: shaped.iter().map(|ran| ran.peak).fold(0.0, f64::max),
    }
}

fn joint(robot: &Robot, random: &mut ChaCha8Rng) -> JointCase {
    let frequency: f64 = 3.0 * (20.0f64 / 3.0).powf(random.random_range(0.0..1.0));
    let damping = random.random_range(0.02..0.15);
    let mode = |frequency, damping| Mode::from_hertz(frequency, damping).expect("a mode");
    let truth = mode(frequency, damping);
    let radius = robot.arc(&robot.home(), 0).expect("an arc").radius();
    let quantities = [
        Quantity::TipPosition,
        Quantity::LinkPosition,
        Quantity::Deformation,
    ];
    let target = |random: &mut ChaCha8Rng| random.random_range(-0.6..0.6);
    JointCase {
        truth,
        damping: [Damping::AcrossJoint, Damping::ToGround][random.random_range(0..2)],
        belief: mode(
            frequency * random.random_range(0.75..1.25),
            (damping * random.random_range(0.5..1.5f64)).min(0.2),
        ),
        shaper: shaper_by_name(["zv", "zvd", "ei"][random.random_range(0..3)]).expect("a shaper"),
        estimator: &ESTIMATORS[random.random_range(0..ESTIMATORS.len())],
        sensor: Sensor {
            quantity: quantities[random.random_range(0..3)],
            noise: random.random_range(5e-6..50e-6) / radius,
            radius,
        },
        targets: (0..MOVES).map(|_| target(random)).collect(),
        // Until a thirtieth is left of what rings, and no longer than 6 s.
        rest: (3.5 / truth.decay_rate()).min(6.0),
        seed: random.random(),
    }
}

fn describe(kind: Kind, number: u64, case: &JointCase, fault: &Fault) -> String {
    format!(
        "{} {number}: {:.1} Hz {:.3}, belief {:.1} Hz, {}, {}, {:?}, {:?}, {fault}",
        kind.name(),
        case.truth.hertz(),
        case.truth.damping_ratio(),
        case.belief.hertz(),
        case.shaper.name(),
        case.estimator.name,
        case.damping,
        case.sensor.quantity,
    )
}

impl Outcome {
    pub fn worst(&self) -> f64 {
        self.ratios.iter().copied().fold(0.0, f64::max)
    }

    /// Whether limits and target were kept.
    pub fn is_kept(&self) -> bool {
        self.peak <= 1.0 + ROUNDING && self.missed <= ROUNDING
    }
}

/// So many programmes of each kind of fault.
pub fn campaign(from: u64, programmes: u64) -> Vec<Outcome> {
    let all = Kind::ALL.map(|kind| (from..from + programmes).map(move |number| (kind, number)));
    let all: Vec<_> = all.into_iter().flatten().collect();
    all.into_par_iter()
        .map(|(kind, number)| case(kind, number))
        .collect()
}

/// One line for each kind of fault, in Markdown.
pub fn table(outcomes: &[Outcome]) -> String {
    let mut text = String::from(
        "| fault | programmes | samples refused | noticed | misled | median left | 99 % | worst | \
         limits, target |\n|---|---|---|---|---|---|---|---|---|\n",
    );
    for kind in Kind::ALL {
        let of: Vec<_> = outcomes
            .iter()
            .filter(|outcome| outcome.kind == kind)
            .collect();
        let percent = |holds: fn(&Outcome) -> bool| {
            let count = of.iter().filter(|outcome| holds(outcome)).count();
            100.0 * count as f64 / of.len().max(1) as f64
        };
        let mut ratios: Vec<_> = of
            .iter()
            .flat_map(|outcome| outcome.ratios.clone())
            .collect();
        ratios.sort_by(f64::total_cmp);
        let at = |share: f64| {
            let last = ratios.len().saturating_sub(1);
            ratios
                .get((share * last as f64) as usize)
                .copied()
                .unwrap_or(f64::NAN)
        };
        let kept = of.iter().filter(|outcome| outcome.is_kept()).count();
        let _ = writeln!(
            text,
            "| {} | {} | {:.0} % | {:.0} % | {:.0} % | {:.3} | {:.2} | {:.2} | kept in {kept} |",
            kind.name(),
            of.len(),
            percent(|outcome| outcome.refused),
            percent(|outcome| outcome.noticed),
            percent(|outcome| outcome.misled),
            at(0.5),
            at(0.99),
            at(1.0),
        );
    }
    text
}
