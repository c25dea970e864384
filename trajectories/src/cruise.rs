//! The usual move of an axis in closed form: a ramp to a cruise velocity, the cruise, a ramp to the target.
//!
//! Ruckig's binding tells the duration and states at times, no phases. But nearly every profile is known once its
//! cruise velocity `v_c` is: each ramp is the quickest to `v_c` (jerk at its limit, acceleration up to its limit),
//! and the cruise takes what the ramps leave of the duration. `v_c` is read from a state, is the limit, or follows
//! from the duration where there is no cruise. The duration, the target and the states that are left over then say
//! whether the guess was right.

use crate::read_back::Scale;
use crate::{AxisProfile, AxisState, Limits, Phase};

/// From a state in the cruise one or two are enough; the others look for a cruise that was not seen.
const NEWTON_STEPS: usize = 8;

/// What is known of the move of one axis.
pub(crate) struct Known {
    pub(crate) from: AxisState,
    pub(crate) to: AxisState,
    pub(crate) limits: Limits,
    pub(crate) scale: Scale,
    /// A time within the move, s, and Ruckig's state there.
    pub(crate) seen: (f64, AxisState),
}

/// The quickest change from a velocity `v` and an acceleration `a` to `v_c` at no acceleration.
///
/// With the direction `s` of the change, the peak acceleration `A = sqrt(s j (v_c - v) + a^2 / 2)` and its limit,
/// `(A - s a) / j`, a time at the limit, `A / j`.
struct Ramp {
    direction: f64,
    times: [f64; 3],
}

impl Ramp {
    /// A change of velocity below its `rounding` is none: its root would be a pulse that is not there.
    fn new(
        (velocity, acceleration): (f64, f64),
        cruise: f64,
        limits: Limits,
        rounding: f64,
    ) -> Self {
        let jerk = limits.jerk;
        // Where the velocity ends if the acceleration only vanishes.
        let coasted = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
        let direction = (cruise - coasted).signum();
        let along = direction * acceleration;
        let square = jerk * direction * (cruise - velocity) + 0.5 * along * along;
        let limit = limits.acceleration;
        let peak = if square > jerk * rounding {
            square.sqrt()
        } else {
            0.0
        };
        let times = if peak <= limit {
            [(peak - along) / jerk, 0.0, peak / jerk]
        } else {
            let hold = square / (limit * jerk) - limit / jerk;
            [(limit - along) / jerk, hold, limit / jerk]
        };
        Self { direction, times }
    }

    fn duration(&self) -> f64 {
        self.times.iter().sum()
    }
}

/// The seven steps of a move: how long (s), and at which jerk.
type Steps = [(f64, f64); 7];

impl Known {
    /// The move, if a ramp, a cruise and a ramp explain all that is known of it.
    pub(crate) fn cruise(&self) -> Option<AxisProfile> {
        let instant = self.scale.instant();
        let (limit, seen) = (self.limits.velocity, self.seen.1);
        let steps = if seen.acceleration.abs() <= self.scale.acceleration_rounding() {
            self.solve(seen.velocity, instant)
        } else {
            let turnings = [1.0, -1.0]
                .into_iter()
                .map(|direction| self.turning(direction));
            let mut guesses = turnings.chain([limit, -limit, seen.velocity]);
            guesses.find_map(|guess| self.solve(guess, instant))
        };
        Some(self.profile(&steps?, instant))
    }

    /// The cruise velocity of a move in `direction` whose cruise takes no time.
    ///
    /// With `c = v - s a^2 / 2 j` of start and target, peaks `A^2 = s j (v_c - c)`, and ramps of `(2 A - s a) / j`
    /// below the limit of the acceleration and `s (v_c - c) / a_max + (a_max - s a) / j` at it, the ramps of start
    /// and target add up to the duration.
    fn turning(&self, direction: f64) -> f64 {
        let Limits {
            acceleration: limit,
            jerk,
            ..
        } = self.limits;
        let along = |state: AxisState| {
            let (v, a) = (direction * state.velocity, direction * state.acceleration);
            (v - a * a / (2.0 * jerk), a)
        };
        let ((c0, a0), (c1, a1)) = (along(self.from), along(self.to));
        let total = self.scale.duration + (a0 - a1) / jerk;
        let sum = 0.5 * jerk * total;
        let first = 0.5 * (sum + jerk * (c1 - c0) / sum);
        let cruise = if first.max(sum - first) <= limit {
            c0 + first * first / jerk
        } else {
            let one_at_limit = |held: f64, other: f64| {
                let square = jerk * (limit * total - (other - held));
                square.max(0.0).sqrt() - limit
            };
            let (start_peak, end_peak) = (one_at_limit(c1, c0), one_at_limit(c0, c1));
            if end_peak <= limit && c0 <= c1 {
                c1 + end_peak * end_peak / jerk
            } else if start_peak <= limit && c1 <= c0 {
                c0 + start_peak * start_peak / jerk
            } else {
                0.5 * (limit * (total - 2.0 * limit / jerk) + c0 + c1)
            }
        };
        direction * cruise
    }

