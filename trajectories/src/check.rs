//! Checks before Ruckig gets a problem: a wrong length makes it read past the end of a vector.

use crate::{AxisState, Limits, PlanError, Planner};

/// Limits and states below this magnitude are the range in which Ruckig is tested (its README).
const TESTED_RANGE: f64 = 1e9;

impl Planner {
    pub(crate) fn check_length(&self, what: &'static str, given: usize) -> Result<(), PlanError> {
        let expected = self.degrees_of_freedom();
        if given == expected {
            Ok(())
        } else {
            Err(PlanError::Length {
                what,
                expected,
                given,
            })
        }
    }

    pub(crate) fn check_start(
        &self,
        from: &[AxisState],
        limits: &[Limits],
    ) -> Result<(), PlanError> {
        self.check_length("limits", limits.len())?;
        for (index, limit) in limits.iter().enumerate() {
            self.check_limit(index, "velocity limit", limit.velocity)?;
            self.check_limit(index, "acceleration limit", limit.acceleration)?;
            self.check_limit(index, "jerk limit", limit.jerk)?;
        }
        self.check_length("start states", from.len())?;
        for (index, state) in from.iter().enumerate() {
            self.check_value(index, "start position", state.position)?;
            self.check_value(index, "start velocity", state.velocity)?;
            self.check_value(index, "start acceleration", state.acceleration)?;
        }
        Ok(())
    }

    pub(crate) fn check_target(
        &self,
        to: &[AxisState],
        limits: &[Limits],
    ) -> Result<(), PlanError> {
        self.check_length("target states", to.len())?;
        for (index, (state, limit)) in to.iter().zip(limits).enumerate() {
            self.check_value(index, "target position", state.position)?;
            self.check_value(index, "target velocity", state.velocity)?;
            self.check_value(index, "target acceleration", state.acceleration)?;
            self.check_beyond(index, "velocity", state.velocity, limit.velocity)?;
            self.check_beyond(
                index,
                "acceleration",
                state.acceleration,
                limit.acceleration,
            )?;
            self.check_approach(index, state, limit)?;
        }
        Ok(())
    }

    fn check_limit(&self, index: usize, what: &'static str, value: f64) -> Result<(), PlanError> {
        if value > 0.0 && value < TESTED_RANGE {
            return Ok(());
        }
        let rule = "above 0 and below 1e9";
        Err(PlanError::Value {
            axis: index,
            what,
            value,
            rule,
        })
    }

    fn check_value(&self, index: usize, what: &'static str, value: f64) -> Result<(), PlanError> {
        if value.abs() < TESTED_RANGE {
            return Ok(());
        }
        let rule = "finite and within +-1e9";
        Err(PlanError::Value {
            axis: index,
            what,
            value,
            rule,
        })
    }

    fn check_beyond(
        &self,
        index: usize,
        what: &'static str,
        value: f64,
        limit: f64,
    ) -> Result<(), PlanError> {
        if value.abs() <= limit {
            return Ok(());
        }
        Err(PlanError::TargetBeyondLimit {
            axis: index,
            what,
            value,
            limit,
        })
    }

    /// A target that decelerates was faster a moment ago: `v + a^2 / 2 j` at zero acceleration.
    fn check_approach(
        &self,
        index: usize,
        target: &AxisState,
        limit: &Limits,
    ) -> Result<(), PlanError> {
        let AxisState {
            velocity,
            acceleration,
            ..
        } = *target;
        let value =
            velocity - acceleration.signum() * acceleration * acceleration / (2.0 * limit.jerk);
        if value.abs() <= limit.velocity {
            return Ok(());
        }
        let limit = limit.velocity;
        Err(PlanError::TargetUnreachable {
            axis: index,
            value,
            limit,
        })
    }
}
