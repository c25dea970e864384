//! The paper's table on the embedded arm: R. Delpoux, R. Bearee, A. Olabi, O. Gibaru, "Toward on-line
//! robot vibratory modes estimation", American Control Conference 2014, sections IV-B and IV-C.
//!
//! The unshaped 30 degree move of joint 1, encoder at 250 Hz, tracker at 333 Hz with 10 um of noise;
//! the methods of the paper see the free decay only, through frames and clocks that are registered
//! from the same recording.

use quell::closed_loop::Scenario;
use quell::estimators::offline::log_decrement;
use quell::estimators::{Estimate, estimator};
use quell::identification::{NominalModel, Prior, Run, identify, prepare};
use quell::plant::{Robot, SimulationOptions};
use quell::signal::TipRegistration;
use quell_shapers::{Mode, shaper_by_name};
use quell_trajectories::Limits;

const SEEDS: u64 = 15;

/// The best free decay of the unshaped move, identified by every method.
fn free_decay(seed: u64) -> Run {
    let robot = Robot::rx170();
    let joint = robot.default_move.joint;
    let own = robot.joints[joint].limits;
    let belief = robot.joints[joint].modes[0].mode;
    let scenario = Scenario {
        joint,
        displacement: robot.default_move.target,
        limits: Limits {
            velocity: own.velocity,
            acceleration: own.acceleration,
            jerk: own.jerk,
        },
        simulation: SimulationOptions {
            seed,
            ..SimulationOptions::default()
        },
        belief,
        shaper: shaper_by_name("zvd").unwrap(),
        estimator: estimator("likelihood").unwrap(),
        robot,
    };
    let trace = scenario.unshaped().unwrap();
    let model = NominalModel {
        mode: Mode::from_hertz(8.5, 0.07).unwrap(),
        lever_arm: Some(trace.arc.radius()),
        tip_height: trace.arc.centre().z,
    };
    let series = prepare(trace.recording.clone(), Some(&model), TipRegistration::Arc).unwrap();
    let prior = Prior {
        belief: Some(model.mode),
        scale_is_open: series.scale_is_open,
        rounding: 0.0,
    };
    let mut found = identify(&series.samples, prior).unwrap();
    let best = found.best_decay.expect("the arm rings out");
    found.free_decays.swap_remove(best)
}

/// Seconds from the start of the decay until the estimate is within 2 % of f and 0.02 of xi, and
/// stays there for the three periods in which the vibration stands well above the noise.
fn entry(run: &Run, history: &[Estimate]) -> f64 {
    let inside = |estimate: &Estimate| {
        (estimate.mode.hertz() / 8.12 - 1.0).abs() < 0.02
            && (estimate.mode.damping_ratio() - 0.084).abs() < 0.02
    };
    let start = run.counted_from;
    let seen: Vec<_> = history
        .iter()
        .filter(|estimate| estimate.time < start + 3.0 / 8.12)
        .collect();
    match seen.iter().rposition(|estimate| !inside(estimate)) {
        Some(last) => seen
            .get(last + 1)
            .map_or(f64::INFINITY, |first| first.time - start),
        None => 0.0,
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[test]
fn val_table_of_the_paper() {
    let runs: Vec<Run> = (0..SEEDS).map(free_decay).collect();
    let of = |name: &str, value: &dyn Fn(&Run, &[Estimate], Estimate) -> f64| {
        let values = runs.iter().filter_map(|run| {
            let result = run.on_line.iter().find(|result| result.name == name)?;
            Some(value(run, &result.history, result.estimate?))
        });
        median(values.collect())
    };
    let table = |name: &str| {
        let hertz = of(name, &|_, _, estimate| estimate.mode.hertz());
        let damping = of(name, &|_, _, estimate| estimate.mode.damping_ratio());
        let entry = of(name, &|run, history, _| entry(run, history));
        println!("{name}: {hertz:.3} Hz, {damping:.4}, entry {entry:.3} s");
        (hertz, damping, entry)
    };
    // The paper: 8.12 Hz, 8.4 %, around 0.12 s; its figures have these digits.
    let (hertz, damping, entry) = table("algebraic_paper");
    assert!((hertz - 8.12).abs() < 0.03, "{hertz} Hz");
    assert!((damping - 0.084).abs() < 0.003, "{damping}");
    assert!((0.08..0.14).contains(&entry), "{entry} s");
    // The paper: the same figures, around 0.07 s. At 333 Hz the filter that reads the equivalent
    // injection and the noise cost more than that, and leave a bias below 1 % and one point.
    let (hertz, damping, entry) = table("super_twisting");
    assert!((hertz - 8.12).abs() < 0.08, "{hertz} Hz");
    assert!((damping - 0.084).abs() < 0.01, "{damping}");
    assert!((0.05..0.15).contains(&entry), "{entry} s");
    // The paper: 8.13 Hz from the Fourier transform.
    for (method, tolerance) in [("fourier", 0.03), ("batch_fit", 0.02)] {
        let values = runs.iter().filter_map(|run| {
            let found = run.off_line.iter().find(|found| found.method == method)?;
            Some(found.mode.hertz())
        });
        let hertz = median(values.collect());
        println!("{method}: {hertz:.3} Hz");
        assert!((hertz - 8.12).abs() < tolerance, "{method}: {hertz} Hz");
    }
}

#[test]
fn val_damping_from_two_peaks() {
    // Eq. (25): d1 = 0.74 mm and d2 = 0.43 mm give 8.6 %.
    assert!((log_decrement(0.74, 0.43) - 0.08608).abs() < 5e-6);
}
