//! The role of a column: by its name, its unit and what stands beside it.

use super::super::role::Role;
use super::super::unit::Dimension;
use super::content::Content;
use super::{drives, gyroscope, inertial, robots, siemens, tool};

/// The role of a column, and whether it is certain.
pub fn role(content: &Content, index: usize) -> Option<(Role, bool)> {
    let name = &content.columns[index].name;
    let fixed = drives::sercos(name).or_else(|| drives::odrive(name).map(|own| own.0));
    if let Some(role) = fixed {
        return Some((role, true));
    }
    if let Some(signal) = robots::signal(content, index) {
        return signal.map(|(role, _, known)| (role, known));
    }
    let of_drive = siemens::role(content, index).or_else(|| drives::elmo(content, index));
    if let Some(found) = of_drive {
        return Some(found);
    }
    if inertial::axis(name).is_some() {
        return Some((Role::TipAcceleration, true));
    }
    if let Some(axis) = gyroscope::role(content, index)
        && !inertial::is_of_accelerometer(content, index)
    {
        return axis;
    }
    let own = by_name(content, index)
        .filter(|own| own.1 || !inertial::is_of_accelerometer(content, index));
    tool::place(content, index).map_or(own, |place| tool::role(place, own))
}

/// The axis of a column: 0, 1 or 2.
pub fn axis(content: &Content, index: usize) -> Option<usize> {
    let name = &content.columns[index].name;
    let called = name.axis().or_else(|| Some(inertial::axis(name)?.0));
    called.or_else(|| tool::place(content, index))
}

fn by_name(content: &Content, index: usize) -> Option<(Role, bool)> {
    let name = &content.columns[index].name;
    // RepRapFirmware calls the axes of its accelerometer X, Y and Z, as a phone does in a file `Accelerometer.csv`.
    let of_one = content.told_rate_hz.is_some()
        || name.words.len() == 1 && content.is_called_accelerometer();
    if of_one && name.axis().is_some() {
        return Some((Role::TipAcceleration, true));
    }
    if name.is_error() {
        return None;
    }
    if let Some(role) = super::theta::role(content, index) {
        return Some((role, false));
    }
    let dimension = name.dimension();
    let named = name.role();
    // A tool with an acceleration's unit has an accelerometer.
    match (named, dimension) {
        // A vibration may be told as a velocity or a length.
        (
            Some((Role::TipAcceleration | Role::LinkAcceleration, _)),
            Some(own @ (Dimension::Velocity | Dimension::AngularVelocity | Dimension::Length)),
        ) => by_dimension(own),
        (Some((role, true)), _) => Some((role, true)),
        (_, Some(Dimension::Acceleration)) => Some((Role::TipAcceleration, true)),
        // The command of a speed is no measured speed, and no position.
        (
            Some((Role::CommandPosition, _)),
            Some(Dimension::Velocity | Dimension::AngularVelocity | Dimension::AngularAcceleration),
        ) => None,
        (Some((Role::CommandPosition, _)), None) if name.is_speed() => None,
        // Any sensor gives volts at the input of an instrument.
        (None, Some(Dimension::Voltage)) if name.is_input() => None,
        // Steps of an encoder do not tell what moves.
        (Some(found), Some(Dimension::Number)) => Some(found),
        // An angle at the tip is that of the link.
        (Some((Role::TipPosition, _)), Some(Dimension::Angle)) => Some((Role::LinkPosition, false)),
        (Some((role, false)), Some(dimension)) => {
            let fits = role.entry().dimensions.contains(&dimension);
            fits.then_some((role, false))
                .or_else(|| by_dimension(dimension))
        }
        (Some(found), None) => Some(found),
        (None, Some(dimension)) => by_dimension(dimension),
        (None, None) => None,
    }
}

/// The most frequent role of a quantity.
fn by_dimension(dimension: Dimension) -> Option<(Role, bool)> {
    match dimension {
        Dimension::Angle => Some((Role::MotorPosition, false)),
        Dimension::Length => Some((Role::Deformation, false)),
        Dimension::Velocity | Dimension::AngularVelocity => Some((Role::LinkVelocity, false)),
        Dimension::AngularAcceleration => Some((Role::LinkAcceleration, false)),
        Dimension::Acceleration => Some((Role::TipAcceleration, true)),
        Dimension::Force => Some((Role::Force, true)),
        Dimension::Torque => Some((Role::Torque, true)),
        Dimension::Current => Some((Role::MotorCurrent, true)),
        Dimension::Voltage => Some((Role::MotorVoltage, true)),
        Dimension::MomentOfInertia => Some((Role::Inertia, true)),
        Dimension::Mass | Dimension::Number => None,
    }
}
