//! The usual move of an axis: a ramp to a cruise velocity, the cruise, a ramp to the target.
//!
//! Each ramp is the fastest one to the cruise velocity `v_c` (jerk at its limit, acceleration up to its limit),
//! and the cruise takes the rest of the duration, so that `v_c` determines everything.

use crate::AxisState;
use crate::closed_form::Known;
use crate::path::Path;
use crate::ramp::Ramp;

/// From a state in the cruise one or two are enough; the others look for a cruise that was not seen.
const NEWTON_STEPS: usize = 8;

impl Known {
    /// The path whose cruise velocity is near the guess and that ends at the target, if it is the one.
    ///
    /// Newton's method on the position at the end. As `v_c` grows by `d`, the velocity grows by `d` in the cruise,
    /// not at all before a ramp's peak is left, and the peak moves by half of what is left: the position grows by `d`
    /// times the cruise and half of the steps that lead into it and out of it.
    pub(crate) fn cruise_near(&self, guess: f64) -> Option<Path> {
        let mut cruise = guess;
        for _ in 0..NEWTON_STEPS {
            let (first, last) = self.ramps(cruise);
            let rest = self.scale.duration - first.duration() - last.duration();
            let steps = [
                (first.times[0], first.jerk),
                (first.times[1], 0.0),
                (first.times[2], -first.jerk),
                (rest, 0.0),
                (last.times[2], -last.jerk),
                (last.times[1], 0.0),
                (last.times[0], last.jerk),
            ];
            let path = Path::new(self.from, steps, &self.scale)?;
            let missing = self.to.position - path.end().position;
            if missing.abs() <= self.scale.position_rounding() {
                let limit = self.limits.velocity + self.scale.velocity_rounding();
                return (cruise.abs() <= limit && self.seen_on(&path)).then_some(path);
            }
            cruise += missing / (rest + 0.5 * (first.times[2] + last.times[2]));
        }
        None
    }

    /// The ramps from the start to a cruise velocity, and backwards from the target: there the acceleration has the
    /// other sign, the jerk the same.
    fn ramps(&self, cruise: f64) -> (Ramp, Ramp) {
        let rounding = self.scale.velocity_rounding();
        let ramp = |velocity, acceleration| {
            Ramp::new((velocity, acceleration), cruise, self.limits, rounding)
        };
        (
            ramp(self.from.velocity, self.from.acceleration),
            ramp(self.to.velocity, -self.to.acceleration),
        )
    }

    /// The cruise velocity above (`side` 1) or below (-1) both ends of a move whose cruise takes no time.
    ///
    /// With `c = v - s a^2 / 2 j` of start and target, peaks `A^2 = s j (v_c - c)`, and ramps of `(2 A - s a) / j`
    /// below the limit of the acceleration and `s (v_c - c) / a_max + (a_max - s a) / j` at it, the ramps of start
    /// and target add up to the duration.
    pub(crate) fn turning(&self, side: f64) -> f64 {
        let (limit, jerk) = (self.limits.acceleration, self.limits.jerk);
        let along = |state: AxisState| {
            let (v, a) = (side * state.velocity, side * state.acceleration);
            (v - a * a / (2.0 * jerk), a)
        };
        let ((c0, a0), (c1, a1)) = (along(self.from), along(self.to));
        let total = self.scale.duration + (a0 - a1) / jerk;
        let sum = 0.5 * jerk * total;
        let first = 0.5 * (sum + jerk * (c1 - c0) / sum);
        if first.max(sum - first) <= limit {
            return side * (c0 + first * first / jerk);
        }
        // The ramp of the larger change is at the limit, the other one perhaps not.
        let (low, high) = (c0.min(c1), c0.max(c1));
        let peak = (jerk * (limit * total - (high - low))).max(0.0).sqrt() - limit;
        if peak <= limit {
            return side * (high + peak * peak / jerk);
        }
        side * 0.5 * (limit * (total - 2.0 * limit / jerk) + low + high)
    }
}
