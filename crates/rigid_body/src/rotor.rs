//! The inertia that turns with a motor, and that no description has.

use super::contradiction::{Own, Rows};
use super::dynamics::Dynamics;
use super::robot::{Joint, Robot};
use nalgebra::DVector;

/// The inertia at a joint beside that of the links, kg.m^2 (kg where it slides): the slope of the torque that a description
/// leaves over the joint's acceleration, any friction over its velocity left free. None where no torque was measured, the
/// joint hardly moves, or the slope is not above 0.
pub fn rotor(robot: &Robot, dynamics: &Dynamics, joint: &Joint) -> Option<f64> {
    let rows = Rows::of(robot, joint, Own::Speed)?;
    let of = |[_, _, acceleration]: &[Vec<f64>; 3]| acceleration[joint.index];
    let column = DVector::from_iterator(rows.time.len(), rows.states.iter().map(of));
    let column = rows.without_own(column);
    let slope = column.dot(&rows.left(dynamics)) / column.norm_squared();
    (slope.is_finite() && slope > 0.0).then_some(slope)
}
