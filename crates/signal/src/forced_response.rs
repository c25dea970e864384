//! Deformation of a joint that a recorded motor position drives.

use quell_shapers::Mode;

use super::CubicSpline;

/// Solution of `delta'' + 2 xi w delta' + w^2 delta = -u'' - c u'` for a motor position `u` given as a
/// cubic spline; `c` is 0 for a damper across the joint and `2 xi w` for one to ground.
///
/// Exact for the spline: between knots the drive is a quadratic, so the solution is a quadratic plus
/// a damped oscillation. Evaluation takes `log n` steps.
#[derive(Clone, Debug)]
pub struct ForcedResponse<'a> {
    motor: &'a CubicSpline,
    mode: Mode,
    pieces: Vec<Piece>,
}

/// `delta(s) = p_0 + p_1 s + p_2 s^2 + exp(-sigma s) (a cos w_d s + b sin w_d s)`.
#[derive(Clone, Copy, Debug)]
struct Piece {
    p: [f64; 3],
    a: f64,
    b: f64,
}

impl<'a> ForcedResponse<'a> {
    /// The response from `initial` = (deformation in rad, its rate in rad/s) at the first knot.
    pub fn new(
        motor: &'a CubicSpline,
        mode: Mode,
        damper_to_ground: bool,
        initial: (f64, f64),
    ) -> Self {
        let knots = motor.knots();
        let mut state = initial;
        let mut pieces = Vec::with_capacity(knots.len() - 1);
        let mut usual = Turn::new(mode, 0.0);
        for k in 0..knots.len() - 1 {
            let piece = Piece::new(motor, k, mode, damper_to_ground, state);
            let step = knots[k + 1] - knots[k];
            let turn = usual.near(mode, step).unwrap_or_else(|| {
                usual = Turn::new(mode, step);
                usual
            });
            state = piece.after(mode, &turn);
            pieces.push(piece);
        }
        Self {
            motor,
            mode,
            pieces,
        }
    }

    /// Deformation (rad) and its rate (rad/s) at a time within the spline's span.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let (k, s, _) = self.motor.locate(time);
        self.pieces[k].after(self.mode, &Turn::new(self.mode, s))
    }
}

/// Free deformation `s` seconds after a start with a deformation of 1 and no rate, and after one with a rate of
/// 1 and no deformation.
pub(super) fn free_response(mode: Mode, s: f64) -> [f64; 2] {
    let turn = Turn::new(mode, s);
    let of_rate = turn.sin / mode.damped_frequency();
    [turn.cos + mode.decay_rate() * of_rate, of_rate]
}

/// `exp(-sigma s) cos w_d s` and `exp(-sigma s) sin w_d s`.
#[derive(Clone, Copy)]
struct Turn {
    s: f64,
    cos: f64,
    sin: f64,
}

/// Angle up to which the complex `exp` equals its series of third order to the last bit: the first omitted term
/// is `1e-4^4 / 24`, less than a rounding.
const SMALL_TURN: f64 = 1e-4;

impl Turn {
    fn new(mode: Mode, s: f64) -> Self {
        let envelope = (-mode.decay_rate() * s).exp();
        let (sin, cos) = (mode.damped_frequency() * s).sin_cos();
        Self {
            s,
            cos: envelope * cos,
            sin: envelope * sin,
        }
    }

    /// The same for another time, if that is a small angle away: the steps of a clock are equal up to rounding
    /// or jitter.
    fn near(&self, mode: Mode, s: f64) -> Option<Self> {
        let (x, y) = (
            -mode.decay_rate() * (s - self.s),
            mode.damped_frequency() * (s - self.s),
        );
        if x.abs().max(y.abs()) > SMALL_TURN {
            return None;
        }
        // z (1 + z / 2 (1 + z / 3)) for z = x + i y.
        let (a, b) = (1.0 + x / 3.0, y / 3.0);
        let (a, b) = (1.0 + 0.5 * (x * a - y * b), 0.5 * (x * b + y * a));
        let (a, b) = (x * a - y * b, x * b + y * a);
        Some(Self {
            s,
            cos: self.cos + (self.cos * a - self.sin * b),
            sin: self.sin + (self.cos * b + self.sin * a),
        })
    }
}

impl Piece {
    fn new(motor: &CubicSpline, k: usize, mode: Mode, ground: bool, state: (f64, f64)) -> Self {
        let (t0, t1) = (motor.knots()[k], motor.knots()[k + 1]);
        let (m0, m1) = (motor.second(k), motor.second(k + 1));
        let jerk = (m1 - m0) / (t1 - t0);
        let alpha2 = 2.0 * mode.decay_rate();
        let alpha1 = mode.natural_frequency().powi(2);
        let c = if ground { alpha2 } else { 0.0 };
        let drive = [
            -(m0 + c * motor.slope(k, t1 - t0)),
            -(jerk + c * m0),
            -c * jerk / 2.0,
        ];
        let p2 = drive[2] / alpha1;
        let p1 = (drive[1] - 2.0 * alpha2 * p2) / alpha1;
        let p0 = (drive[0] - alpha2 * p1 - 2.0 * p2) / alpha1;
        let a = state.0 - p0;
        let b = (state.1 - p1 + mode.decay_rate() * a) / mode.damped_frequency();
        Self {
            p: [p0, p1, p2],
            a,
            b,
        }
    }

    /// Deformation and its rate at this turn after the knot.
    fn after(&self, mode: Mode, turn: &Turn) -> (f64, f64) {
        let Turn { s, cos, sin } = *turn;
        let swing = self.a * cos + self.b * sin;
        let rate = mode.damped_frequency() * (self.b * cos - self.a * sin);
        let [p0, p1, p2] = self.p;
        (
            p0 + s * (p1 + s * p2) + swing,
            p1 + 2.0 * p2 * s - mode.decay_rate() * swing + rate,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A small turn further is where its exponential says, to rounding.
        #[test]
        fn near_is_new(
            hertz in 0.5..100.0f64,
            xi in 0.0..0.9f64,
            s in 0.0..0.05f64,
            apart in -1e-6..1e-6f64,
        ) {
            let mode = Mode::from_hertz(hertz, xi).unwrap();
            let near = Turn::new(mode, s).near(mode, s + apart);
            let new = Turn::new(mode, s + apart);
            let near = near.unwrap_or(new);
            // The angle itself is rounded.
            let rounding = 1e-15 + 4.0 * f64::EPSILON * mode.damped_frequency() * s;
            prop_assert!((near.cos - new.cos).abs() < rounding);
            prop_assert!((near.sin - new.sin).abs() < rounding);
        }
    }
}
