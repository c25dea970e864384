//! Frame and clock of a tip sensor from the arc that one joint sweeps.

use nalgebra::{
    Isometry3, Matrix2, Matrix3, Point3, Rotation3, SymmetricEigen, Translation3, UnitQuaternion,
    Vector2, Vector3,
};
use quell_shapers::Mode;

use super::clock_offset::fit_clock_offset;
use super::registration::{centroid, check_points};
use super::{Clock, CubicSpline, JointArc, SignalError};

/// Frame and clock of a tip sensor, from one joint's recorded move.
#[derive(Clone, Debug, PartialEq)]
pub struct ArcRegistration {
    /// Maps sensor coordinates to the robot's base frame.
    pub sensor_to_base: Isometry3<f64>,
    /// The sensor's clock against the encoder's.
    pub clock: Clock,
    /// One standard deviation of its offset, s.
    pub clock_offset_std: f64,
    /// Angle of the tip ahead of the undeformed motor side in this frame, rad, by the fit of clock and mode:
    /// the frame's error about the joint's axis. It is 0 after [`register_arc`].
    pub angle_error: f64,
    /// Root mean square distance of the tip from the plane of the arc, m: the sensor's noise.
    pub normal_rms: f64,
    /// Root mean square distance from the circle, in its plane, m: noise, and an error of the lever arm.
    pub radial_rms: f64,
    /// Root mean square residual of the fit of clock and mode along the arc, m: noise, and everything that a
    /// single linear mode does not explain.
    pub tangential_rms: f64,
    /// Radius fitted to the points, m.
    pub fitted_radius: f64,
    /// One standard deviation of it, m.
    pub fitted_radius_std: f64,
    /// Mode from the fit of the clock offset.
    pub mode: Option<Mode>,
    /// Whether a damper to ground explained the record better.
    pub damper_to_ground: bool,
}

/// Registers a tip sensor to the base frame from one joint's move.
///
/// `arc` is the tip's circle in the base frame. Plane and circle (of the arc's radius) are fitted to the
/// points; the deformation is along the arc and does not affect them. Clock offset and angle of the frame then
/// follow from the motor position by
/// [`fit_clock_offset`], under the model's zero static gain.
///
/// # Errors
/// [`SignalError`] for bad series, [`SignalError::Degenerate`] where the noise does not distinguish the arc
/// from a line.
pub fn register_arc(
    arc: &JointArc,
    motor: &CubicSpline,
    time: &[f64],
    tip: &[Point3<f64>],
    belief: Option<Mode>,
) -> Result<ArcRegistration, SignalError> {
    check_tip(time, tip)?;
    let mut plane = Plane::fit(tip)?;
    let flat = plane.project(tip);
    let guess = Circle::algebraic(&flat)?;
    let free = guess.refine(&flat, true);
    let mut circle = Circle {
        radius: arc.radius(),
        ..free
    };
    circle.centre = free.centre + free.toward_points(&flat) * (free.radius - arc.radius());
    circle = circle.refine(&flat, false);
    let (fitted_radius_std, radial_rms) = (free.radius_std(&flat), circle.rms(&flat));
    let mut angle = circle.angles(&flat);
    if !turns_with(&angle, time, motor) {
        angle.iter_mut().for_each(|a| *a = -*a);
        plane.flip();
        circle.centre.y = -circle.centre.y;
    }
    let fit = fit_clock_offset(motor, time, &angle, belief)?;
    Ok(ArcRegistration {
        sensor_to_base: frame(arc, &plane, &circle, fit.angle_offset),
        clock: Clock::with_offset(fit.offset),
        clock_offset_std: fit.offset_std,
        angle_error: 0.0,
        normal_rms: plane.rms,
        radial_rms,
        tangential_rms: fit.rms * arc.radius(),
        fitted_radius: free.radius,
        fitted_radius_std,
        mode: fit.mode,
        damper_to_ground: fit.damper_to_ground,
    })
}

/// Checks that each position has a stamp and is finite.
pub(super) fn check_tip(time: &[f64], tip: &[Point3<f64>]) -> Result<(), SignalError> {
    if time.len() != tip.len() {
        let (left, right) = (time.len(), tip.len());
        return Err(SignalError::Lengths {
            what: "tip stamps and positions",
            left,
            right,
        });
    }
    check_points("tip positions", tip)
}

