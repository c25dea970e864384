//! How far a motion reaches at least, and a stop that goes no further than a range allows.
//!
//! A motion upward reaches least if it brakes as hard as it can until it turns: at jerk `-j` down to the acceleration
//! `-A`, and on at that. With `t = (A + a) / j` and `v_1 = v + a t - j t^2 / 2`, where `v_1 > 0`, it turns
//! `v_1 / A` later; else within the first step, at `(a + sqrt(a^2 + 2 j v)) / j`. Downward it is the same, mirrored.
//! A motion from which this leads out of a range leaves it within any limits. The quickest stop may go further: it
//! takes its acceleration back before it stands.

use crate::path::Step;
use crate::ramp::Ramp;
use crate::{AxisState, Limits};

/// Steps of constant jerk until a motion turns.
const TURN: usize = 2;
/// Steps of the quickest stop.
const STOP: usize = 3;

impl AxisState {
    /// The lowest and the highest position (rad) that a motion within acceleration and jerk `limits` passes at least
    /// from here on. Runs at the tick; allocates nothing.
    pub fn reaches(self, limits: Limits) -> [f64; 2] {
        [-1.0, 1.0].map(|side| {
            let end = after(self, &self.turn(side, limits)).position;
            side * (side * self.position).max(side * end)
        })
    }

    /// The steps to where a motion toward a `side` (1: up, -1: down) turns; none where it does not go there.
    fn turn(self, side: f64, limits: Limits) -> [Step; TURN] {
        let (velocity, acceleration) = (side * self.velocity, side * self.acceleration);
        let (jerk, most) = (limits.jerk, limits.acceleration.max(acceleration.abs()));
        let square = acceleration * acceleration + 2.0 * jerk * velocity;
        if velocity <= 0.0 && (acceleration <= 0.0 || square <= 0.0) {
            return [(0.0, 0.0); TURN];
        }
        let first = (most + acceleration) / jerk;
        let held = velocity + first * (acceleration - 0.5 * jerk * first);
        match held > 0.0 {
            true => [(first, -side * jerk), (held / most, 0.0)],
            false => [
                ((acceleration + square.sqrt()) / jerk, -side * jerk),
                (0.0, 0.0),
            ],
        }
    }
}

/// A stop within jerk and acceleration limits: the quickest, or one that turns first where that one would leave a range.
///
/// It stays within the range wherever [`AxisState::reaches`] does, and the range is wide enough for the way back,
/// `0.69 A^3 / j^2` at most.
#[derive(Clone, Copy, Debug)]
pub struct Brake {
    from: AxisState,
    steps: [Step; TURN + STOP],
}

impl Brake {
    /// The stop from a state, within a range, rad. Runs at the tick; allocates nothing.
    pub fn within(from: AxisState, limits: Limits, range: [f64; 2]) -> Self {
        let limits = Limits {
            acceleration: limits.acceleration.max(from.acceleration.abs()),
            ..limits
        };
        let stop = joined([(0.0, 0.0); TURN], quickest(from, limits));
        let [lowest, highest] = extent(from, &stop);
        let side = match (lowest < range[0], highest > range[1]) {
            (false, false) => return Self { from, steps: stop },
            (true, _) => -1.0,
            (false, true) => 1.0,
        };
        let turn = from.turn(side, limits);
        let rest = quickest(after(from, &turn), limits);
        Self {
            from,
            steps: joined(turn, rest),
        }
    }

    /// Its duration, s.
    pub fn duration(&self) -> f64 {
        self.steps.iter().map(|(time, _)| time).sum()
    }

    /// The state after `time` (s, 0 or more); from its duration on at rest. Runs at the tick; allocates nothing.
    pub fn after(&self, time: f64) -> AxisState {
        let mut left = time;
        let mut state = self.from;
        for (duration, jerk) in self.steps {
            if left < duration {
                return state.after(left, jerk);
            }
            left -= duration;
            state = state.after(duration, jerk);
        }
        AxisState::at_rest(state.position)
    }
}

fn joined(turn: [Step; TURN], stop: [Step; STOP]) -> [Step; TURN + STOP] {
    let [a, b] = turn;
    let [c, d, e] = stop;
    [a, b, c, d, e]
}

/// The steps of [`Ramp`] to no velocity.
pub(crate) fn quickest(from: AxisState, limits: Limits) -> [Step; STOP] {
    let Ramp { jerk, times } = Ramp::new((from.velocity, from.acceleration), 0.0, limits, 0.0);
    let [rise, hold, fall] = times;
    [(rise, jerk), (hold, 0.0), (fall, -jerk)]
}

pub(crate) fn after(from: AxisState, steps: &[Step]) -> AxisState {
    let step = |state: AxisState, &(time, jerk): &Step| state.after(time, jerk);
    steps.iter().fold(from, step)
}

/// The lowest and the highest position on steps of constant jerk: at their ends, and where the velocity vanishes.
fn extent(from: AxisState, steps: &[Step]) -> [f64; 2] {
    let (mut state, mut extent) = (from, [from.position; 2]);
    for &(time, jerk) in steps {
        let within = turns(state, jerk)
            .into_iter()
            .filter(|at| (0.0..time).contains(at));
        for at in within.chain([time]) {
            let position = state.after(at, jerk).position;
            extent = [extent[0].min(position), extent[1].max(position)];
        }
        state = state.after(time, jerk);
    }
    extent
}

/// When the velocity vanishes at constant jerk, s; what is no number or negative is no such time.
fn turns(state: AxisState, jerk: f64) -> [f64; 2] {
    let (velocity, acceleration) = (state.velocity, state.acceleration);
    let root = (acceleration * acceleration - 2.0 * jerk * velocity).sqrt();
    // Without cancellation: the product of the roots is 2 v / j.
    let sum = -(acceleration + acceleration.signum() * root);
    [sum / jerk, 2.0 * velocity / sum]
}
