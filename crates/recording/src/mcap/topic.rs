//! Quell's own topics: the role of a topic, and the field of its type with the value.
//!
//! | topic | type | role |
//! |---|---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` | `motor_position` |
//! | `/quell/<joint>/command` | `sensor_msgs/msg/JointState` | `command_position`; the velocity beside it |
//! | `/quell/<joint>/command_acceleration` | `std_msgs/msg/Float64` | none, for display |
//! | `/quell/<joint>/<numbers>` | `std_msgs/msg/Float64MultiArray` | none: knowledge about the joint |
//! | `/quell/<joint>/<role>` | see [`carrier`] | the role of that name |

use super::message::{Definition, FLOAT, JOINT_STATE, POINT_STAMPED, VECTOR_STAMPED};
use crate::Role;

/// The topic of ROS 2's joint states.
pub(super) const JOINT_STATES: &str = "/joint_states";
/// Last part of the topic of commanded accelerations, for which a joint state has no field.
pub(super) const COMMAND_ACCELERATION: &str = "command_acceleration";
/// Last part of the topic of commands.
const COMMAND: &str = "command";

/// A message type and its fields with the value. A field with a joint's name in brackets is found by that name.
pub(super) struct Carrier {
    pub definition: &'static Definition,
    pub fields: &'static [&'static str],
}

/// The message type for this number of columns of a role.
///
/// If ROS 2 has no stamped scalar for a role, it is a `Float64`, and its publish time is the sensor's stamp.
pub(super) fn carrier(role: Role, columns: usize) -> Carrier {
    let (definition, fields): (_, &[&str]) = match role {
        Role::CommandPosition | Role::MotorPosition | Role::LinkPosition | Role::Deformation => {
            (&JOINT_STATE, &["position"])
        }
        Role::MotorVelocity | Role::LinkVelocity => (&JOINT_STATE, &["velocity"]),
        Role::Force | Role::Torque | Role::KnownForce => (&JOINT_STATE, &["effort"]),
        Role::TipPosition => (&POINT_STAMPED, &["point.x", "point.y", "point.z"]),
        Role::TipAcceleration if columns == 3 => {
            (&VECTOR_STAMPED, &["vector.x", "vector.y", "vector.z"])
        }
        Role::TipAcceleration
        | Role::LinkAcceleration
        | Role::MotorCurrent
        | Role::MotorVoltage
        | Role::Inertia => (&FLOAT, &["data"]),
    };
    Carrier { definition, fields }
}

/// The topic of a joint's role.
pub(super) fn topic(joint: &str, role: Role) -> String {
    match role {
        Role::MotorPosition => JOINT_STATES.into(),
        Role::CommandPosition => quantity(joint, COMMAND),
        _ => quantity(joint, role.name()),
    }
}

/// The topic of a joint's quantity.
pub(super) fn quantity(joint: &str, name: &str) -> String {
    format!("/quell/{joint}/{name}")
}

/// Joint and role of a topic of Quell's own.
pub(super) fn joint_and_role(topic: &str) -> Option<(&str, Role)> {
    let (joint, name) = topic.strip_prefix("/quell/")?.rsplit_once('/')?;
    let role = match name {
        COMMAND => Role::CommandPosition,
        _ => Role::from_name(name)?,
    };
    Some((joint, role))
}
