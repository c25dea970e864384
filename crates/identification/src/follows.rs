//! A tip that follows the motor side without a mode.

use nalgebra::{Matrix3, Vector3};
use quell_control::estimators::Sample;
use quell_signal::{CubicSpline, End};

/// Steps of Gauss and Newton for the delay.
const STEPS: usize = 4;

/// The least-squares fit of a tip that only follows the motor side,
///
/// ```text
/// u(t) + delta(t) = a + r u(t - tau)
/// ```
///
/// with the offset `a` of a sensor, the error of its scale in `r`, and that of its clock in `tau`. None of them
/// is a mode, although a mode can be fitted to what they leave in the deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follows {
    /// Sum of the squares that it leaves.
    pub residual: f64,
}

impl Follows {
    /// The fit to samples whose stamps increase.
    pub fn of(samples: &[Sample]) -> Self {
        let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
        let motor: Vec<f64> = samples.iter().map(|s| s.motor_position).collect();
        let spline = CubicSpline::new(&time, &motor, End::NotAKnot).ok();
        let (mut tau, mut residual) = (0.0, f64::INFINITY);
        for _ in 0..STEPS {
            let input = |t: f64| {
                let own = spline.as_ref()?;
                let (first, last) = own.span();
                let at = (t - tau).clamp(first, last);
                Some([own.value(at), own.derivative(at)])
            };
            let (left, later) = line(samples, |t| input(t).unwrap_or_default());
            residual = left.min(residual);
            tau += later;
        }
        Self { residual }
    }
}

/// The fit with the input and its rate at a delay: what it leaves, and how much longer the delay is.
fn line(samples: &[Sample], input: impl Fn(f64) -> [f64; 2]) -> (f64, f64) {
    let count = samples.len() as f64;
    let row = |s: &Sample| {
        let [value, rate] = input(s.time);
        (
            Vector3::new(1.0, value, rate),
            s.motor_position + s.deformation,
        )
    };
    let rows: Vec<(Vector3<f64>, f64)> = samples.iter().map(row).collect();
    let centre = rows.iter().map(|own| own.0).sum::<Vector3<f64>>() / count;
    let mean = rows.iter().map(|own| own.1).sum::<f64>() / count;
    let (mut normal, mut right, mut whole) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
    for (row, value) in rows {
        // The offset's own column keeps its one, and is orthogonal to the others.
        let own = Vector3::new(1.0, row[1] - centre[1], row[2] - centre[2]);
        normal += own * own.transpose();
        right += own * (value - mean);
        whole += (value - mean).powi(2);
    }
    // What does not vary has no column.
    for k in 0..3 {
        if normal[(k, k)] <= 0.0 {
            normal[(k, k)] = 1.0;
        }
    }
    let Some(found) = normal.cholesky().map(|factor| factor.solve(&right)) else {
        return (whole, 0.0);
    };
    let later = -found[2] / found[1];
    let left = (whole - right.dot(&found)).max(0.0);
    (left, if later.is_finite() { later } else { 0.0 })
}
