//! One axis: its limits and its kinematic state.

/// The most axes that one move may have.
pub const MAX_DEGREES_OF_FREEDOM: usize = 7;

/// Symmetric limits of one axis: `|q'| <= velocity`, `|q''| <= acceleration`, `|q'''| <= jerk`.
///
/// Units: rad/s, rad/s^2, rad/s^3 (m/s ... for a linear axis). Each is finite, above 0 and below
/// 1e9, the range in which Ruckig is tested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest speed, rad/s.
    pub velocity: f64,
    /// Largest acceleration, rad/s^2.
    pub acceleration: f64,
    /// Largest jerk, rad/s^3.
    pub jerk: f64,
}

impl Limits {
    /// The limits under which a plan from rest to rest is the same one, `1 / share` as long: `v s`, `a s^2`, `j s^3`.
    pub fn slowed(self, share: f64) -> Self {
        Self {
            velocity: self.velocity * share,
            acceleration: self.acceleration * share.powi(2),
            jerk: self.jerk * share.powi(3),
        }
    }
}

/// Position, velocity and acceleration of one axis at one instant (rad, rad/s, rad/s^2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Position `q`, rad.
    pub position: f64,
    /// Velocity `q'`, rad/s.
    pub velocity: f64,
    /// Acceleration `q''`, rad/s^2.
    pub acceleration: f64,
}

impl AxisState {
    /// The state at rest at `position` (rad).
    pub const fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// The state after `time` (s) of constant `jerk` (rad/s^3).
    ///
    /// `q + v t + a t^2 / 2 + j t^3 / 6` and its derivatives. Runs at the tick; allocates nothing.
    ///
    /// # Example
    /// ```
    /// use quell_trajectories::AxisState;
    /// let end = AxisState::at_rest(0.0).after(2.0, 6.0);
    /// assert_eq!(end, AxisState { position: 8.0, velocity: 12.0, acceleration: 12.0 });
    /// ```
    pub fn after(self, time: f64, jerk: f64) -> Self {
        let Self {
            position,
            velocity,
            acceleration,
        } = self;
        Self {
            position: position
                + time * (velocity + time * (acceleration / 2.0 + time * jerk / 6.0)),
            velocity: velocity + time * (acceleration + time * jerk / 2.0),
            acceleration: acceleration + time * jerk,
        }
    }
}