/// The radius fitted to the points, and one standard deviation of it, m.
pub(super) fn fitted_radius(tip: &[Point3<f64>]) -> Result<(f64, f64), SignalError> {
    let flat = Plane::fit(tip)?.project(tip);
    let circle = Circle::algebraic(&flat)?.refine(&flat, true);
    Ok((circle.radius, circle.radius_std(&flat)))
}

/// Whether the angle grows when the motor position does.
fn turns_with(angle: &[f64], time: &[f64], motor: &CubicSpline) -> bool {
    let (first, last) = motor.span();
    let n = angle.len() as f64;
    let motor_at: Vec<f64> = time
        .iter()
        .map(|t| motor.value(t.clamp(first, last)))
        .collect();
    let means = (
        angle.iter().sum::<f64>() / n,
        motor_at.iter().sum::<f64>() / n,
    );
    angle
        .iter()
        .zip(&motor_at)
        .map(|(a, u)| (a - means.0) * (u - means.1))
        .sum::<f64>()
        >= 0.0
}

/// The transform that lays the fitted circle on the arc, angle 0 on angle 0.
fn frame(arc: &JointArc, plane: &Plane, circle: &Circle, angle_offset: f64) -> Isometry3<f64> {
    let (sin, cos) = angle_offset.sin_cos();
    let zero = plane.x * cos + plane.y * sin;
    let sensor = Matrix3::from_columns(&[zero, plane.normal.cross(&zero), plane.normal]);
    let radial = (arc.tip(0.0) - arc.centre()) / arc.radius();
    let axis = arc.axis().into_inner();
    let base = Matrix3::from_columns(&[radial, axis.cross(&radial), axis]);
    // Both are orthonormal and right-handed up to rounding; the quaternion is normalised.
    let rotation = Rotation3::from_matrix_unchecked(base * sensor.transpose());
    let rotation = UnitQuaternion::from_rotation_matrix(&rotation);
    let centre = plane.origin + plane.x * circle.centre.x + plane.y * circle.centre.y;
    let translation = arc.centre().coords - rotation * centre.coords;
    Isometry3::from_parts(Translation3::from(translation), rotation)
}

/// The plane of least squares; `x`, `y`, `normal` are right-handed.
struct Plane {
    origin: Point3<f64>,
    x: Vector3<f64>,
    y: Vector3<f64>,
    normal: Vector3<f64>,
    rms: f64,
}

impl Plane {
    fn fit(points: &[Point3<f64>]) -> Result<Self, SignalError> {
        let origin = centroid(points);
        let mut spread = Matrix3::zeros();
        for point in points {
            let r = point - origin;
            spread += r * r.transpose();
        }
        let eigen = SymmetricEigen::new(spread);
        let mut order = [0, 1, 2];
        order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
        let axis = |k: usize| eigen.eigenvectors.column(order[k]).into_owned();
        let value = |k: usize| eigen.eigenvalues[order[k]].max(0.0);
        // For a noisy line both smaller spreads are equal; an arc's differ by more than a factor of three in
        // amplitude.
        if value(1) <= (9.0 * value(2)).max(1e-14 * value(0)) {
            let along = axis(0);
            return Err(SignalError::Degenerate {
                direction: [along.x, along.y, along.z],
            });
        }
        let (x, y) = (axis(0), axis(1));
        let rms = (value(2) / points.len() as f64).sqrt();
        Ok(Self {
            origin,
            x,
            y,
            normal: x.cross(&y),
            rms,
        })
    }

    fn project(&self, points: &[Point3<f64>]) -> Vec<Vector2<f64>> {
        let flat = |p: &Point3<f64>| {
            let r = p - self.origin;
            Vector2::new(self.x.dot(&r), self.y.dot(&r))
        };
        points.iter().map(flat).collect()
    }

    /// Turns the plane over: y and the normal change sign.
    fn flip(&mut self) {
        self.y = -self.y;
        self.normal = -self.normal;
    }
}

