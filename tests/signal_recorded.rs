//! Registration and rest detection on recordings made by others; skipped where they are absent.

#[path = "absent/shared.rs"]
mod shared;

use shared::shared;
use std::io::Read;
use std::path::Path;

use nalgebra::Point3;
use quell::signal::{
    CubicSpline, End, JointArc, RestRule, free_decays, register_arc, tip_deformation,
};

/// Columns of a gzipped CSV file.
fn columns(file: &Path) -> Vec<Vec<f64>> {
    let bytes = std::fs::File::open(file).unwrap();
    let mut text = String::new();
    flate2::read::GzDecoder::new(bytes)
        .read_to_string(&mut text)
        .unwrap();
    let mut columns = vec![Vec::new(); text.lines().next().unwrap().split(',').count()];
    for line in text.lines().skip(1) {
        for (column, field) in columns.iter_mut().zip(line.split(',')) {
            column.push(field.parse().unwrap());
        }
    }
    columns
}

/// An arm in a physics engine, tracker in an unknown frame on an unknown clock: out of plane and
/// radius there is nothing but the noise, and the clock comes out near the truth whatever else is
/// hidden in the arm.
#[test]
fn frame_and_clock_come_out_of_one_recorded_move() {
    let Some(truth) = shared("QUELL_CONCEALED", "concealed", "truth.json") else {
        return;
    };
    let cases = truth.with_file_name("");
    let truth = std::fs::read_to_string(truth).unwrap();
    let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
    let arc = JointArc::from_lever_arm(1.8, 0.9).unwrap();
    for (case, truth) in truth.as_object().unwrap() {
        let folder = cases.join(case).join("train");
        let encoder = columns(&folder.join("encoder.csv.gz"));
        let tracker = columns(&folder.join("tracker.csv.gz"));
        let motor = CubicSpline::new(&encoder[0], &encoder[1], End::NotAKnot).unwrap();
        let tip: Vec<Point3<f64>> = (0..tracker[0].len())
            .map(|k| Point3::new(tracker[1][k], tracker[2][k], tracker[3][k]))
            .collect();
        let found = register_arc(&arc, &motor, &tracker[0], &tip, None).unwrap();
        let samples = tip_deformation(&arc, &found, &motor, &tracker[0], &tip);
        let peak = samples
            .iter()
            .fold(0.0f64, |m, s| m.max(s.deformation.abs()));
        // Their sign of the offset: stamp = time - offset.
        let clock_error = found.clock.offset + truth["clock_offset_s"].as_f64().unwrap();
        let effect = truth["effect"].as_str().unwrap();
        let noise = truth["tracker_noise_m"].as_f64().unwrap();
        let mode = found.mode.unwrap();
        println!(
            "{case} {effect}: clock {:+.0} +- {:.0} us, normal {:.2}, radial {:.2}, tangential {:.1} um, \
             radius {:+.0} +- {:.0} um, {:.3} Hz {:.4} (truth {:.3} {:.4}), ground {}, peak {:.2} mrad",
            clock_error * 1e6,
            found.clock_offset_std * 1e6,
            found.normal_rms * 1e6,
            found.radial_rms * 1e6,
            found.tangential_rms * 1e6,
            (found.fitted_radius - 1.8) * 1e6,
            found.fitted_radius_std * 1e6,
            mode.hertz(),
            mode.damping_ratio(),
            truth["natural_frequency_hz"].as_f64().unwrap(),
            truth["damping_ratio"].as_f64().unwrap(),
            found.damper_to_ground,
            peak * 1e3,
        );
        // 2000 samples or more: the noise is known to 2 %, three standard deviations.
        assert!((found.normal_rms / noise - 1.0).abs() < 0.06, "{case}");
        // A lag of the tracker pulls the tip inside its circle.
        if effect != "sensor_lag" {
            assert!((found.radial_rms / noise - 1.0).abs() < 0.06, "{case}");
        }
        assert!((1e-3..8e-3).contains(&peak), "{case}: {peak} rad");
        // The engine's stamps are rounded to 0.1 ms and its steps to 0.25 ms; a lag of the sensor, a
        // drifting clock and a drag that grows with the velocity are indistinguishable from an offset.
        if !["sensor_lag", "clock_skew", "fluid_drag"].contains(&effect) {
            assert!(
                clock_error.abs() < 0.4e-3,
                "{case} {effect}: {clock_error} s"
            );
        }
    }
}

/// The hub of a flexible link under feedback: it arrives at 0.98 s and creeps by 80 encoder steps
/// afterwards, at less than 1 % of the move's speed.
#[test]
fn a_hub_that_creeps_under_feedback_is_at_rest() {
    let file = "quanser_2dsfl/lqg_step_20deg_run01.csv.gz";
    let Some(file) = shared("QUELL_RECORDINGS", "recordings", file) else {
        return;
    };
    let columns = columns(&file);
    let rule = RestRule::from_values(&columns[2]);
    // 4096 lines of the encoder, in quadrature and behind a gear: 15.3 urad a step.
    assert!((rule.quantisation - 15.34e-6).abs() < 0.05e-6, "{rule:?}");
    let decays = free_decays(&columns[0], &columns[2], rule, 0.5).unwrap();
    println!("{rule:?} {decays:?}");
    assert_eq!(decays.len(), 1);
    assert!((decays[0].start - 0.97).abs() < 0.02, "{decays:?}");
}

/// A flexible arm on a square wave of voltage never rests: it runs to and fro at constant speed.
#[test]
fn an_arm_that_runs_to_and_fro_has_no_free_decay() {
    let file = "flexarm_ist/square.csv.gz";
    let Some(file) = shared("QUELL_RECORDINGS", "recordings", file) else {
        return;
    };
    let columns = columns(&file);
    let hub: Vec<f64> = columns[4]
        .iter()
        .map(|degrees| degrees.to_radians())
        .collect();
    let rule = RestRule::from_values(&hub);
    let decays = free_decays(&columns[0], &hub, rule, 0.5).unwrap();
    assert!(decays.is_empty(), "{decays:?}");
}
