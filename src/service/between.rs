//! The motion between two setpoints.

use quell_shapers::Setpoint;
use quell_trajectories::{AxisState, Limits};

use crate::controller::setpoint;

/// [`AxisState::between`] of setpoints.
pub fn between([from, to]: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    setpoint(state(from).between(state(to), share, period))
}

/// [`AxisState::between_within_limits`] of setpoints.
pub fn within_limits([from, to]: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    setpoint(state(from).between_within_limits(state(to), share, period))
}

/// How far a command may be beyond the exact end of a stop that begins between two samples of a plan, rad.
///
/// The velocity there is linear and differs from the derivative of the position by up to `j h^2 / 8`
/// ([`AxisState::between_within_limits`]). A stop goes further by its own duration, `v / a + a / j` at most, for each
/// unit of velocity. Between two setpoints there is `j h^3 / 6` at most. The exact derivative would end the stop
/// exactly, but exceed the limits by 4 %. At 1 kHz it is some 1e-5 rad: what the gate of the tick admits, too.
pub fn inexact(limits: Limits, period: f64) -> f64 {
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = limits;
    let stop = velocity / acceleration + acceleration / jerk;
    jerk * period.powi(2) * (stop / 8.0 + period / 6.0)
}

/// A setpoint as the planner names it.
pub fn state(of: Setpoint) -> AxisState {
    AxisState {
        position: of.position,
        velocity: of.velocity,
        acceleration: of.acceleration,
    }
}
