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
use super::regression::{Regression, Slope};
use super::{Departure, ExperimentError, Model};
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
    recording: &str,
) -> Result<(Vec<f64>, Vec<f64>), ExperimentError> {
    let none = || ExperimentError::NoTangent {
        recording: recording.into(),
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

/// The predicted acceleration of the link at an output's stamps, and its squared rate.
fn causes(model: &Model, experiment: &Experiment, output: &Output) -> [Vec<f64>; 2] {
    let (keys, still) = (model.keys(), Departure::default());
    let simulated = simulate(model.kind, &keys, &model.terms(), experiment, &still);
    let seen = |role| {
        let own = Output {
            role,
            ..output.clone()
        };
        simulated.predict(&own, 0.0).values
    };
    let rates = seen(Role::LinkVelocity);
    let squares = rates.iter().map(|rate| rate * rate).collect();
    [seen(Role::LinkAcceleration), squares]
}

/// The unit vector of the columns' slopes over the first cause; `None` where it is not known within [`TURNED`].
fn direction([first, other]: &[Vec<f64>; 2], columns: &[Vec<f64>]) -> Option<Vec<f64>> {
    let causes = Regression::on(&[first, other])?;
    let slopes = columns.iter().map(|column| causes.slope(column));
    let slopes: Vec<Slope> = slopes.collect::<Option<_>>()?;
    let square: f64 = slopes.iter().map(|own| own.value * own.value).sum();
    let variance: f64 = slopes.iter().map(|own| own.variance).sum();
    let known = square > 0.0 && variance < TURNED * TURNED * square;
    let length = square.sqrt();
    known.then(|| slopes.iter().map(|own| own.value / length).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns of a sensor that is turned by `turn` in the plane of the motion and tilted by `tilt` out of it.
    fn columns(causes: &[Vec<f64>; 2], (turn, tilt): (f64, f64)) -> [Vec<f64>; 3] {
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
        let causes = [first, square];
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
        let still = [0, 1].map(|_| vec![0.0; 2000]);
        assert_eq!(direction(&still, &columns(&causes, (0.7, 0.0))), None);
    }
}
