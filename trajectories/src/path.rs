//! Steps of constant jerk, joined from a start.

use crate::read_back::Scale;
use crate::{AxisProfile, AxisState, Phase};

/// How long a step lasts (s), and at which jerk.
pub(crate) type Step = (f64, f64);

/// The most steps of a profile: up, hold, down, cruise, down, hold, up.
pub(crate) const STEPS: usize = 7;

/// Steps of constant jerk and the states at their beginnings.
pub(crate) struct Path {
    steps: [Step; STEPS],
    states: [AxisState; STEPS],
    end: AxisState,
}

impl Path {
    /// `None` if a step takes less than no time.
    pub(crate) fn new(from: AxisState, steps: [Step; STEPS], scale: &Scale) -> Option<Self> {
        // A step that takes no time may come out as a negative one, by rounding.
        let instant = scale.instant();
        if steps
            .iter()
            .any(|&(time, _)| time.is_nan() || time < -instant)
        {
            return None;
        }
        let mut end = from;
        let states = steps.map(|(time, jerk)| {
            let state = end;
            end = state.after(time, jerk);
            state
        });
        Some(Self { steps, states, end })
    }

    /// The state after the last step.
    pub(crate) fn end(&self) -> AxisState {
        self.end
    }

    /// The state at a time (s) up to the end.
    pub(crate) fn state_at(&self, time: f64) -> AxisState {
        let mut left = time;
        for (&(duration, jerk), state) in self.steps.iter().zip(&self.states) {
            if left < duration {
                return state.after(left, jerk);
            }
            left -= duration;
        }
        self.end
    }

    /// Steps that take no time are left out, and neighbours of the same jerk are one phase.
    pub(crate) fn profile(&self, to: AxisState, scale: &Scale) -> AxisProfile {
        let mut phases: Vec<Phase> = Vec::with_capacity(STEPS);
        let mut start = 0.0;
        for (&(duration, jerk), &state) in self.steps.iter().zip(&self.states) {
            if duration > scale.instant() {
                match phases.last_mut() {
                    Some(last) if last.jerk == jerk => last.duration += duration,
                    _ => phases.push(Phase {
                        start,
                        duration,
                        state,
                        jerk,
                    }),
                }
            }
            start += duration;
        }
        AxisProfile::new(phases, (self.states[0], to), scale.duration)
    }
}
