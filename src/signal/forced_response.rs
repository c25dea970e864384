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
        for k in 0..knots.len() - 1 {
            let piece = Piece::new(motor, k, mode, damper_to_ground, state);
            state = piece.at(mode, knots[k + 1] - knots[k]);
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
        self.pieces[k].at(self.mode, s)
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

    /// Deformation and its rate `s` after the knot.
    fn at(&self, mode: Mode, s: f64) -> (f64, f64) {
        let (sigma, omega) = (mode.decay_rate(), mode.damped_frequency());
        let envelope = (-sigma * s).exp();
        let (sin, cos) = (omega * s).sin_cos();
        let swing = envelope * (self.a * cos + self.b * sin);
        let turn = envelope * omega * (self.b * cos - self.a * sin);
        let [p0, p1, p2] = self.p;
        (
            p0 + s * (p1 + s * p2) + swing,
            p1 + 2.0 * p2 * s - sigma * swing + turn,
        )
    }
}
