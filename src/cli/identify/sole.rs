//! A channel of what drives an axis, or of its motor side, without any other: it tells how it decays, and no more.

use crate::cli::CliError;
use crate::identification::output_only::{Excitation, OutputOnly};
use crate::recording::{Recording, Role};

/// Channels that decay with an arm that a servo or a brake holds, and otherwise do what somebody wants them to.
const DRIVEN: [Role; 6] = [
    Role::MotorPosition,
    Role::MotorVelocity,
    Role::Torque,
    Role::Force,
    Role::MotorCurrent,
    Role::MotorVoltage,
];

/// The only channel of a recording, if it is one of these.
pub fn role(recording: &Recording) -> Option<Role> {
    match recording.channels.as_slice() {
        [one] if DRIVEN.contains(&one.role) => Some(one.role),
        _ => None,
    }
}

/// Refuses what such a channel shows elsewhere than in a free decay: nobody knows then what drove it.
///
/// # Errors
/// [`CliError::Input`] with the channels to record beside it.
pub fn refuse_driven(recording: &Recording, found: &OutputOnly) -> Result<(), CliError> {
    let sole = role(recording).filter(|_| found.excitation != Excitation::Decay);
    sole.map_or(Ok(()), |role| {
        Err(CliError::input(format!(
            "{}: {role} alone tells a mode where it decays freely, and it nowhere does. Record link_position, deformation or \
             tip_acceleration beside it",
            recording.name
        )))
    })
}
