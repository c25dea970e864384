//! Roles: the quantity of a channel, and thus its place in the chain of the axis.

use super::unit::Dimension::{self, *};
use std::fmt;

/// The role of a channel: the quantity that it measures, and so its place in the chain of the axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Position that the controller commands (rad or m).
    CommandPosition,
    /// Position at the motor side: the gearbox output seen by the encoder (rad or m).
    MotorPosition,
    /// Velocity at the motor side, where nothing measures its position (rad/s or m/s).
    MotorVelocity,
    /// Position of the link, the arm end of the joint (rad or m).
    LinkPosition,
    /// Link position minus motor position (rad, or m at the tip).
    Deformation,
    /// Tip of the arm in the sensor's own frame, three columns (m).
    TipPosition,
    /// Velocity of the link (rad/s or m/s).
    LinkVelocity,
    /// Acceleration of the link (rad/s^2 or m/s^2).
    LinkAcceleration,
    /// Acceleration of the tip (m/s^2), one to three columns.
    TipAcceleration,
    /// Force (N).
    Force,
    /// Torque (N.m).
    Torque,
    /// Motor current (A).
    MotorCurrent,
    /// Motor voltage (V).
    MotorVoltage,
    /// Force or torque that acts on the link besides what the model has, known over time; positive in the
    /// direction of positive motion (N or N.m).
    KnownForce,
    /// Inertia of the link, known over time (kg or kg.m^2, or relative to the model's own).
    Inertia,
}

/// One line of the table of roles: the name in a manifest and the usual units.
#[derive(Clone, Copy, Debug)]
pub struct RoleEntry {
    /// The role.
    pub role: Role,
    /// Its name in a manifest.
    pub name: &'static str,
    /// Its usual unit; another known unit is kept and remarked upon.
    pub dimensions: &'static [Dimension],
    /// Allowed numbers of columns.
    pub columns: &'static [usize],
}

/// All roles, in the order of [`Role`].
pub const ROLES: &[RoleEntry] = &[
    entry(
        Role::CommandPosition,
        "command_position",
        &[Angle, Length],
        &[1],
    ),
    entry(
        Role::MotorPosition,
        "motor_position",
        &[Angle, Length],
        &[1],
    ),
    entry(
        Role::MotorVelocity,
        "motor_velocity",
        &[AngularVelocity, Velocity],
        &[1],
    ),
    entry(Role::LinkPosition, "link_position", &[Angle, Length], &[1]),
    entry(Role::Deformation, "deformation", &[Angle, Length], &[1]),
    entry(Role::TipPosition, "tip_position", &[Length], &[3]),
    entry(
        Role::LinkVelocity,
        "link_velocity",
        &[AngularVelocity, Velocity],
        &[1],
    ),
    entry(
        Role::LinkAcceleration,
        "link_acceleration",
        &[AngularAcceleration, Acceleration],
        &[1],
    ),
    entry(
        Role::TipAcceleration,
        "tip_acceleration",
        &[Acceleration],
        &[1, 2, 3],
    ),
    entry(Role::Force, "force", &[Force], &[1]),
    entry(Role::Torque, "torque", &[Torque], &[1]),
    entry(Role::MotorCurrent, "motor_current", &[Current], &[1]),
    entry(Role::MotorVoltage, "motor_voltage", &[Voltage], &[1]),
    entry(Role::KnownForce, "known_force", &[Force, Torque], &[1]),
    entry(
        Role::Inertia,
        "inertia",
        &[MomentOfInertia, Mass, Number],
        &[1],
    ),
];

const fn entry(
    role: Role,
    name: &'static str,
    dimensions: &'static [Dimension],
    columns: &'static [usize],
) -> RoleEntry {
    RoleEntry {
        role,
        name,
        dimensions,
        columns,
    }
}

impl Role {
    /// The role's line in [`ROLES`].
    pub fn entry(self) -> &'static RoleEntry {
        // The table is in the order of the enum; a test checks that.
        &ROLES[self as usize]
    }

    /// The role's name in a manifest, such as `motor_position`.
    pub fn name(self) -> &'static str {
        self.entry().name
    }

    /// The role of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        ROLES
            .iter()
            .find(|entry| entry.name == name)
            .map(|entry| entry.role)
    }

    /// Whether it is a position of the axis.
    pub fn is_position(self) -> bool {
        matches!(
            self,
            Self::CommandPosition | Self::MotorPosition | Self::LinkPosition
        )
    }

    /// Whether the channel drives the machine, rather than being measured: such channels are piecewise constant
    /// by intention.
    pub fn is_input(self) -> bool {
        matches!(
            self,
            Self::CommandPosition | Self::MotorVoltage | Self::MotorCurrent
        )
    }

    /// Whether it is a motion, which a moving joint never keeps constant; a command, a force or a current may be held.
    pub fn is_motion(self) -> bool {
        use Role::*;
        !matches!(
            self,
            CommandPosition | Force | Torque | MotorCurrent | MotorVoltage | KnownForce | Inertia
        )
    }

    /// Whether an accelerometer measures it.
    pub fn is_acceleration(self) -> bool {
        matches!(self, Self::TipAcceleration | Self::LinkAcceleration)
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (index, entry) in ROLES.iter().enumerate() {
            assert_eq!(entry.role as usize, index);
            assert_eq!(entry.role.entry().name, entry.name);
            assert_eq!(Role::from_name(entry.name), Some(entry.role));
        }
    }
}
