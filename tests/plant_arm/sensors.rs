//! Readings of the simulated sensors: rates, resolution, noise, and the deformation they show.

use super::{arm, hold, jerk_limited};
use proptest::prelude::*;
use quell::plant::{Command, MeasurementLog, Robot, SimulationOptions};
use quell::recording::Role;
use quell::signal::Measurement;
use std::f64::consts::FRAC_PI_6;

/// On-line deformation against the truth, noise-free and unquantised: what is left is the
/// interpolation of the encoder.
#[test]
fn val_online_deformation_follows_the_truth_through_the_move() {
    let mut robot = Robot::rx170();
    robot.encoder.resolution = 0.0;
    let limits = robot.joints[0].limits;
    let (_, profile) = jerk_limited(FRAC_PI_6, limits.acceleration, limits.jerk);
    let options = SimulationOptions {
        tracker_noise: Some(0.0),
        ..Default::default()
    };
    let mut arm = arm(&robot, options);
    let mut sensor = robot.deformation_sensor(&robot.home(), 0).unwrap();
    let (mut truth, mut samples) = (vec![(0.0, 0.0)], Vec::new());
    for k in 1..=6000 {
        let (position, velocity) = profile(0.00025 * f64::from(k) - 0.1);
        arm.step(
            Command {
                position,
                velocity: Some(velocity),
            },
            0.00025,
        );
        for &measurement in arm.last_measurements() {
            sensor.observe(measurement);
            while let Some(sample) = sensor.next_sample() {
                samples.push(sample);
            }
        }
        truth.push((arm.time(), arm.true_tip_deformation()));
    }
    assert!(
        samples.len() > 490,
        "{} samples in 1.5 s at 333 Hz",
        samples.len()
    );
    let worst = samples.iter().map(|sample| {
        let k = (sample.time / 0.00025) as usize;
        let ((t0, d0), (t1, d1)) = (truth[k], truth[(k + 1).min(truth.len() - 1)]);
        let exact = d0 + (d1 - d0) * (sample.time - t0) / (t1 - t0);
        (sample.tip_deformation - exact).abs()
    });
    // h^3 times the jerk's step (80 rad/s^3) over 16 at 1.82 m is 0.6 um; linear interpolation of the
    // encoder would be 36 um off.
    let worst = worst.fold(0.0, f64::max);
    assert!(worst < 0.6e-6, "{} um", worst * 1e6);
}

#[test]
fn val_quantisation_and_noise_have_their_statistics() {
    let robot = Robot::rx170();
    let mut arm = arm(
        &robot,
        SimulationOptions {
            seed: 3,
            ..Default::default()
        },
    );
    let mut log = MeasurementLog::new();
    for k in 1..=2500 {
        let position = 1e-4 * 0.004 * f64::from(k);
        log.step(
            &mut arm,
            Command {
                position,
                velocity: Some(1e-4),
            },
            0.004,
        );
    }
    let recording = log.into_recording("slow");
    let step = robot.encoder.resolution;
    let encoder = recording.channel(Role::MotorPosition).unwrap();
    for x in &encoder.columns[0] {
        assert!(((x / step).round() - x / step).abs() < 1e-6);
    }
    let tracker = recording.channel(Role::TipPosition).unwrap();
    assert_eq!(tracker.time.len(), 3330);
    // Second difference of a straight line in noise of standard deviation s: variance 6 s^2, known
    // to sqrt(35/18 / n) relative; 3 standard deviations.
    let n = 3.0 * 3328.0;
    let sum: f64 = tracker
        .columns
        .iter()
        .flat_map(|c| c.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2)))
        .sum();
    let ratio = sum / n / 6.0 / robot.tracker.noise.powi(2);
    assert!(
        (ratio - 1.0).abs() < 3.0 * (35.0 / 18.0 * 2.0 / n).sqrt(),
        "{ratio}"
    );
}

#[test]
fn same_seed_same_measurements_to_the_bit() {
    let robot = Robot::rx170();
    let run = |seed| {
        let mut arm = arm(
            &robot,
            SimulationOptions {
                seed,
                ..Default::default()
            },
        );
        let mut log = MeasurementLog::new();
        for k in 1..=100 {
            let position = 0.001 * f64::from(k);
            log.step(
                &mut arm,
                Command {
                    position,
                    velocity: None,
                },
                0.004,
            );
        }
        log.into_recording("run")
    };
    assert_eq!(run(7), run(7));
    assert_ne!(run(7), run(8));
}

proptest! {
    /// Sensors keep their own rates whatever the control period.
    #[test]
    fn sensors_keep_their_rates(period in 0.00025..0.004f64) {
        let robot = Robot::rx170();
        let mut arm = arm(&robot, SimulationOptions::default());
        let mut log = Vec::new();
        while arm.time() < 1.0 {
            log.extend_from_slice(arm.step(hold(0.0), period));
        }
        let is_motor = |m: &&Measurement| matches!(m, Measurement::MotorPosition { .. });
        let encoder = log.iter().filter(is_motor).count() as f64;
        let tracker = log.len() as f64 - encoder;
        // Time ends up to one period after 1 s.
        prop_assert!((250.0..=252.0).contains(&encoder), "{encoder}");
        prop_assert!((332.0..=335.0).contains(&tracker), "{tracker}");
    }
}
