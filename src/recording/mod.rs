//! Recordings: channels, each on its own clock, described by a manifest.

/// What a channel measures, and so where in the chain of the axis it sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Role {
    /// Position that the controller commands (rad or m).
    CommandPosition,
    /// Position at the motor side: the gearbox output seen by the encoder (rad or m).
    MotorPosition,
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
    /// Acceleration of the tip (m/s^2), one or three columns.
    TipAcceleration,
    /// Force (N).
    Force,
    /// Torque (N.m).
    Torque,
    /// Motor current (A).
    MotorCurrent,
    /// Motor voltage (V).
    MotorVoltage,
}

/// One measured quantity on its own clock.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// What is measured.
    pub role: Role,
    /// SI (or the manifest's own, where it is not a mechanical one) unit of `columns`.
    pub unit: String,
    /// Stamps, s, strictly increasing; length n.
    pub time: Vec<f64>,
    /// One column for a scalar, three for a vector; each of length n.
    pub columns: Vec<Vec<f64>>,
}

/// Channels of one run of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name given in the manifest.
    pub name: String,
    /// Channels in the manifest's order.
    pub channels: Vec<Channel>,
}

impl Recording {
    /// The first channel with this role.
    pub fn channel(&self, role: Role) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.role == role)
    }
}
