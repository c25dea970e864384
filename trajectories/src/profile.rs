//! The move of one axis: phases of constant jerk.

use crate::AxisState;

/// A stretch of constant jerk.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phase {
    /// When it begins, s after the start of the move.
    pub start: f64,
    /// How long it lasts, s.
    pub duration: f64,
    /// State at its beginning.
    pub state: AxisState,
    /// Jerk during the phase, rad/s^3.
    pub jerk: f64,
}

/// The move of one axis as phases of constant jerk: up to seven, and up to two more in front where
/// the axis starts beyond a limit.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisProfile {
    phases: Vec<Phase>,
    start: AxisState,
    end: AxisState,
    duration: f64,
}

impl AxisProfile {
    /// The phases of a move of `duration` (s), and its exact ends.
    pub(crate) fn new(
        phases: Vec<Phase>,
        (start, end): (AxisState, AxisState),
        duration: f64,
    ) -> Self {
        Self {
            phases,
            start,
            end,
            duration,
        }
    }

    /// The state at `time` (s): exactly the start up to 0, exactly the end from the duration on.
    ///
    /// Runs at the tick: a look-up over the phases, at most nine of a planned move; no allocation.
    pub fn state_at(&self, time: f64) -> AxisState {
        if time >= self.duration {
            return self.end;
        }
        if time <= 0.0 {
            return self.start;
        }
        let phase = self.phases.iter().rev().find(|phase| phase.start <= time);
        phase.map_or(self.start, |phase| {
            phase.state.after(time - phase.start, phase.jerk)
        })
    }

    /// The phases of constant jerk, in order, without gaps; empty if the move lasts 0 s.
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// The state in which the axis ends: the target, to the bit.
    pub fn end(&self) -> AxisState {
        self.end
    }
}
