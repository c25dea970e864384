//! Frequency and damping of a recorded free decay, by a few lines that share nothing with the library.

use nalgebra::{DMatrix, Matrix3, Vector3};
use quell::recording::{Recording, Role};
use std::f64::consts::TAU;

/// The squared error that a decay of this frequency (rad/s) and decay rate (1/s), with an offset,
/// leaves of the rows of `seen` (samples by coordinates), all linear coefficients solved for.
fn misfit(time: &[f64], seen: &DMatrix<f64>, frequency: f64, rate: f64) -> f64 {
    let mut normal = Matrix3::zeros();
    let mut right = Matrix3::zeros();
    for (row, t) in time.iter().enumerate() {
        let (sin, cos) = (frequency * t).sin_cos();
        let basis = Vector3::new(cos, sin, (rate * t).exp()) * (-rate * t).exp();
        normal += basis * basis.transpose();
        right += basis * seen.row(row).fixed_columns::<3>(0);
    }
    let solved = normal.lu().solve(&right).unwrap();
    seen.iter().map(|x| x * x).sum::<f64>() - solved.dot(&right)
}

/// Frequency (Hz) and damping ratio of the decay of the tip from `from` (s) on: least squares, the
/// two nonlinear unknowns by a search that narrows around the best of a 9 by 9 grid.
pub fn fitted_mode(recording: &Recording, from: f64) -> (f64, f64) {
    let tip = recording.channel(Role::TipPosition).unwrap();
    let first = tip.time.partition_point(|time| *time < from);
    let time: Vec<f64> = tip.time[first..]
        .iter()
        .map(|t| t - tip.time[first])
        .collect();
    let seen = DMatrix::from_fn(time.len(), 3, |row, axis| {
        let column = &tip.columns[axis];
        column[first + row] - column[column.len() - 1]
    });
    let (mut best, mut width) = ([TAU * 10.0, 6.0], [TAU * 8.0, 6.0]);
    for _ in 0..40 {
        let centre = best;
        let mut least = f64::INFINITY;
        for (i, j) in (0..81).map(|k| (k / 9, k % 9)) {
            let at = |k: i32, n: usize| centre[n] + width[n] * (f64::from(k) / 4.0 - 1.0);
            let error = misfit(&time, &seen, at(i, 0), at(j, 1));
            if error < least {
                (least, best) = (error, [at(i, 0), at(j, 1)]);
            }
        }
        width = width.map(|width| 0.7 * width);
    }
    let natural = best[0].hypot(best[1]);
    (natural / TAU, best[1] / natural)
}
