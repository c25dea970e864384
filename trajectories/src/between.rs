//! The motion between two samples.

use crate::AxisState;

impl AxisState {
    /// The state at a `share` (0 to 1) of the `period` (s) between this state and another one: the polynomial
    /// of fifth order with position, velocity and acceleration of both at its ends. At 1 it equals the second
    /// one to the bit.
    ///
    /// Within a period the jerk of a plan may change its sign, and the polynomial then changes the acceleration over a period by up to
    /// 4 % more than the plan does. Source: Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer
    /// 2008, section 2.1.
    pub fn between(self, to: Self, share: f64, period: f64) -> Self {
        if share >= 1.0 {
            return to;
        }
        let (v0, v1) = (self.velocity * period, to.velocity * period);
        let (a0, a1) = (
            self.acceleration * period * period,
            to.acceleration * period * period,
        );
        let way = to.position - self.position;
        let c2 = 0.5 * a0;
        let c3 = 10.0 * way - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
        let c4 = -15.0 * way + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
        let c5 = 6.0 * way - 3.0 * (v0 + v1) - 0.5 * (a0 - a1);
        let u = share;
        let slope = v0 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)));
        let bend = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5));
        Self {
            position: self.position + u * (v0 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
            velocity: slope / period,
            acceleration: bend / (period * period),
        }
    }

    /// [`between`](Self::between) with the linear velocity and acceleration: these keep every limit that the states keep, and their
    /// slopes are mean acceleration and mean jerk of the period. They differ from the derivatives of the position by up to `j h^2 / 8`
    /// and `j h / 2`, with `j` the limit of the jerk and `h` the period.
    pub fn between_within_limits(self, to: Self, share: f64, period: f64) -> Self {
        if share >= 1.0 {
            return to;
        }
        let linear = |from: f64, to: f64| from + share * (to - from);
        Self {
            position: self.between(to, share, period).position,
            velocity: linear(self.velocity, to.velocity),
            acceleration: linear(self.acceleration, to.acceleration),
        }
    }
}
