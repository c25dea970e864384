//! The planner: checks a problem, hands it to Ruckig, and reads the answer back into plain data.

use ruckig::ControlInterface;

use crate::problem::Problem;
use crate::{AxisState, Limits, MAX_DEGREES_OF_FREEDOM, PlanError, Trajectory};

/// Plans moves of a fixed number of axes.
///
/// Planning allocates and takes from a microsecond to tens, in rare cases a millisecond: off the tick.
/// The planner itself holds nothing of Ruckig's, so that it may be sent and shared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Planner {
    degrees_of_freedom: usize,
}

impl Planner {
    /// A planner for `degrees_of_freedom` axes, 1 to 7.
    ///
    /// # Errors
    /// [`PlanError::DegreesOfFreedom`] for any other number.
    pub fn new(degrees_of_freedom: usize) -> Result<Self, PlanError> {
        if !(1..=MAX_DEGREES_OF_FREEDOM).contains(&degrees_of_freedom) {
            return Err(PlanError::DegreesOfFreedom {
                given: degrees_of_freedom,
            });
        }
        Ok(Self { degrees_of_freedom })
    }

    /// Number of axes.
    pub fn degrees_of_freedom(&self) -> usize {
        self.degrees_of_freedom
    }

    /// The quickest move from state to state within the limits, all axes arriving together. In mid-move
    /// it begins with [`Trajectory::state_at`]: it goes on without a jump up to the acceleration.
    ///
    /// One entry for each axis in `from`, `to` and `limits`. The target may move
    /// ([`AxisState::at_rest`] if it does not) but must be within the limits. The start may be
    /// beyond them, as after a change of limits: then the axis is first brought back within them,
    /// as quickly as the jerk allows. Between start and end the limits hold to rounding.
    ///
    /// # Errors
    /// A [`PlanError`] that names the axis and the value, or says what Ruckig could not do.
    pub fn plan(
        &self,
        from: &[AxisState],
        to: &[AxisState],
        limits: &[Limits],
    ) -> Result<Trajectory, PlanError> {
        self.check_start(from, limits)?;
        self.check_target(to, limits)?;
        let problem = Problem {
            from,
            to,
            limits,
            interface: ControlInterface::Position,
        };
        problem.solve()
    }

    /// The quickest jerk-limited stop from a state; where the axes come to rest follows.
    ///
    /// All axes come to rest together, when the slowest of them can. Velocity limits are checked
    /// but play no part: the acceleration goes to its limit against the motion.
    ///
    /// From `v` at no acceleration it takes `v / a + a / j` if `v >= a^2 / j`, else
    /// `2 sqrt(v / j)`, and half of `v` times that in distance.
    ///
    /// # Errors
    /// As [`Planner::plan`].
    pub fn plan_stop(
        &self,
        from: &[AxisState],
        limits: &[Limits],
    ) -> Result<Trajectory, PlanError> {
        self.check_start(from, limits)?;
        let to: Vec<_> = from
            .iter()
            .map(|state| AxisState::at_rest(state.position))
            .collect();
        let problem = Problem {
            from,
            to: &to,
            limits,
            interface: ControlInterface::Velocity,
        };
        problem.solve()
    }
}
