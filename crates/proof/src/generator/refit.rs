//! The residual of the nominal structure when all that it has is fitted again.

use super::Channel;
use super::gauss_newton::{Fit, Steps, descend};
use super::joint::Joint;
use super::programme::Programme;
use super::sensors::{Arm, Faults};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Iterations of Gauss and Newton; five reach the floor from 5 % of frequency.
const ITERATIONS: usize = 6;

/// Rms of what frequency, damping, clock offset, output offset, the sensor's frame and, of a tip, the arm's length
/// cannot explain of noise-free readings, in the channel's unit (m along the arc for a tip sensor).
pub fn leftover(arm: &Arm, programme: &Programme, stamps: &[f64], columns: &[Vec<f64>]) -> f64 {
    let nothing = Beside {
        factors: 2,
        grow: &|_, _| (),
    };
    leftover_beside(arm, programme, stamps, columns, nothing)
}

/// Further laws that are fitted, too: `grow` puts them into an arm with so many of their sizes multiplied.
#[derive(Clone, Copy)]
pub struct Beside<'a> {
    /// How many factors it takes; it may leave some unused.
    pub factors: usize,
    /// Puts them in.
    pub grow: &'a dyn Fn(&mut Arm, &[f64]),
}

/// The same, where other laws are fitted, too.
pub fn leftover_beside(
    arm: &Arm,
    programme: &Programme,
    stamps: &[f64],
    columns: &[Vec<f64>],
    beside: Beside,
) -> f64 {
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
    let fit = Grown {
        plain,
        by: vec![1.0; beside.factors],
        grow: beside.grow,
        read: &|arm: &Arm| arm.read(programme, stamps, step).swap_remove(0),
    };
    let steps = Steps {
        small: [vec![1e-3, 1e-2, 1e-5], vec![1e-2; beside.factors]].concat(),
        most: [vec![0.1, 1.0, 0.01], vec![1.0; beside.factors]].concat(),
        count: ITERATIONS,
    };
    let first = fit.predict();
    let angles = angles(arm, &first, columns);
    let (best, left) = descend(fit, first, &angles, &steps);
    match arm.channel {
        Channel::Tip => traced_rms(arm, &best, columns),
        Channel::Link | Channel::Deformation => left,
    }
}

/// Angles along the arc, the readings turned and scaled onto the predicted tips; a single column is one already.
fn angles(arm: &Arm, predicted: &[f64], columns: &[Vec<f64>]) -> Vec<f64> {
    let [_, _, _] = columns else {
        return columns.first().cloned().unwrap_or_default();
    };
    let tips: Vec<_> = predicted.iter().map(|&angle| arm.tip(angle)).collect();
    let seen = points(columns);
    let frame = Registration::new(&tips, &seen);
    let angle = |point: &Vector3<f64>| {
        let tip = frame.back(point);
        tip.y.atan2(tip.x)
    };
    seen.iter().map(angle).collect()
}

/// A nominal arm, and what the sizes of the other laws in it are multiplied by.
#[derive(Clone)]
struct Grown<'a> {
    plain: Arm,
    by: Vec<f64>,
    grow: &'a dyn Fn(&mut Arm, &[f64]),
    read: &'a dyn Fn(&Arm) -> Vec<f64>,
}

/// Unknowns of the arm itself: log frequency, log damping, clock offset. The logarithms of the factors follow.
const OWN: usize = 3;

impl Fit for Grown<'_> {
    fn predict(&self) -> Vec<f64> {
        let mut arm = self.plain.clone();
        (self.grow)(&mut arm, &self.by);
        (self.read)(&arm)
    }

    fn changed(&self, step: &[f64]) -> Self {
        let mut fit = self.clone();
        let (frequency, damping, clock) = (step[0], step[1], step[2]);
        fit.plain.joint.stiffness *= (2.0 * frequency).exp();
        fit.plain.joint.damping *= (frequency + damping).exp();
        fit.plain.clock_offset += clock;
        for (by, change) in fit.by.iter_mut().zip(&step[OWN..]) {
            *by *= change.exp();
        }
        fit
    }
}

/// Rms distance of readings from the tips at these angles, in a frame of their own: what a tracker shows of an
/// arm whose length is not known to its noise, so that an angle in proportion is an arm as much shorter.
fn traced_rms(arm: &Arm, angles: &[f64], columns: &[Vec<f64>]) -> f64 {
    let mean = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    let left = |stretch: f64| {
        let turned = angles.iter().map(|angle| mean + stretch * (angle - mean));
        let tips: Vec<_> = turned.map(|angle| arm.tip(angle)).collect();
        registered_rms(&tips, columns)
    };
    // The golden section (Kiefer, Proceedings of the American Mathematical Society 4 (1953)).
    let (mut low, mut high) = (1.0 - STRETCH, 1.0 + STRETCH);
    let share = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..SECTIONS {
        let (a, b) = (high - share * (high - low), low + share * (high - low));
        if left(a) < left(b) {
            high = b;
        } else {
            low = a;
        }
    }
    left(0.5 * (low + high))
}

/// Most that an angle may be out of proportion: far more than a length is ever off by.
const STRETCH: f64 = 0.1;
/// Cuts of that range: to a part in a million.
const SECTIONS: usize = 26;

/// Rms distance of readings from predicted tips after the best fit of a frame and its scale.
pub fn registered_rms(tips: &[Vector3<f64>], columns: &[Vec<f64>]) -> f64 {
    let seen = points(columns);
    if seen.is_empty() {
        return f64::NAN;
    }
    let frame = Registration::new(tips, &seen);
    let distance = |(tip, point): (&Vector3<f64>, &Vector3<f64>)| {
        frame.scale.powi(2) * (frame.back(point) - tip).norm_squared()
    };
    let sum: f64 = tips.iter().zip(&seen).map(distance).sum();
    (sum / tips.len().max(1) as f64).sqrt()
}

/// Points of three columns.
fn points(columns: &[Vec<f64>]) -> Vec<Vector3<f64>> {
    let [x, y, z] = columns else {
        return Vec::new();
    };
    let points = x.iter().zip(y).zip(z);
    points.map(|((&x, &y), &z)| Vector3::new(x, y, z)).collect()
}

/// The frame in which readings lie best on tips, and its scale.
///
/// Source: Umeyama, IEEE Trans. Pattern Analysis and Machine Intelligence 13 (1991).
struct Registration {
    rotation: Rotation3<f64>,
    scale: f64,
    tips: Vector3<f64>,
    seen: Vector3<f64>,
}

impl Registration {
    fn new(tips: &[Vector3<f64>], seen: &[Vector3<f64>]) -> Self {
        let (tip_mean, seen_mean) = (mean(tips), mean(seen));
        let mut covariance = Matrix3::zeros();
        for (tip, point) in tips.iter().zip(seen) {
            covariance += (point - seen_mean) * (tip - tip_mean).transpose();
        }
        let rotation = Rotation3::from_matrix_unchecked(nearest_rotation(covariance));
        let spread: f64 = tips.iter().map(|tip| (tip - tip_mean).norm_squared()).sum();
        let turned = rotation.matrix().transpose() * covariance;
        Self {
            rotation,
            scale: if spread > 0.0 {
                turned.trace() / spread
            } else {
                1.0
            },
            tips: tip_mean,
            seen: seen_mean,
        }
    }

    /// A reading as a tip.
    fn back(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.inverse() * (point - self.seen) / self.scale + self.tips
    }
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
