//! The vibration of whole moves in the closed loop: an adaptive move is at no instant worse than one that is not.

use proptest::prelude::*;
use quell::closed_loop::{MoveTrace, Scenario};
use quell::estimators::{ESTIMATORS, EstimatorEntry};
use quell::plant::{Robot, SimulationOptions};
use quell_shapers::{Mode, SHAPERS, Shaper};

/// The bound up to which the field takes vibration for none: 5 % of the unshaped.
const WORSE: f64 = 0.05;
/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;

#[derive(Clone, Debug)]
struct Case {
    degrees: f64,
    velocity: f64,
    belief_error: f64,
    shaper: usize,
    estimator: usize,
    control_rate: f64,
    seed: u64,
}

impl Case {
    fn scenario(&self) -> Scenario {
        let mut robot = Robot::rx170();
        robot.control_rate = self.control_rate;
        let joint = robot.default_move.joint;
        let truth = robot.joints[joint].modes[0].mode;
        let mut limits = robot.joints[joint].limits;
        limits.velocity = limits.velocity.min(self.velocity.to_radians());
        let belief = truth.natural_frequency() * (1.0 + self.belief_error);
        Scenario {
            joint,
            displacement: self.degrees.to_radians(),
            limits,
            simulation: SimulationOptions {
                seed: self.seed,
                ..SimulationOptions::default()
            },
            belief: Mode::new(belief, truth.damping_ratio()).expect("a mode"),
            shaper: self.shaper(),
            estimator: self.estimator(),
            robot,
        }
    }

    fn shaper(&self) -> &'static dyn Shaper {
        SHAPERS[self.shaper]
    }

    fn estimator(&self) -> &'static EstimatorEntry {
        &ESTIMATORS[self.estimator]
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let rate = prop::sample::select(vec![250.0, 500.0, 1000.0]);
    let methods = (0..SHAPERS.len(), 0..ESTIMATORS.len());
    let all = (
        1.0..360.0,
        20.0..200.0,
        -0.25..0.25,
        methods,
        rate,
        0..1000u64,
    );
    all.prop_map(
        |(degrees, velocity, belief_error, methods, control_rate, seed)| Case {
            degrees,
            velocity,
            belief_error,
            shaper: methods.0,
            estimator: methods.1,
            control_rate,
            seed,
        },
    )
}

fn peak<'a>(deformations: impl IntoIterator<Item = &'a f64>) -> f64 {
    let all = deformations.into_iter();
    all.fold(0.0, |peak: f64, deformation| peak.max(deformation.abs()))
}

fn deformation(trace: &MoveTrace) -> Vec<f64> {
    trace
        .ticks
        .iter()
        .map(|tick| tick.tip_deformation)
        .collect()
}

/// The most by which a move deforms the joint more than another, at instants at which neither accelerates as planned,
/// looked at half a period before and after; and when.
fn excess(own: &MoveTrace, other: &MoveTrace, period: f64) -> (f64, f64) {
    let half = (0.5 * period / own.period) as usize;
    let (deformed, others) = (deformation(own), deformation(other));
    let (quiet, other_quiet) = (own.quiet(), other.quiet());
    let mut worst = (0.0, 0.0);
    for k in 0..deformed.len().min(others.len()) {
        let near = &others[k.saturating_sub(half)..(k + half + 1).min(others.len())];
        let more = deformed[k].abs() - peak(near);
        if quiet[k] && other_quiet[k] && more > worst.0 {
            worst = (more, own.ticks[k].time);
        }
    }
    worst
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    /// Moves of 1 to 360 degrees, all shapers, estimators and beliefs: beside the planned acceleration the joint is
    /// never deformed by 5 % of the unshaped peak more, and no setpoint exceeds a limit.
    #[test]
    fn adaptive_is_never_worse_than_not(case in cases()) {
        let scenario = case.scenario();
        let comparison = [scenario.unshaped(), scenario.wrong_belief()];
        let [Ok(unshaped), Ok(kept)] = comparison else {
            return Err(TestCaseError::reject("a train of negative impulses exceeds the limits"));
        };
        let (first, next, truth) = scenario.adaptive().expect("the moves run");
        let most = WORSE * peak(&deformation(&unshaped));
        for (name, adaptive) in [("first", &first), ("next", &next)] {
            let (more, time) = excess(adaptive, &kept, truth.damped_period());
            prop_assert!(more <= most, "{name}: {more} m more at {time} s, {most} m allowed");
            let limits = adaptive.peak_ratios(scenario.limits);
            prop_assert!(limits.worst() <= 1.0 + ROUNDING, "{name}: {limits:?}");
            prop_assert!(adaptive.final_error() <= 1e-9, "{name} misses by {}", adaptive.final_error());
        }
    }
}
