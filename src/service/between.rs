//! The motion between two setpoints.

use quell_shapers::Setpoint;
use quell_trajectories::AxisState;

use crate::controller::setpoint;

/// [`AxisState::between`] of setpoints.
pub fn between([from, to]: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    setpoint(state(from).between(state(to), share, period))
}

/// [`AxisState::between_within_limits`] of setpoints.
pub fn within_limits([from, to]: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    setpoint(state(from).between_within_limits(state(to), share, period))
}

fn state(of: Setpoint) -> AxisState {
    AxisState {
        position: of.position,
        velocity: of.velocity,
        acceleration: of.acceleration,
    }
}
