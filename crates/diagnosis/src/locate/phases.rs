//! Phases of the motion, and the residual's chi-squared in each.

use std::f64::consts::TAU;

use super::Residual;
use super::correlation::length;
use quell_signal::noise_floor;

/// Names of the phases, by number.
pub(super) const PHASES: [&str; 5] = ["acceleration", "cruise", "reversal", "settling", "rest"];
pub(super) const ACCELERATION: usize = 0;
pub(super) const CRUISE: usize = 1;
pub(super) const REVERSAL: usize = 2;
pub(super) const SETTLING: usize = 3;
pub(super) const REST: usize = 4;

/// Share of the greatest speed below which a drift is rest, as `signal::RestRule` has it.
const DRIFT: f64 = 0.01;
/// Share of the greatest acceleration below which the speed is constant, as in `signal::RestRule`.
const STEADY: f64 = 0.1;
/// Share of the greatest speed within which a change of sign is a reversal.
const TURN: f64 = 0.1;
/// Noise exceeds five standard deviations once in 1.7 million samples.
const NOISE: f64 = 5.0;

/// The phase of each stamp.
pub(super) fn label(residual: &Residual) -> Vec<usize> {
    let velocity: Vec<f64> = residual.motor.iter().map(|m| m[1]).collect();
    let acceleration = smooth(residual.motor.iter().map(|m| m[2]).collect());
    let still = threshold(&velocity, DRIFT);
    let steady = threshold(&acceleration, STEADY);
    let turn = TURN * largest(&velocity);
    let mut labels: Vec<usize> = velocity
        .iter()
        .zip(&acceleration)
        .map(|(v, a)| match (v.abs() > still, a.abs() > steady) {
            (_, true) => ACCELERATION,
            (true, false) => CRUISE,
            (false, false) => REST,
        })
        .collect();
    mark_reversals(&mut labels, &velocity, turn);
    mark_settling(&mut labels, residual);
    labels
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, x| m.max(x.abs()))
}

fn threshold(values: &[f64], share: f64) -> f64 {
    (share * largest(values)).max(NOISE * noise_floor(values).standard_deviation)
}

/// Centred mean of five: an acceleration is a second difference, whose noise alternates.
fn smooth(values: Vec<f64>) -> Vec<f64> {
    let n = values.len();
    (0..n)
        .map(|k| {
            let near = &values[k.saturating_sub(2)..(k + 3).min(n)];
            near.iter().sum::<f64>() / near.len() as f64
        })
        .collect()
}

/// Slow stamps around each change of the velocity's sign during acceleration.
fn mark_reversals(labels: &mut [usize], velocity: &[f64], turn: f64) {
    for k in 1..labels.len() {
        let turns = velocity[k - 1] * velocity[k] < 0.0;
        if !turns
            || [k - 1, k]
                .iter()
                .any(|&i| labels[i] > CRUISE && labels[i] != REVERSAL)
        {
            continue;
        }
        let slow = |i: &usize| velocity[*i].abs() <= turn && labels[*i] != REST;
        let before = (0..k).rev().take_while(slow).count();
        let after = (k..labels.len()).take_while(slow).count();
        // A move that starts or ends here: one side of it is slow down to rest. This is no reversal.
        let rests = [k.checked_sub(before + 1), Some(k + after)]
            .into_iter()
            .any(|i| i.and_then(|i| labels.get(i)).is_none_or(|l| *l == REST));
        if !rests {
            labels[k - before..k + after].fill(REVERSAL);
        }
    }
}

/// Rest that follows motion, until the model's vibration has sunk into the noise.
fn mark_settling(labels: &mut [usize], residual: &Residual) {
    let mut stretch_begin = 0;
    let mut until = f64::NEG_INFINITY;
    for k in 1..labels.len() {
        let (was, is) = (labels[k - 1], labels[k]);
        let rested = was == REST || was == SETTLING;
        if rested && is != REST {
            stretch_begin = k;
        }
        if !rested && is == REST {
            until = residual.time[k - 1] + settling_time(residual, stretch_begin, k);
        }
        if is == REST && residual.time[k] <= until {
            labels[k] = SETTLING;
        }
    }
}

/// How long the vibration of the motion between two stamps outlasts it: `ln(A / sigma) / (xi w)`, at least a
/// period and at most five time constants; a tenth of the motion without a mode.
fn settling_time(residual: &Residual, begin: usize, end: usize) -> f64 {
    let w = residual.dynamics.natural_frequency;
    if w <= 0.0 {
        return 0.1 * (residual.time[end - 1] - residual.time[begin]);
    }
    let decay = (residual.dynamics.damping_ratio * w).max(1e-3 * w);
    let bend = |k: usize| (residual.link[k][0] - residual.motor[k][0]).abs();
    let amplitude = (begin..end).map(bend).fold(0.0, f64::max);
    let ratio = (amplitude / residual.noise_std.max(f64::MIN_POSITIVE)).max(1.0);
    (ratio.ln() / decay).min(5.0 / decay).max(TAU / w)
}

/// Share of the residual's chi-squared above the noise in each phase, and the phases in which it is
/// strong.
pub(super) fn chi_squared(
    residual: &Residual,
    labels: &[usize],
) -> (Vec<(String, f64)>, Vec<String>) {
    let variance = residual.noise_std * residual.noise_std;
    let (mut excess, mut count) = ([0.0; PHASES.len()], [0.0; PHASES.len()]);
    for (r, &label) in residual.residual.iter().zip(labels) {
        excess[label] += r * r / variance - 1.0;
        count[label] += 1.0;
    }
    // A chi-squared of n independent values has variance 2 n.
    let correlated = length(residual.time, residual.residual).samples.max(1.0);
    let z = |p: usize| excess[p] / (2.0 * count[p] * correlated).sqrt();
    let density = |p: usize| {
        if count[p] > 0.0 {
            excess[p] / count[p]
        } else {
            0.0
        }
    };
    let densest = (0..PHASES.len()).map(density).fold(0.0, f64::max);
    let whole: f64 = excess.iter().map(|e| e.max(0.0)).sum();
    let shares = (0..PHASES.len())
        .filter(|&p| count[p] > 0.0)
        .map(|p| {
            (
                PHASES[p].to_string(),
                excess[p].max(0.0) / whole.max(f64::MIN_POSITIVE),
            )
        })
        .collect();
    // 3.09: noise exceeds it once in a thousand.
    let strong = (0..PHASES.len())
        .filter(|&p| count[p] > 0.0 && z(p) > 3.09 && density(p) >= 0.5 * densest)
        .map(|p| PHASES[p].to_string())
        .collect();
    (shares, strong)
}
