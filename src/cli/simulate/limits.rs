//! Excess of a command over the limits of its joint.

use super::motion::{Knot, Motion};
use super::setup::Setup;

/// Share of a limit by which a command at its limit may seem to exceed it, by rounding.
const ROUNDING: f64 = 1e-6;

/// One sentence for each of velocity, acceleration and jerk that is exceeded.
///
/// The n-th derivative is judged by the n-th divided difference of the commanded positions, times n!. This is a
/// weighted mean of the derivative over n intervals, so it never exceeds the true peak. The part that rounding
/// of the positions to their last digit can explain is subtracted.
pub fn exceeded(motion: &Motion, setup: &Setup) -> Vec<String> {
    let limits = setup.robot.joints[setup.joint].limits;
    let rounding = 0.5 * motion.resolution;
    let named = [
        ("velocity", "deg/s", limits.velocity),
        ("acceleration", "deg/s^2", limits.acceleration),
        ("jerk", "deg/s^3", limits.jerk),
    ];
    let mut remarks = Vec::new();
    for (order, (name, unit, limit)) in (1..).zip(named) {
        let (peak, time) = peak(&motion.knots, order, rounding);
        if peak > limit * (1.0 + ROUNDING) {
            remarks.push(format!(
                "the command exceeds the {name} limit of joint {} by {:.1} %: {:.4} {unit} at \
                 {time:.3} s, allowed {:.4}",
                setup.joint + 1,
                100.0 * (peak / limit - 1.0),
                peak.to_degrees(),
                limit.to_degrees(),
            ));
        }
    }
    remarks
}

/// The greatest magnitude of the derivative of that order beyond the effect of rounding, and its time.
fn peak(knots: &[Knot], order: usize, rounding: f64) -> (f64, f64) {
    let mut peak = (0.0, 0.0);
    for window in knots.windows(order + 1) {
        let (mut sum, mut spread) = (0.0, 0.0);
        for (i, knot) in window.iter().enumerate() {
            let others = window.iter().enumerate().filter(|(j, _)| *j != i);
            let weight: f64 = others
                .zip(1..)
                .map(|((_, other), factor)| f64::from(factor) / (knot.time - other.time))
                .product();
            sum += weight * knot.position;
            spread += weight.abs();
        }
        let magnitude = sum.abs() - spread * rounding;
        if magnitude > peak.0 {
            peak = (magnitude, window[order / 2].time);
        }
    }
    peak
}
