//! What a state leads to: whether the limits are kept from there, and where its quickest stop ends.

use crate::brake::{after, quickest};
use crate::{AxisState, Limits};

/// Rounding of a state at a limit by the planner, relative.
const ROUNDING: f64 = 1e-9;

impl AxisState {
    /// Whether the limits are kept from here on if the acceleration goes to 0 as quickly as the jerk allows: the velocity is
    /// `v + a |a| / 2 j` then.
    pub fn keeps(self, limits: Limits) -> bool {
        let (velocity, acceleration) = (self.velocity, self.acceleration);
        let coasted = velocity + acceleration * acceleration.abs() / (2.0 * limits.jerk);
        let within = |value: f64, most: f64| value.abs() <= most * (1.0 + ROUNDING);
        within(velocity, limits.velocity)
            && within(coasted, limits.velocity)
            && within(acceleration, limits.acceleration)
    }

    /// Where the stop of [`crate::Planner::plan_stop`] ends, rad, from a state that [`keeps`](Self::keeps) the limits.
    pub fn stops_at(self, limits: Limits) -> f64 {
        after(self, &quickest(self, limits)).position
    }
}
