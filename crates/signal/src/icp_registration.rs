//! Frame and clock of a tip sensor by iterated closest points.

use nalgebra::{Isometry3, Point3};
use quell_shapers::Mode;

use super::arc_registration::{check_tip, fitted_radius, unwrapped};
use super::clock_offset::fit_clock_offset;
use super::icp::{IcpOptions, icp, initial_guess};
use super::{ArcRegistration, Clock, CubicSpline, JointArc, SignalError};

/// Points of either path that are registered: the arc is some thousand times as long as the sensor's noise.
const POINTS: usize = 2000;

/// Registers a tip sensor to the base frame from one joint's move: maps the path of the sensor onto the path of
/// the motor side along `arc`, without using the instants.
///
/// The joint's deformation is along the path, so that it does not show across it. But the ends of the path,
/// which alone fix it along the arc, include the vibration beyond the motor side's range. This turns the frame
/// about the joint's axis by [`ArcRegistration::angle_error`]. [`register_arc`](super::register_arc) has no
/// such error.
/// The clock offset follows from the angle in this frame by [`fit_clock_offset`].
///
/// # Errors
/// [`SignalError`] for bad series, [`SignalError::Degenerate`] where the noise does not distinguish the arc
/// from a line.
///
/// Source: Besl and McKay, "A method for registration of 3-D shapes", IEEE PAMI 14 (1992).
pub fn register_icp(
    arc: &JointArc,
    motor: &CubicSpline,
    time: &[f64],
    tip: &[Point3<f64>],
    belief: Option<Mode>,
) -> Result<ArcRegistration, SignalError> {
    check_tip(time, tip)?;
    let (fitted_radius, fitted_radius_std) = fitted_radius(tip)?;
    let seen = evenly(tip);
    let (first, last) = motor.span();
    let stamps = time.iter().map(|t| t.clamp(first, last));
    let meant: Vec<f64> = stamps.map(|t| motor.value(t)).collect();
    // First guess by points of equal time, refined by closest points.
    let followed: Vec<_> = meant.iter().map(|&u| arc.tip(u)).collect();
    let guess = initial_guess(&seen, &evenly(&followed))?;
    let path = path(arc, &meant);
    let sensor_to_base = icp(&seen, &path, &guess, IcpOptions::default())?
        .registration
        .transform;
    let seen = Polar::of(arc, &sensor_to_base, tip);
    let fit = fit_clock_offset(motor, time, &seen.angle, belief)?;
    Ok(ArcRegistration {
        sensor_to_base,
        clock: Clock::with_offset(fit.offset),
        clock_offset_std: fit.offset_std,
        angle_error: fit.angle_offset,
        normal_rms: rms(&seen.normal),
        radial_rms: rms(&seen.radial),
        tangential_rms: fit.rms * arc.radius(),
        fitted_radius,
        fitted_radius_std,
        mode: fit.mode,
        damper_to_ground: fit.damper_to_ground,
    })
}

/// Points at even shares of a record.
fn evenly(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    points
        .iter()
        .step_by(points.len().div_ceil(POINTS))
        .copied()
        .collect()
}

/// The part of the arc that the motor side's positions (rad) cover.
fn path(arc: &JointArc, positions: &[f64]) -> Vec<Point3<f64>> {
    let low = positions.iter().copied().fold(f64::INFINITY, f64::min);
    let high = positions.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let at = |k: usize| arc.tip(low + (high - low) * k as f64 / (POINTS - 1) as f64);
    (0..POINTS).map(at).collect()
}

/// The tip about the joint's axis.
struct Polar {
    /// Angle about the axis, without jumps of a turn, rad.
    angle: Vec<f64>,
    /// Distance from the plane of the arc, m.
    normal: Vec<f64>,
    /// Distance from the circle in its plane, m.
    radial: Vec<f64>,
}

impl Polar {
    fn of(arc: &JointArc, sensor_to_base: &Isometry3<f64>, tip: &[Point3<f64>]) -> Self {
        let axis = arc.axis().into_inner();
        let x = (arc.tip(0.0) - arc.centre()) / arc.radius();
        let y = axis.cross(&x);
        let arms: Vec<_> = tip
            .iter()
            .map(|point| sensor_to_base * point - arc.centre())
            .collect();
        let flat = |arm: &nalgebra::Vector3<f64>| [x.dot(arm), y.dot(arm)];
        let angle = |[x, y]: [f64; 2]| y.atan2(x);
        let distance = |[x, y]: [f64; 2]| x.hypot(y) - arc.radius();
        Self {
            angle: unwrapped(arms.iter().map(flat).map(angle)),
            normal: arms.iter().map(|arm| axis.dot(arm)).collect(),
            radial: arms.iter().map(flat).map(distance).collect(),
        }
    }
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}
