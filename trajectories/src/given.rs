//! A move of one axis that was planned elsewhere.

use crate::problem::END_TOLERANCES;
use crate::{AxisProfile, AxisState, Phase, PlanError, Trajectory};

impl Trajectory {
    /// A move of one axis from steps of constant jerk, each a duration (s, above 0) and a jerk (rad/s^3).
    ///
    /// # Errors
    /// [`PlanError::Value`] where a duration or a jerk is none, [`PlanError::Inexact`] where the steps do not lead to the target.
    ///
    /// # Example
    /// ```
    /// use quell_trajectories::{AxisState, Trajectory};
    /// let steps = [(1.0, 1.0), (2.0, -1.0), (1.0, 1.0)];
    /// let plan = Trajectory::of_steps(AxisState::at_rest(0.0), AxisState::at_rest(2.0), &steps)?;
    /// assert_eq!(plan.duration(), 4.0);
    /// # Ok::<(), quell_trajectories::PlanError>(())
    /// ```
    pub fn of_steps(
        from: AxisState,
        to: AxisState,
        steps: &[(f64, f64)],
    ) -> Result<Self, PlanError> {
        let mut phases = Vec::with_capacity(steps.len());
        let (mut start, mut state) = (0.0, from);
        for &(duration, jerk) in steps {
            for (what, value, valid, rule) in [
                ("duration", duration, duration > 0.0, "finite and above 0"),
                ("jerk", jerk, true, "finite"),
            ] {
                if !(value.is_finite() && valid) {
                    return Err(PlanError::Value {
                        axis: 0,
                        what,
                        value,
                        rule,
                    });
                }
            }
            phases.push(Phase {
                start,
                duration,
                state,
                jerk,
            });
            state = state.after(duration, jerk);
            start += duration;
        }
        let errors = [
            state.position - to.position,
            state.velocity - to.velocity,
            state.acceleration - to.acceleration,
        ];
        let largest = from.position.abs().max(to.position.abs());
        for ((what, tolerance), error) in END_TOLERANCES.into_iter().zip(errors) {
            if error.is_nan() || error.abs() > tolerance + 4.0 * f64::EPSILON * largest {
                return Err(PlanError::Inexact {
                    axis: 0,
                    what,
                    error,
                });
            }
        }
        Ok(Self {
            axes: vec![AxisProfile::new(phases, (from, to), start)],
            duration: start,
        })
    }
}
