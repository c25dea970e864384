//! Damped Gauss-Newton steps on the readings of a machine, with an offset of the readings among the unknowns.

use nalgebra::{DMatrix, DVector};

/// Fractions of a step that are tried: a law with a corner may need a shorter one.
const PARTS: [f64; 3] = [1.0, 0.3, 0.1];
/// Relative fall of the residual that is worth another step.
const WORTH: f64 = 1e-4;

/// How far the unknowns are moved.
pub struct Steps {
    /// For a derivative.
    pub small: Vec<f64>,
    /// At most, in one step.
    pub most: Vec<f64>,
    /// How many steps there are at most.
    pub count: usize,
}

/// A machine that is fitted.
pub trait Fit: Sized {
    /// Its readings.
    fn predict(&self) -> Vec<f64>;

    /// The machine with its unknowns moved by a step.
    fn changed(&self, step: &[f64]) -> Self;
}

/// The readings of the machine that is nearest to what was measured, and the rms that is left, from one with known
/// readings on.
pub fn descend<F: Fit>(
    mut fit: F,
    mut predicted: Vec<f64>,
    measured: &[f64],
    steps: &Steps,
) -> (Vec<f64>, f64) {
    let mut left = centred_rms(measured, &predicted);
    for _ in 0..steps.count {
        let step = step(&fit, &predicted, measured, steps);
        let better = PARTS.into_iter().find_map(|part| {
            let part: Vec<f64> = step.iter().map(|step| part * step).collect();
            let trial = fit.changed(&part);
            let readings = trial.predict();
            let now = centred_rms(measured, &readings);
            (now < left * (1.0 - WORTH)).then_some((trial, readings, now))
        });
        let Some(better) = better else {
            break;
        };
        (fit, predicted, left) = better;
    }
    (predicted, left)
}

/// The Gauss-Newton step; empty where it is not determined.
fn step<F: Fit>(fit: &F, predicted: &[f64], measured: &[f64], steps: &Steps) -> Vec<f64> {
    let count = steps.small.len();
    let column = |index: usize| {
        let mut step = vec![0.0; count];
        step[index] = steps.small[index];
        let moved = fit.changed(&step).predict();
        let difference = moved.iter().zip(predicted);
        difference
            .map(|(a, b)| (a - b) / steps.small[index])
            .collect()
    };
    let columns: Vec<Vec<f64>> = (0..count).map(column).collect();
    let left: Vec<f64> = measured.iter().zip(predicted).map(|(m, p)| m - p).collect();
    let Some(solution) = solved(&columns, &left) else {
        return vec![0.0; count];
    };
    let within = solution.iter().zip(&steps.most);
    within
        .map(|(step, most)| step.clamp(-most, *most))
        .collect()
}

/// Least squares with columns and a constant, each scaled to length 1; what does nothing stays.
fn solved(columns: &[Vec<f64>], left: &[f64]) -> Option<DVector<f64>> {
    let ones = vec![1.0; left.len()];
    let all: Vec<DVector<f64>> = columns
        .iter()
        .chain([&ones])
        .map(|column| DVector::from_column_slice(column))
        .collect();
    let matrix = DMatrix::from_columns(&all);
    let normal = matrix.tr_mul(&matrix);
    let right = matrix.tr_mul(&DVector::from_column_slice(left));
    let scale = normal.diagonal().map(|d| 1.0 / d.sqrt().max(1e-300));
    let count = scale.len();
    let scaled = DMatrix::from_fn(count, count, |i, j| normal[(i, j)] * scale[i] * scale[j])
        + DMatrix::identity(count, count) * 1e-9;
    let step = scaled.try_inverse()? * right.component_mul(&scale);
    let step = step.component_mul(&scale);
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// Rms of readings less predicted ones, without their mean.
pub fn centred_rms(measured: &[f64], predicted: &[f64]) -> f64 {
    let count = measured.len().max(1) as f64;
    let left: Vec<f64> = measured.iter().zip(predicted).map(|(a, b)| a - b).collect();
    let mean = left.iter().sum::<f64>() / count;
    (left.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / count).sqrt()
}
