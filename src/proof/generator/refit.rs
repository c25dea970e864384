//! What the nominal structure leaves when all that it has is fitted again.

use super::Channel;
use super::joint::Joint;
use super::programme::Programme;
use super::sensors::{Arm, Faults};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// Iterations of Gauss and Newton; five reach the floor from 5 % of frequency.
const ITERATIONS: usize = 6;

/// Rms of what frequency, damping, clock offset, output offset and the sensor's frame cannot explain of
/// noise-free readings, in the channel's unit (m along the arc for a tip sensor).
pub fn leftover(arm: &Arm, programme: &Programme, stamps: &[f64], columns: &[Vec<f64>]) -> f64 {
    leftover_beside(arm, programme, stamps, columns, &|_, _| ())
}

/// The same, where another law is fitted, too: `grow` puts it into an arm at a multiple of a size.
pub fn leftover_beside(
    arm: &Arm,
    programme: &Programme,
    stamps: &[f64],
    columns: &[Vec<f64>],
    grow: &dyn Fn(&mut Arm, f64),
) -> f64 {
    let angles = angles(arm, columns);
    let plain = Arm {
        joint: Joint {
            inertia: arm.joint.inertia,
            stiffness: arm.joint.stiffness,
            damping: arm.joint.damping,
            ..Joint::default()
        },
        faults: Faults::default(),
        channel: match arm.channel {
            Channel::Tip => Channel::Link,
            other => other,
        },
        ..arm.clone()
    };
    let step = 0.1 / (plain.joint.stiffness / plain.joint.inertia).sqrt();
    let mut fit = Fit {
        plain,
        size: 1.0,
        grow,
    };
    let predict = |fit: &Fit| fit.arm().read(programme, stamps, step).swap_remove(0);
    let mut best = predict(&fit);
    let mut left = centred_rms(&angles, &best);
    for _ in 0..ITERATIONS {
        let trial = improved(&fit, &angles, &best, predict);
        let predicted = predict(&trial);
        let now = centred_rms(&angles, &predicted);
        // A clone that did not get better ends the search; not a number does, too.
        if now.is_nan() || now >= left * (1.0 - 1e-4) {
            break;
        }
        (fit, best, left) = (trial, predicted, now);
    }
    match arm.channel {
        Channel::Tip => {
            let tips: Vec<_> = best.iter().map(|&angle| arm.tip(angle)).collect();
            registered_rms(&tips, columns)
        }
        Channel::Link | Channel::Deformation => left,
    }
}

/// Angles along the arc; a single column is one already.
fn angles(arm: &Arm, columns: &[Vec<f64>]) -> Vec<f64> {
    let [x, y, z] = columns else {
        return columns.first().cloned().unwrap_or_default();
    };
    let points = x.iter().zip(y).zip(z);
    let robot = points.map(|((&x, &y), &z)| {
        let point = arm.frame.0.inverse() * (Vector3::new(x, y, z) - arm.frame.1);
        point.y.atan2(point.x)
    });
    robot.collect()
}

fn centred_rms(measured: &[f64], predicted: &[f64]) -> f64 {
    let count = measured.len().max(1) as f64;
    let left: Vec<f64> = measured.iter().zip(predicted).map(|(a, b)| a - b).collect();
    let mean = left.iter().sum::<f64>() / count;
    (left.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / count).sqrt()
}

/// A nominal arm, and the size of the other law in it.
#[derive(Clone)]
struct Fit<'a> {
    plain: Arm,
    size: f64,
    grow: &'a dyn Fn(&mut Arm, f64),
}

impl Fit<'_> {
    fn arm(&self) -> Arm {
        let mut arm = self.plain.clone();
        (self.grow)(&mut arm, self.size);
        arm
    }

    /// Changed in log frequency, log damping, clock offset and log size.
    fn changed(&self, [frequency, damping, clock, size]: [f64; 4]) -> Self {
        let mut fit = self.clone();
        fit.plain.joint.stiffness *= (2.0 * frequency).exp();
        fit.plain.joint.damping *= (frequency + damping).exp();
        fit.plain.clock_offset += clock;
        fit.size *= size.exp();
        fit
    }
}

/// One step of Gauss and Newton, an output offset among the unknowns.
fn improved<'a>(
    fit: &Fit<'a>,
    measured: &[f64],
    predicted: &[f64],
    predict: impl Fn(&Fit) -> Vec<f64>,
) -> Fit<'a> {
    const SMALL: [f64; 4] = [1e-3, 1e-2, 1e-5, 1e-2];
    const MOST: [f64; 4] = [0.1, 1.0, 0.01, 1.0];
    let columns = [0, 1, 2, 3].map(|index| {
        let mut step = [0.0; 4];
        step[index] = SMALL[index];
        let moved = predict(&fit.changed(step));
        let difference = moved.iter().zip(predicted);
        difference.map(|(a, b)| (a - b) / SMALL[index]).collect()
    });
    let left: Vec<f64> = measured.iter().zip(predicted).map(|(m, p)| m - p).collect();
    match solved(&columns, &left) {
        Some(step) => fit.changed([0, 1, 2, 3].map(|i| step[i].clamp(-MOST[i], MOST[i]))),
        None => fit.clone(),
    }
}

/// Least squares with columns and a constant, each scaled to length 1; what does nothing stays.
fn solved(columns: &[Vec<f64>; 4], left: &[f64]) -> Option<DVector<f64>> {
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

/// Rms distance of readings from predicted tips after the best rigid fit of the frame.
pub fn registered_rms(tips: &[Vector3<f64>], columns: &[Vec<f64>]) -> f64 {
    let [x, y, z] = columns else {
        return f64::NAN;
    };
    let seen = x.iter().zip(y).zip(z);
    let seen: Vec<_> = seen.map(|((&x, &y), &z)| Vector3::new(x, y, z)).collect();
    let count = tips.len().max(1) as f64;
    let (tip_mean, seen_mean) = (mean(tips), mean(&seen));
    let mut covariance = Matrix3::zeros();
    for (tip, point) in tips.iter().zip(&seen) {
        covariance += (point - seen_mean) * (tip - tip_mean).transpose();
    }
    let rotation = Rotation3::from_matrix_unchecked(nearest_rotation(covariance));
    let distance = |(tip, point): (&Vector3<f64>, &Vector3<f64>)| {
        (point - seen_mean - rotation * (tip - tip_mean)).norm_squared()
    };
    let sum: f64 = tips.iter().zip(&seen).map(distance).sum();
    (sum / count).sqrt()
}

fn mean(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64
}

/// Source: W. Kabsch, Acta Crystallographica A32 (1976).
fn nearest_rotation(covariance: Matrix3<f64>) -> Matrix3<f64> {
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else {
        return Matrix3::identity();
    };
    let handed = (u * v_t).determinant().signum();
    u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, handed)) * v_t
}
