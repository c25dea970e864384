//! The residual against what a sensor could make of the motion.

use super::colour;

/// What the motion as the sensor shows it would explain of the residual.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorSide {
    /// Log-likelihood gain over noise, white or coloured.
    pub gain: f64,
    /// Number of regressors that earn it.
    pub count: usize,
    /// The one that explains most: its name and values.
    pub best: Option<(String, Vec<f64>)>,
}

/// Names of the regressors, each with what a sensor does that makes it: gain or misalignment, delay
/// or lag, a clock that runs fast, lag of second order, drift.
const NAMES: [&str; 5] = [
    "position",
    "velocity",
    "time x velocity",
    "acceleration",
    "time",
];

/// The better of two sets, the motion of the motor side and of the link.
pub(super) fn sensor_side(
    time: &[f64],
    residual: &[f64],
    motor: &[[f64; 3]],
    link: &[[f64; 3]],
) -> SensorSide {
    let without = colour::likelihood(time, &centred(residual));
    let on_motor = forward(time, residual, motor, without);
    let on_link = forward(time, residual, link, without);
    if on_link.gain > on_motor.gain {
        on_link
    } else {
        on_motor
    }
}

/// Forward selection: the regressor that explains most of what is left, made orthogonal to those
/// already in, as long as it earns half the logarithm of the length (Schwarz, 1978).
fn forward(time: &[f64], residual: &[f64], motion: &[[f64; 3]], without: f64) -> SensorSide {
    let n = residual.len() as f64;
    let original = columns(time, motion);
    let mut columns: Vec<Vec<f64>> = original.iter().map(|c| centred(c)).collect();
    let sizes: Vec<f64> = columns.iter().map(|c| dot(c, c)).collect();
    let mut left = centred(residual);
    let mut found = SensorSide::default();
    for _ in 0..NAMES.len() {
        let share = |c: usize| explained(&columns[c], sizes[c], &left);
        let Some(best) = (0..NAMES.len()).max_by(|&a, &b| share(a).total_cmp(&share(b))) else {
            break;
        };
        let before = dot(&left, &left);
        let after = before - share(best);
        if n * (before / after.max(f64::MIN_POSITIVE)).ln() <= n.ln() {
            break;
        }
        let chosen = columns[best].clone();
        remove(&chosen, &mut left);
        columns
            .iter_mut()
            .for_each(|column| remove(&chosen, column));
        if found.count == 0 {
            found.best = Some((NAMES[best].into(), original[best].clone()));
        }
        found.count += 1;
    }
    if found.count > 0 {
        found.gain = (colour::likelihood(time, &left) - without).max(0.0);
    }
    found
}

fn columns(time: &[f64], motion: &[[f64; 3]]) -> Vec<Vec<f64>> {
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
        of(&|t, _| t),
    ]
}

/// Sum of squares that a column explains; none where less than 1e-8 of it is left, which is rounding.
fn explained(column: &[f64], size: f64, series: &[f64]) -> f64 {
    let own = dot(column, column);
    if own > 1e-8 * size && own > 0.0 {
        dot(column, series).powi(2) / own
    } else {
        0.0
    }
}

/// Takes from a series its part along a direction.
fn remove(direction: &[f64], series: &mut [f64]) {
    let factor = dot(direction, series) / dot(direction, direction);
    series
        .iter_mut()
        .zip(direction)
        .for_each(|(s, d)| *s -= factor * d);
}

pub(super) fn centred(series: &[f64]) -> Vec<f64> {
    let mean = series.iter().sum::<f64>() / series.len() as f64;
    series.iter().map(|x| x - mean).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
