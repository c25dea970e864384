//! The tangential direction of an accelerometer at the tip, from several of its axes.
//!
//! A sensor that turns with the link reads `R (r y'' e_t - r y'^2 e_r + g)` in its own axes: a constant rotation `R` of
//! the acceleration along the tip's circle of radius `r`, that towards its centre, and gravity, which is constant where
//! the axis of the joint is vertical. Each column is fitted by the link's acceleration `y''`, its squared rate `y'^2`
//! and an offset, as the believed model predicts them. The coefficients of `y''` are `r R e_t`, from which the direction
//! follows. An error of the believed mode changes all of them by one factor, which does not turn it. Where fewer than
//! three columns do not span the plane of the motion, the reading is that share of the acceleration which they see.

use super::experiment::{Experiment, Output};
use super::predict::simulate;
use super::{Departure, ExperimentError, Model};
use nalgebra::{DMatrix, DVector};
use quell_recording::Role;

/// Largest standard deviation of the direction, rad: the reading then loses at most half a percent, and takes up at most
/// a tenth of what acts across.
const TURNED: f64 = 0.1;

/// The reading along the tangential direction, and the direction in the columns, of unit length.
///
/// # Errors
/// [`ExperimentError::NoTangent`] where the motion does not determine it.
pub(super) fn along_tangent(
    model: &Model,
    experiment: &Experiment,
    (output, columns): (&Output, &[Vec<f64>]),
) -> Result<(Vec<f64>, Vec<f64>), ExperimentError> {
    let none = || ExperimentError::NoTangent {
        role: output.channel,
        columns: columns.len(),
    };
    let direction = direction(&causes(model, experiment, output), columns).ok_or_else(none)?;
    let mut reading = vec![0.0; columns[0].len()];
    for (share, column) in direction.iter().zip(columns) {
        for (sum, value) in reading.iter_mut().zip(column) {
            *sum += share * value;
        }
    }
    Ok((reading, direction))
}

/// The predicted acceleration of the link at an output's stamps, and its squared rate, both without their means.
fn causes(model: &Model, experiment: &Experiment, output: &Output) -> [DVector<f64>; 2] {
    let (keys, still) = (model.keys(), Departure::default());
    let simulated = simulate(model.kind, &keys, &model.terms(), experiment, &still);
    let seen = |role| {
        let own = Output {
            role,
            ..output.clone()
        };
        DVector::from_vec(simulated.predict(&own, 0.0).values)
    };
    let square = seen(Role::LinkVelocity).map(|rate| rate * rate);
    [seen(Role::LinkAcceleration), square].map(centred)
}

/// The unit vector of the columns' slopes over the first cause; `None` where it is not known within [`TURNED`].
fn direction([first, other]: &[DVector<f64>; 2], columns: &[Vec<f64>]) -> Option<Vec<f64>> {
    let size = other.norm_squared();
    let common = if size > 0.0 {
        first.dot(other) / size
    } else {
        0.0
    };
    // The part of the first cause that the other one does not have.
    let own = first - other * common;
    let square = own.norm_squared();
    let (mut slopes, mut variance) = (Vec::new(), 0.0);
    let basis = DMatrix::from_columns(&[first.clone(), other.clone()]);
    let basis = basis.svd(true, false).u?;
    for column in columns {
        let column = centred(DVector::from_column_slice(column));
        slopes.push(own.dot(&column) / square);
        let left = &column - &basis * basis.tr_mul(&column);
        variance += left.norm_squared() / column.len() as f64 / square;
    }
    let length = slopes.iter().map(|slope| slope * slope).sum::<f64>().sqrt();
    let known = length.is_finite() && length > 0.0 && variance.sqrt() < TURNED * length;
    known.then(|| slopes.iter().map(|slope| slope / length).collect())
}

fn centred(values: DVector<f64>) -> DVector<f64> {
    let mean = values.mean();
    values.add_scalar(-mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of a sensor that is turned by `turn` in the plane of the motion and tilted by `tilt` out of it.
    fn columns(causes: &[DVector<f64>; 2], (turn, tilt): (f64, f64)) -> [Vec<f64>; 3] {
        let [(sin, cos), (up, along)] = [turn.sin_cos(), tilt.sin_cos()];
        let read = |tangential: f64, radial: f64, offset: f64| -> Vec<f64> {
            let pairs = causes[0].iter().zip(causes[1].iter());
            pairs
                .map(|(a, v2)| tangential * a - radial * v2 + offset)
                .collect()
        };
        [
            read(along * cos, along * sin, 1.0),
            read(-sin, cos, -2.0),
            read(-up * cos, -up * sin, 9.0),
        ]
    }

    #[test]
    fn the_direction_is_that_of_the_rotation_and_unknown_without_motion() {
        let time = (0..2000).map(|k| f64::from(k) * 1e-3);
        let rate: Vec<f64> = time.clone().map(|t| (7.0 * t).sin() + 0.3 * t).collect();
        let first: Vec<f64> = time.map(|t| 7.0 * (7.0 * t).cos() + 0.3).collect();
        let square = rate.iter().map(|v| v * v).collect();
        let causes = [first, square].map(|own| centred(DVector::from_vec(own)));
        for (turn, tilt) in [(0.0f64, 0.0f64), (0.7, -0.3), (2.5, 1.0), (-1.2, 0.4)] {
            let found = direction(&causes, &columns(&causes, (turn, tilt))).unwrap();
            let right = [
                tilt.cos() * turn.cos(),
                -turn.sin(),
                -tilt.sin() * turn.cos(),
            ];
            for (own, right) in found.iter().zip(right) {
                assert!(
                    (own - right).abs() < 1e-9,
                    "{found:?} for {turn} and {tilt}"
                );
            }
        }
        let still = [0, 1].map(|_| DVector::zeros(2000));
        assert_eq!(direction(&still, &columns(&causes, (0.7, 0.0))), None);
    }
}
