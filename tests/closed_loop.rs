//! Controller and simulated arm in a loop: what adaptation leaves of the vibration, and that the
//! tick does not allocate.

use quell::closed_loop::{Comparison, MoveKind, Scenario};
use quell::plant::{Damping, Robot, SimulationOptions};
use quell_shapers::{Mode, shaper_by_name};
use rayon::prelude::*;

/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;

fn scenario(error: f64, damping: Damping, noise: f64, shaper: &str, seed: u64) -> Scenario {
    let robot = Robot::rx170();
    let truth = robot.joints[robot.default_move.joint].modes[0].mode;
    let frequency = truth.natural_frequency() * (1.0 + error);
    let belief = Mode::new(frequency, truth.damping_ratio()).expect("a mode");
    Scenario {
        simulation: SimulationOptions {
            seed,
            damping: Some(damping),
            tracker_noise: Some(noise),
            ..SimulationOptions::default()
        },
        shaper: shaper_by_name(shaper).expect("a shaper"),
        ..Scenario::new(robot, belief)
    }
}

fn check(scenario: &Scenario, comparison: &Comparison, case: &str) {
    let percent = |kind| 100.0 * comparison.ratio(kind);
    let (first, next) = (
        percent(MoveKind::AdaptiveFirst),
        percent(MoveKind::AdaptiveNext),
    );
    let miss = comparison
        .moves()
        .fold(0.0, |most: f64, (_, trace)| most.max(trace.final_error()));
    println!("{case}: first {first:.2} %, next {next:.2} %, miss {miss:.1e} rad");
    // Measured: 0.39 % and 1.04 % in the worst case.
    assert!(first <= 0.6, "{case}: {first} % within the first move");
    assert!(next <= 1.5, "{case}: {next} % on the next move");
    for (kind, trace) in comparison.moves() {
        let name = kind.name();
        assert!(trace.final_error() <= 1e-9, "{case}: {name} misses");
        let worst = trace.peak_ratios(scenario.limits).worst();
        assert!(
            worst <= 1.0 + ROUNDING,
            "{case}: {name} reaches {worst} of a limit"
        );
    }
}

#[test]
fn adaptation_quells_the_vibration_over_errors_conventions_and_noise() {
    let mut cases = Vec::new();
    for error in [-0.25, -0.1, 0.0, 0.1, 0.25] {
        for damping in [Damping::AcrossJoint, Damping::ToGround] {
            for noise in [5e-6, 10e-6, 20e-6] {
                for shaper in ["zv", "zvd"] {
                    cases.push((error, damping, noise, shaper));
                }
            }
        }
    }
    cases
        .into_par_iter()
        .enumerate()
        .for_each(|(seed, (error, damping, noise, shaper))| {
            let scenario = scenario(error, damping, noise, shaper, seed as u64);
            let comparison = scenario.run().expect("the moves run");
            let case = format!("{shaper}, {error:+.2}, {damping:?}, {:.0} um", noise * 1e6);
            check(&scenario, &comparison, &case);
        });
}
