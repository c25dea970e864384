//! The motor side's motion, by whichever channel a recording has of it.

use quell_recording::{Channel, Recording, Role};
use quell_signal::{Motion, Phase, RestRule, SignalError, integrated_velocity, phases};

/// Channels of the motor side's motion, the preferred one first. A command stands for what the motor side does of
/// it.
const ROLES: [Role; 3] = [
    Role::MotorPosition,
    Role::MotorVelocity,
    Role::CommandPosition,
];
/// Shortest rest in which a decay is looked for, s: two periods of 4 Hz.
const SHORTEST: f64 = 0.5;

/// The channel of a recording that tells the motor side's motion.
pub fn motor_side(recording: &Recording) -> Option<&Channel> {
    ROLES.iter().find_map(|role| recording.channel(*role))
}

/// Gives a recording a `motor_position` if it has another channel of the motor side; returns the role that it is
/// made of.
///
/// # Errors
/// [`SignalError`] where the channel is no time series.
pub fn provide(recording: &mut Recording) -> Result<Option<Role>, SignalError> {
    let Some(channel) = motor_side(recording) else {
        return Ok(None);
    };
    let role = channel.role;
    if role != Role::MotorPosition {
        let made = position(channel)?;
        recording.channels.push(made);
    }
    Ok(Some(role))
}

/// Rests of the motor side, before its first motion and after each; none where it does not move, or nothing tells its motion.
///
/// # Errors
/// As [`provide`].
pub fn rests(recording: &Recording) -> Result<Vec<Phase>, SignalError> {
    let Some(channel) = motor_side(recording).filter(|channel| channel.varies()) else {
        return Ok(Vec::new());
    };
    let made = position(channel)?;
    let values = &made.columns[0];
    let mut rests = phases(&made.time, values, RestRule::from_values(values))?;
    rests.retain(|p| p.motion == Motion::Rest && p.end - p.start >= SHORTEST);
    Ok(rests)
}

/// A motor position of a channel: itself, or the integral of a velocity.
fn position(channel: &Channel) -> Result<Channel, SignalError> {
    match channel.role {
        Role::MotorVelocity => integrated_velocity(channel),
        _ => Ok(Channel {
            role: Role::MotorPosition,
            ..channel.clone()
        }),
    }
}
