//! Points in the space of the batch fit's unknowns, and the modes there.

use nalgebra::{Complex, Owned, U6, Vector};
use quell_shapers::Mode;

/// Unknowns of the solver: `ln w`, `sqrt(xi / (1 - xi))`, offset, rate, scale, gain. The free decay of
/// each stretch is projected out.
pub const UNKNOWNS: usize = 6;

/// Values of the unknowns.
pub type Point = Vector<f64, U6, Owned<f64, U6>>;

/// Damping ratio that a descent may reach: next to 1 the two poles meet, and by `1 / (1 - xi^2)`, 500 times, what
/// tells them apart cancels.
const OVERDAMPED: f64 = 0.999;
/// How far beyond the range of frequencies a descent may look. What ends there is refused, so that an octave is
/// enough to come back from.
const OCTAVE: f64 = 2.0;

/// The point with this natural frequency, rad/s, and damping ratio, and 0 for all that is linear.
pub fn point_of(w: f64, xi: f64) -> Point {
    let mut point = Point::zeros();
    point[0] = w.ln();
    point[1] = (xi / (1.0 - xi)).sqrt();
    point
}

/// Natural frequency, rad/s, and damping ratio of a point: `w = exp p_0`, `xi = p_1^2 / (1 + p_1^2)`, so that every
/// step of the solver ends in a mode.
fn of_point(point: &Point) -> (f64, f64) {
    let square = point[1] * point[1];
    (point[0].exp(), square / (1.0 + square))
}

/// The mode at a point, an octave beyond a range of frequencies, rad/s, at most.
pub fn mode(point: &Point, (low, high): (f64, f64)) -> Option<Mode> {
    let (w, xi) = of_point(point);
    let w = w.max(low / OCTAVE).min(high * OCTAVE);
    Mode::new(w, xi.min(OVERDAMPED)).ok()
}

/// The pole `-xi w + j w_d` at a point, rad/s.
pub fn pole(point: &Point) -> Complex<f64> {
    let (w, xi) = of_point(point);
    Complex::new(-xi, (1.0 - xi * xi).sqrt()) * w
}

/// `d xi / d p_1`.
pub fn damping_slope(point: &Point) -> f64 {
    2.0 * point[1] / (1.0 + point[1] * point[1]).powi(2)
}
