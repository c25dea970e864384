//! The residual compared with sensor errors that depend on the motion.

use super::Residual;
use super::basis::{Basis, dot};
use super::colour;

/// The part of the residual that sensor errors explain.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorSide {
    /// Log-likelihood gain over noise, white or coloured.
    pub gain: f64,
    /// The gain less the threshold of its regressors.
    pub evidence: f64,
    /// The one that explains most: its name and values.
    pub best: Option<(String, Vec<f64>)>,
    /// Factor on the acceleration, s^2, beside all else; 0 if it is not among the regressors. A lag `T`, less
    /// the delay that the clock absorbs, leaves `T^2 / 2`. A stiff spring between sensor and ground leaves `-1
    /// / w^2`, since the sensor sits before the inertia.
    pub acceleration: f64,
    /// Residual without the chosen regressors.
    pub left: Vec<f64>,
}

/// Names of the regressors. Their causes in a sensor are, in order: gain or misalignment, delay or lag, a clock
/// that runs fast, lag beyond delay (twice), drift.
const VELOCITY: usize = 1;
const ACCELERATION: usize = 3;
const NAMES: [&str; 6] = [
    "position",
    "velocity",
    "time x velocity",
    "acceleration",
    "lagged acceleration",
    "time",
];

/// The better of two sets, the motion of the motor side and of the link.
///
/// `constant` is that of the lagged acceleration, s: about the reciprocal of the mode.
pub(super) fn sensor_side(residual: &Residual, refit: &Basis, constant: f64) -> SensorSide {
    let on_motor = forward(
        residual,
        columns(residual.time, residual.motor, constant),
        refit,
    );
    let on_link = forward(
        residual,
        columns(residual.time, residual.link, constant),
        refit,
    );
    if on_motor.gain > on_link.gain {
        on_motor
    } else {
        on_link
    }
}

/// Least gain of a regressor: half the logarithm of the length (Schwarz, 1978) and, since the best of two sets
/// is taken, the logarithm of their number.
fn cost(n: f64) -> f64 {
    0.5 * n.ln() + (2.0 * NAMES.len() as f64).ln()
}

/// Forward selection: in each step the regressor that explains most of the rest, made orthogonal to the chosen
/// ones, as long as it gains [`cost`].
fn forward(residual: &Residual, columns: Vec<Vec<f64>>, refit: &Basis) -> SensorSide {
    let n = residual.residual.len() as f64;
    let mut basis = refit.clone();
    let mut left = basis.without(residual.residual);
    let mut found = SensorSide::default();
    let mut chosen = Vec::new();
    for _ in 0..NAMES.len() {
        let share = |column: &Vec<f64>| explained(&basis.without(column), column, &left);
        let shares: Vec<f64> = columns.iter().map(share).collect();
        let Some(best) = (0..NAMES.len()).max_by(|&a, &b| shares[a].total_cmp(&shares[b])) else {
            break;
        };
        let before = dot(&left, &left);
        let after = (before - shares[best]).max(f64::MIN_POSITIVE);
        if 0.5 * n * (before / after).ln() <= cost(n) || !basis.add(&columns[best]) {
            break;
        }
        basis.remove(&mut left);
        if chosen.is_empty() {
            found.best = Some((NAMES[best].into(), columns[best].clone()));
        }
        chosen.push(best);
    }
    if !chosen.is_empty() {
        let without = colour::likelihood(residual.time, residual.residual);
        found.gain = (colour::likelihood(residual.time, &left) - without).max(0.0);
        found.evidence = found.gain - cost(n) * chosen.len() as f64;
    }
    found.acceleration = acceleration(residual, &columns, &chosen, refit);
    found.left = left;
    found
}

/// The factor on the acceleration, if chosen, fitted beside a delay and the other chosen regressors without the
/// two accelerations.
fn acceleration(residual: &Residual, columns: &[Vec<f64>], chosen: &[usize], refit: &Basis) -> f64 {
    let alike = |c: usize| c == ACCELERATION || c == ACCELERATION + 1;
    if !chosen.iter().any(|&c| alike(c)) {
        return 0.0;
    }
    let mut basis = refit.clone();
    for &c in chosen.iter().chain(&[VELOCITY]).filter(|c| !alike(**c)) {
        basis.add(&columns[c]);
    }
    let rest = basis.without(&columns[ACCELERATION]);
    dot(&rest, residual.residual) / dot(&rest, &rest).max(f64::MIN_POSITIVE)
}

fn columns(time: &[f64], motion: &[[f64; 3]], constant: f64) -> Vec<Vec<f64>> {
    let middle = 0.5 * (time[0] + time[time.len() - 1]);
    let of = |f: &dyn Fn(f64, &[f64; 3]) -> f64| -> Vec<f64> {
        time.iter()
            .zip(motion)
            .map(|(t, m)| f(t - middle, m))
            .collect()
    };
    vec![
        of(&|_, m| m[0]),
        of(&|_, m| m[1]),
        of(&|t, m| t * m[1]),
        of(&|_, m| m[2]),
        lagged(time, motion, constant),
        of(&|t, _| t),
    ]
}

/// The acceleration behind a first-order lag.
fn lagged(time: &[f64], motion: &[[f64; 3]], constant: f64) -> Vec<f64> {
    let mut found = vec![motion[0][2]; time.len()];
    for k in 1..time.len() {
        let kept = ((time[k - 1] - time[k]) / constant).exp();
        let input = 0.5 * (motion[k - 1][2] + motion[k][2]);
        found[k] = input + (found[k - 1] - input) * kept;
    }
    found
}

/// Sum of squares that the rest of a column explains; 0 if the rest is rounding.
fn explained(rest: &[f64], column: &[f64], series: &[f64]) -> f64 {
    let own = dot(rest, rest);
    if own > 1e-10 * dot(column, column) && own > 0.0 {
        dot(rest, series).powi(2) / own
    } else {
        0.0
    }
}
