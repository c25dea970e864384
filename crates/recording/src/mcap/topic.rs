//! The service's own topics: which role a topic has, and in which field of its type the value is.
//!
//! | topic | type | role |
//! |---|---|---|
//! | `/joint_states` | `sensor_msgs/msg/JointState` | `motor_position` |
//! | `/quell/<joint>/command` | `sensor_msgs/msg/JointState` | `command_position`; the velocity beside it |
//! | `/quell/<joint>/command_acceleration` | `std_msgs/msg/Float64` | none, for the eye |
//! | `/quell/<joint>/<numbers>` | `std_msgs/msg/Float64MultiArray` | none: what is known of the joint |
//! | `/quell/<joint>/<role>` | see [`carrier`] | the role of that name |

use super::message::{Definition, FLOAT, JOINT_STATE, POINT_STAMPED, VECTOR_STAMPED};
use crate::Role;

/// The topic of ROS 2's joint states.
pub(super) const JOINT_STATES: &str = "/joint_states";
/// Last part of the topic of commanded accelerations, which a joint state has no field for.
pub(super) const COMMAND_ACCELERATION: &str = "command_acceleration";
/// Last part of the topic of commands.
const COMMAND: &str = "command";

/// A type of message and the fields of it that hold the value; a field with a joint's name in brackets
/// is found by that name.
pub(super) struct Carrier {
    pub definition: &'static Definition,
    pub fields: &'static [&'static str],
}

/// The type of message that carries so many columns of a role.
///
/// Where ROS 2 has no stamped scalar for a role it is a `Float64`, and its publish time is the sensor's stamp.
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