    /// The steps whose cruise velocity is near the guess and that end at the target, if they are the ones.
    ///
    /// Newton's method on the position at the end. As `v_c` grows by `d`, the velocity grows by `d` in the cruise,
    /// not at all before a ramp's peak is left, and the peak moves by half of what is left: the position grows by `d`
    /// times the cruise and half of the jerks that lead into it and out of it.
    fn solve(&self, guess: f64, instant: f64) -> Option<Steps> {
        let mut cruise = guess;
        for _ in 0..NEWTON_STEPS {
            let steps = self.steps(cruise);
            // A step that takes no time may come out as a negative one, by rounding.
            if steps
                .iter()
                .any(|&(time, _)| time.is_nan() || time < -instant)
            {
                return None;
            }
            let missing = self.to.position - self.end_of(&steps);
            if missing.abs() <= self.scale.position_rounding() {
                let allowed = cruise.abs() <= self.limits.velocity + self.scale.velocity_rounding();
                return (allowed && self.explains(&steps)).then_some(steps);
            }
            cruise += missing / (steps[3].0 + 0.5 * (steps[2].0 + steps[4].0));
        }
        None
    }

    fn steps(&self, cruise: f64) -> Steps {
        let Self { from, to, .. } = *self;
        let rounding = self.scale.velocity_rounding();
        let ramp = |state| Ramp::new(state, cruise, self.limits, rounding);
        let first = ramp((from.velocity, from.acceleration));
        // Backwards in time the acceleration has the other sign, the jerk the same.
        let last = ramp((to.velocity, -to.acceleration));
        let rest = self.scale.duration - first.duration() - last.duration();
        let up = first.direction * self.limits.jerk;
        let down = -last.direction * self.limits.jerk;
        [
            (first.times[0], up),
            (first.times[1], 0.0),
            (first.times[2], -up),
            (rest, 0.0),
            (last.times[2], down),
            (last.times[1], 0.0),
            (last.times[0], -down),
        ]
    }

    fn end_of(&self, steps: &Steps) -> f64 {
        let after = |state: AxisState, &(time, jerk): &(f64, f64)| state.after(time, jerk);
        steps.iter().fold(self.from, after).position
    }

    /// Whether the steps lead through the state that was seen, to what Ruckig asks of its own profiles.
    fn explains(&self, steps: &Steps) -> bool {
        let (time, seen) = self.seen;
        let mut state = self.from;
        let mut left = time;
        for &(duration, jerk) in steps {
            state = state.after(duration.min(left), jerk);
            left -= duration;
            if left <= 0.0 {
                break;
            }
        }
        (state.position - seen.position).abs() <= 1e-8
            && (state.velocity - seen.velocity).abs() <= 1e-8
            && (state.acceleration - seen.acceleration).abs() <= 1e-10
    }

    /// Steps that take no time are left out, and neighbours of the same jerk are one phase.
    fn profile(&self, steps: &Steps, instant: f64) -> AxisProfile {
        let mut phases: Vec<Phase> = Vec::with_capacity(steps.len());
        let mut start = 0.0;
        let mut state = self.from;
        for &(duration, jerk) in steps.iter().filter(|step| step.0 > instant) {
            match phases.last_mut() {
                Some(last) if last.jerk == jerk => last.duration += duration,
                _ => phases.push(Phase {
                    start,
                    duration,
                    state,
                    jerk,
                }),
            }
            state = state.after(duration, jerk);
            start += duration;
        }
        AxisProfile::new(phases, (self.from, self.to), self.scale.duration)
    }
}
