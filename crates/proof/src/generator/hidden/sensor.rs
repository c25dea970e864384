//! Effects in the sensor.

use super::super::Channel;
use super::super::joint::Lag;
use super::{Arm, Entry, OUTER, Parameters, Scales, between, entry, log_between, sign};
use nalgebra::Vector3;
use std::f64::consts::TAU;

const PLACE: &str = "sensor";

pub(super) const ENTRIES: &[Entry] = &[
    entry("sensor_lag", PLACE, [0.05, 0.8], lag),
    entry("sensor_lag_second_order", PLACE, [0.05, 0.8], second_order).more_than(only_lag),
    entry("sensor_gain", PLACE, [0.1, 1.0], gain).seen_by(OUTER),
    entry("deformation_gain", PLACE, [0.05, 0.4], deformation_gain),
    entry("misalignment", PLACE, [0.1, 1.0], misalignment).seen_by(&[Channel::Link]),
    entry("sensor_drift", PLACE, [0.1, 1.0], drift),
    entry("clock_skew", PLACE, [0.1, 2.0], skew)
        .seen_by(OUTER)
        .in_a_programme(),
];

fn lag(arm: &mut Arm, scales: &Scales, _: [f64; 4], size: f64) -> Parameters {
    let time_constant = size / scales.natural_frequency;
    arm.joint.lag = Some(Lag::First { time_constant });
    vec![("time_constant", time_constant)]
}

fn only_lag(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64, by: [f64; 2]) {
    lag(arm, scales, shape, size * by[0]);
}

/// From a filter that hardly overshoots to two lags in a row.
fn second_order(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let time_constant = size / scales.natural_frequency;
    let damping_ratio = between(0.5, 1.0, shape[0]);
    arm.joint.lag = Some(Lag::Second {
        time_constant,
        damping_ratio,
    });
    vec![
        ("time_constant", time_constant),
        ("damping_ratio", damping_ratio),
    ]
}

/// All coordinates, or the angle.
fn gain(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let travel = scales.span[1] - scales.span[0];
    arm.faults.gain = sign(shape[0]) * size * scales.deformation / travel;
    vec![("error", arm.faults.gain)]
}

fn deformation_gain(arm: &mut Arm, _: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    arm.faults.deformation_gain = sign(shape[0]) * size;
    vec![("error", arm.faults.deformation_gain)]
}

fn misalignment(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    arm.faults.eccentricity = [size * scales.deformation, TAU * shape[0]];
    vec![
        ("amplitude", size * scales.deformation),
        ("phase", TAU * shape[0]),
    ]
}

/// Even in time, or levelling off.
fn drift(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let lever = if arm.channel == Channel::Tip {
        arm.lever_arm
    } else {
        1.0
    };
    let time_constant = match shape[0] {
        share if share < 0.5 => 0.0,
        share => scales.duration * log_between(0.2, 1.0, 2.0 * share - 1.0),
    };
    let [x, y, z] = [shape[1], shape[2], shape[3]].map(|share| share - 0.5);
    let direction = Vector3::new(x, y, z) / Vector3::new(x, y, z).norm().max(1e-3);
    let level = sign(shape[1]) * size * scales.deformation * lever;
    arm.faults.drift_direction = direction.into();
    match time_constant {
        0.0 => {
            let rate = level / scales.duration;
            arm.faults.drift = [rate, 0.0];
            let name = if arm.channel == Channel::Tip {
                "rate_m"
            } else {
                "rate"
            };
            vec![(name, rate)]
        }
        tau => {
            arm.faults.drift = [level, tau];
            vec![("level", level), ("time_constant", tau)]
        }
    }
}

fn skew(arm: &mut Arm, scales: &Scales, shape: [f64; 4], size: f64) -> Parameters {
    let late = size * scales.deformation / scales.speed;
    arm.faults.skew = sign(shape[0]) * late / scales.duration;
    // What a stamp t shows was at (1 + skew) t.
    vec![("skew", 1.0 / (1.0 + arm.faults.skew) - 1.0)]
}
