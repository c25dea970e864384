//! Windows of a recording for a model whose errors do not decay.

use super::Model;
use super::chain::MotorSide;
use super::experiment::{Experiment, Output, Window};
use super::piecewise::Hold;
use quell_recording::Role;
use std::f64::consts::TAU;

/// Longest window, in periods of the mode. With a damping ratio of 0.1 a vibration falls to a twentieth in five
/// periods, so that a window contains it; a longer one adds only drift.
const PERIODS: f64 = 5.0;

/// The same of a rigid axis, in its time constants `m / b`: after three a velocity has fallen to a twentieth.
const TIME_CONSTANTS: f64 = 3.0;

/// Fewest windows of a rigid axis, whose friction may be too small to limit their length: a third is held out,
/// and a third of that is the minimum for an estimate of scatter.
const FEWEST: f64 = 9.0;

/// Share of a period over which a rate is measured; the mode is linear in it within a hundredth.
const STRAIGHT: f64 = 0.05;

/// Share of a period in which the motor side is not recorded, from which on the motion is restarted: within a quarter
/// the motor side may come and go, and set the link ringing.
const UNSEEN: f64 = 0.25;

/// The same in mean intervals of the stamps, for recordings of few samples a period.
const INTERVALS: f64 = 3.0;

/// Windows after the first, of a motor side that a force drives freely, or whose recorded motion has [gaps](unseen).
///
/// Nothing in such a model brings the motor side back: the error by a small force error grows without bound,
/// and no noise explains it. (The feedback that held the machine in place is not in the model.) So the motion
/// is restarted every few periods from a free state: multiple shooting. A position loop in the model brings the
/// motor side back, and needs no restarts.
///
/// Source: Bock, Recent advances in parameter identification techniques for ODE, Numerical Treatment of
/// Inverse Problems in Differential and Integral Equations (1983).
pub(super) fn windows(model: &Model, experiment: &Experiment) -> Vec<Window> {
    let linear = (model.kind.linear)(&model.keys(), experiment.input);
    let measured = experiment
        .outputs
        .iter()
        .any(|o| matches!(o.role, Role::MotorPosition | Role::MotorVelocity));
    let MotorSide::Free { inertia, viscous } = linear.motor else {
        return unseen(model, experiment)
            .map(|gap| after(experiment, gap[1], STRAIGHT * TAU / model.fastest()))
            .collect();
    };
    if linear.position_loop.is_some() || !measured {
        return Vec::new();
    }
    let (first, last) = experiment.span();
    let span = last - first;
    let (longest, reach) = match linear.link {
        Some(_) => {
            let period = TAU / model.fastest();
            (PERIODS * period, STRAIGHT * period)
        }
        None => {
            let longest = (TIME_CONSTANTS * inertia / viscous).min(span / FEWEST);
            (longest, STRAIGHT * longest)
        }
    };
    let count = (span / longest).ceil();
    let start = |k: usize| {
        let edge = first + span * k as f64 / count;
        let stamp = experiment.input_time.partition_point(|t| *t < edge);
        let time = experiment.input_time[stamp.min(experiment.input_time.len() - 1)];
        Window {
            time,
            state: state(experiment, time, reach),
        }
    };
    (1..count as usize).map(start).collect()
}

/// Stretches, s, in which nothing says how the motor side moved that drives the link.
pub(super) fn unseen<'a>(
    model: &Model,
    experiment: &'a Experiment,
) -> impl Iterator<Item = [f64; 2]> + use<'a> {
    let linear = (model.kind.linear)(&model.keys(), experiment.input);
    let is_led = linear.motor == MotorSide::Prescribed && linear.link.is_some();
    let stamps: &[f64] = match is_led && experiment.hold == Hold::Spline {
        true => &experiment.input_time,
        false => &[],
    };
    let period = TAU / model.fastest();
    let longest = (UNSEEN * period).max(INTERVALS * experiment.mean_interval());
    let pairs = stamps.windows(2).map(|pair| [pair[0], pair[1]]);
    pairs.filter(move |[from, to]| to - from > longest)
}

/// A start at an instant of a recorded motor side, with the link in its place.
fn after(experiment: &Experiment, time: f64, reach: f64) -> Window {
    let (stamps, values) = (&experiment.input_time, &experiment.input_values);
    let [position, velocity] = line(stamps, values, time, reach);
    Window {
        time,
        state: [position, velocity, 0.0, 0.0],
    }
}

/// The readings at an instant, by a straight line over this time on both sides.
fn state(experiment: &Experiment, time: f64, reach: f64) -> [f64; 4] {
    let mut state = [0.0; 4];
    let velocity = |output: &&Output| output.role == Role::MotorVelocity;
    if let Some(output) = experiment.outputs.iter().find(velocity) {
        state[0] = travelled(output, time);
        state[1] = line(&output.time, &output.values, time, reach)[0];
    }
    for output in &experiment.outputs {
        let slot = match output.role {
            Role::MotorPosition => 0,
            Role::Deformation => 2,
            _ => continue,
        };
        [state[slot], state[slot + 1]] = line(&output.time, &output.values, time, reach);
    }
    state
}

/// Distance that a velocity covered until an instant, by the trapezoidal rule.
fn travelled(output: &Output, time: f64) -> f64 {
    let until = output.time.partition_point(|t| *t <= time);
    let (times, values) = (&output.time[..until], &output.values[..until]);
    let steps = times.windows(2).zip(values.windows(2));
    steps
        .map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1]))
        .sum()
}

/// Value and slope at an instant.
fn line(stamps: &[f64], values: &[f64], time: f64, reach: f64) -> [f64; 2] {
    let from = stamps.partition_point(|t| *t < time - reach);
    let to = stamps.partition_point(|t| *t <= time + reach);
    let n = (to - from) as f64;
    if to < from + 2 {
        let nearest = from.min(values.len() - 1);
        return [values[nearest], 0.0];
    }
    let (times, values) = (&stamps[from..to], &values[from..to]);
    let centre = times.iter().sum::<f64>() / n;
    let mean = values.iter().sum::<f64>() / n;
    let pairs = || times.iter().zip(values);
    let product: f64 = pairs().map(|(t, y)| (t - centre) * (y - mean)).sum();
    let square: f64 = times.iter().map(|t| (t - centre).powi(2)).sum();
    let slope = product / square;
    [mean + slope * (time - centre), slope]
}
