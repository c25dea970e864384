//! Points in the space of the batch fit's unknowns, and the modes there.

use nalgebra::{Complex, Owned, U6, Vector};
use quell_shapers::Mode;

/// Unknowns of the solver: `ln w`, `sqrt(xi / (1 - xi))`, offset, rate, scale, gain. The free decay of
/// each stretch is projected out.
pub const UNKNOWNS: usize = 6;

/// Values of the unknowns.
pub type Point = Vector<f64, U6, Owned<f64, U6>>;

/// Largest damping ratio of a descent. Near 1 the two poles meet, and their difference loses digits by a factor
/// of `1 / (1 - xi^2)`, 500.
const OVERDAMPED: f64 = 0.999;
/// Factor by which a descent may leave the range of frequencies. An end outside of the range is refused, so an
/// octave is enough for a descent that comes back.
const OCTAVE: f64 = 2.0;

/// The point with this natural frequency, rad/s, and damping ratio, and linear unknowns of 0.
pub fn point_of(w: f64, xi: f64) -> Point {
    let mut point = Point::zeros();
    point[0] = w.ln();
    point[1] = (xi / (1.0 - xi)).sqrt();
    point
}

/// Natural frequency, rad/s, and damping ratio of a point: `w = exp p_0`, `xi = p_1^2 / (1 + p_1^2)`, so that
/// every step of the solver ends in a valid mode.
fn of_point(point: &Point) -> (f64, f64) {
    let square = point[1] * point[1];
    (point[0].exp(), square / (1.0 + square))
}

/// The mode at a point; `None` if it is more than an octave outside of a range of frequencies, rad/s.
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
