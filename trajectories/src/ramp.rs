//! The quickest change to a velocity at no acceleration.

use crate::Limits;

/// The quickest change from a velocity `v` and an acceleration `a` to `v_c` at no acceleration.
///
/// With the direction `s` of the change, the peak `A = sqrt(s j (v_c - v) + a^2 / 2)` and at most its limit:
/// `(A - s a) / j` at jerk `s j`, what is left of the change at `A`, `A / j` at jerk `-s j`.
pub(crate) struct Ramp {
    /// Jerk of the first step, rad/s^3.
    pub(crate) jerk: f64,
    /// How long the three steps last, s; a negative time says that there is no such ramp.
    pub(crate) times: [f64; 3],
}

impl Ramp {
    /// A change of velocity below its `rounding` is none: its root would be a pulse that is not there.
    pub(crate) fn new(
        (velocity, acceleration): (f64, f64),
        cruise: f64,
        limits: Limits,
        rounding: f64,
    ) -> Self {
        let (jerk, limit) = (limits.jerk, limits.acceleration);
        // Where the velocity ends if the acceleration only vanishes.
        let coasted = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
        let direction = (cruise - coasted).signum();
        let along = direction * acceleration;
        let square = jerk * direction * (cruise - velocity) + 0.5 * along * along;
        let pulse = square > jerk * rounding;
        let peak = if pulse { square.sqrt() } else { 0.0 };
        let times = if peak <= limit {
            [(peak - along) / jerk, 0.0, peak / jerk]
        } else {
            let hold = (square / limit - limit) / jerk;
            [(limit - along) / jerk, hold, limit / jerk]
        };
        Self {
            jerk: direction * jerk,
            times,
        }
    }

    pub(crate) fn duration(&self) -> f64 {
        self.times.iter().sum()
    }
}
