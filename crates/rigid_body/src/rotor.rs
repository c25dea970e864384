//! The inertia that turns with a motor, and that no description has.

use super::contradiction::{Own, Rows, torque};
use super::dynamics::Dynamics;
use super::robot::{Joint, Robot};
use nalgebra::DVector;

/// Why the torques of a joint show nothing of its rotor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unseen {
    /// The recording has no torque of it.
    #[error("the recording has no torque of it")]
    Torque,
    /// It hardly moves.
    #[error("it hardly moves in the recording")]
    Motion,
}

/// The inertia at a joint beside that of the links, kg.m^2 (kg where it slides): the slope of the torque that a description
/// leaves over the joint's acceleration, any friction over its velocity left free. About 0 of a description that has
/// the rotor, and below 0 of one that has too much.
///
/// # Errors
/// [`Unseen`] where no torque was measured, or the joint hardly moves.
pub fn rotor(robot: &Robot, dynamics: &Dynamics, joint: &Joint) -> Result<f64, Unseen> {
    if torque(robot, joint).is_none() {
        return Err(Unseen::Torque);
    }
    let rows = Rows::of(robot, joint, Own::Speed).ok_or(Unseen::Motion)?;
    let of = |[_, _, acceleration]: &[Vec<f64>; 3]| acceleration[joint.index];
    let column = DVector::from_iterator(rows.time.len(), rows.states.iter().map(of));
    let column = rows.without_own(column);
    let slope = column.dot(&rows.left(dynamics)) / column.norm_squared();
    slope.is_finite().then_some(slope).ok_or(Unseen::Motion)
}
