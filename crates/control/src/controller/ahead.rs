//! The rest of the plan ahead of the axis.

use quell_shapers::Setpoint;
use quell_trajectories::{AxisState, SampledTrajectory};

/// The planned setpoints from the present tick on.
pub struct Ahead<'a> {
    plan: Option<&'a SampledTrajectory>,
    cursor: usize,
    rest: Setpoint,
}

impl<'a> Ahead<'a> {
    /// From tick `cursor` of `plan`; where there is no plan, the axis stays at `rest`.
    pub fn new(plan: Option<&'a SampledTrajectory>, cursor: usize, rest: Setpoint) -> Self {
        Self { plan, cursor, rest }
    }

    /// Ticks until the plan stands still, the present one included.
    pub fn remaining(&self) -> usize {
        self.plan
            .map_or(0, |plan| plan.samples().saturating_sub(self.cursor))
    }

    /// The setpoint `ticks` from now, 0 for the present one; the end of the plan after it.
    pub fn setpoint(&self, ticks: usize) -> Setpoint {
        let tick = self.cursor.saturating_add(ticks);
        match self.plan.and_then(|plan| plan.state(0, tick)) {
            Some(state) => setpoint(state),
            None => self.rest,
        }
    }
}

/// The planner's state as the shapers' crate names it; the two crates do not know each other.
pub fn setpoint(state: AxisState) -> Setpoint {
    let AxisState {
        position,
        velocity,
        acceleration,
    } = state;
    Setpoint {
        position,
        velocity,
        acceleration,
    }
}