#[derive(Clone, Copy)]
struct Circle {
    centre: Vector2<f64>,
    radius: f64,
}

impl Circle {
    /// Least squares of `|p|^2 = 2 c . p + (r^2 - |c|^2)`: closed form, biased on short noisy arcs, used as a
    /// start.
    ///
    /// Source: Kasa, "A circle fitting procedure and its error analysis", IEEE Trans. Instrumentation
    /// and Measurement 25 (1976).
    fn algebraic(points: &[Vector2<f64>]) -> Result<Self, SignalError> {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for p in points {
            let row = Vector3::new(2.0 * p.x, 2.0 * p.y, 1.0);
            normal += row * row.transpose();
            right += row * p.norm_squared();
        }
        let solution = normal.lu().solve(&right);
        let solution = solution.ok_or(SignalError::Degenerate {
            direction: [1.0, 0.0, 0.0],
        })?;
        let centre = Vector2::new(solution.x, solution.y);
        let radius = (solution.z + centre.norm_squared()).max(0.0).sqrt();
        Ok(Self { centre, radius })
    }

    /// Gauss-Newton on the geometric distance; the radius stays unless it is `free`.
    fn refine(mut self, points: &[Vector2<f64>], free: bool) -> Self {
        for _ in 0..50 {
            let (normal, right) = self.normal_equations(points);
            let step = if free {
                normal.try_inverse().map(|inverse| inverse * right)
            } else {
                let block: Matrix2<f64> = normal.fixed_view::<2, 2>(0, 0).into_owned();
                let inverse = block.try_inverse();
                inverse.map(|inverse| (inverse * right.fixed_rows::<2>(0)).push(0.0))
            };
            let Some(step) = step else { return self };
            self.centre += Vector2::new(step.x, step.y);
            self.radius += step.z;
            // A tenth of a nanometre on metres.
            if step.norm() < 1e-10 {
                return self;
            }
        }
        self
    }

    /// For the residual `|p - c| - r` in `c_x, c_y, r`.
    fn normal_equations(&self, points: &[Vector2<f64>]) -> (Matrix3<f64>, Vector3<f64>) {
        let mut normal = Matrix3::zeros();
        let mut right = Vector3::zeros();
        for p in points {
            let arm = p - self.centre;
            let distance = arm.norm();
            let row = Vector3::new(arm.x / distance, arm.y / distance, 1.0);
            normal += row * row.transpose();
            right += row * (distance - self.radius);
        }
        (normal, right)
    }

    fn rms(&self, points: &[Vector2<f64>]) -> f64 {
        let sum: f64 = points
            .iter()
            .map(|p| ((p - self.centre).norm() - self.radius).powi(2))
            .sum();
        (sum / points.len() as f64).sqrt()
    }

    fn radius_std(&self, points: &[Vector2<f64>]) -> f64 {
        let (normal, _) = self.normal_equations(points);
        let variance = normal.try_inverse().map(|m| m[(2, 2)]);
        variance.map_or(f64::INFINITY, |v| self.rms(points) * v.max(0.0).sqrt())
    }

    /// Unit vector from the centre to the middle of the points (which is the origin).
    fn toward_points(&self, points: &[Vector2<f64>]) -> Vector2<f64> {
        let mean = points.iter().sum::<Vector2<f64>>() / points.len() as f64;
        (mean - self.centre)
            .try_normalize(0.0)
            .unwrap_or_else(Vector2::x)
    }

    /// Polar angles about the centre, without jumps of a turn.
    fn angles(&self, points: &[Vector2<f64>]) -> Vec<f64> {
        let angle = |p: &Vector2<f64>| {
            let arm = p - self.centre;
            arm.y.atan2(arm.x)
        };
        unwrapped(points.iter().map(angle))
    }
}

/// Angles without jumps of a turn.
pub(super) fn unwrapped(angles: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last = None;
    let unwrap = angles.map(|angle| {
        let jump = last.map_or(0.0, |last: f64| {
            ((angle - last) / std::f64::consts::TAU).round()
        });
        turns -= jump * std::f64::consts::TAU;
        last = Some(angle);
        angle + turns
    });
    unwrap.collect()
}
