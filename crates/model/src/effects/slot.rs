//! Slots: static laws by what they act on and by their coordinates.

use super::Quantity;

/// The variable of a static law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coordinate {
    /// Deformation of the transmission.
    Deformation,
    /// Velocity of the effect's place; at the transmission the rate of the deformation.
    Speed,
    /// Speed of the motor side, in either direction.
    MotorSpeed,
    /// Position of the effect's place.
    Position,
    /// Input of the drive.
    Input,
    /// Reading of an ideal sensor.
    Reading,
    /// Time.
    Time,
    /// Displacement of the effect's place since it rested; at the transmission the deformation.
    Displacement,
}

/// Quantity and coordinate of a static law. Laws of one slot can be drawn over each other as curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Slot {
    /// Elastic force over the deformation, beside that of the model's spring.
    Spring,
    /// Damping coefficient over the deformation, beside that of the model's damper.
    Damping,
    /// Force against motion over the velocity.
    Friction,
    /// Force over the position.
    PositionForce,
    /// Damping coefficient over the position.
    PositionDamping,
    /// Level of dry friction over the position.
    PositionFriction,
    /// Addition of the drive to its input, over the input.
    Drive,
    /// Addition of the sensor to its reading, over the reading.
    Sensor,
    /// Relative change of the link's inertia over the position; the frequency falls with its root.
    Inertia,
    /// Relative change of the stiffness over time.
    StiffnessDrift,
    /// Relative change of the stiffness over the speed of the motor side.
    SpeedStiffness,
    /// Relative change of the stiffness over the position of the motor side.
    JointStiffness,
    /// Addition of the transmission to the position of the motor side, over that position.
    TransmissionError,
    /// Damping coefficient over time, beside that of the model's damper.
    DampingDrift,
    /// Damping coefficient across the joint over the position of the motor side, beside that of the model's damper.
    JointDamping,
    /// Addition of the sensor to a reading of 0, over time.
    SensorDrift,
    /// Shift of the sensor's stamps over time.
    Clock,
    /// Force over the displacement on the first loading from rest. A hysteresis has a memory: if it follows
    /// Masing's rules, this curve also determines it after a reversal.
    Hysteresis,
}

/// Slots with their names within a sentence, their coordinates, and the quantities of their laws.
const SLOTS: &[(Slot, &str, Coordinate, &str, Quantity)] = &[
    (
        Slot::Spring,
        "spring force",
        Coordinate::Deformation,
        "spring force",
        Quantity::FORCE,
    ),
    (
        Slot::Damping,
        "damping",
        Coordinate::Deformation,
        "damping coefficient",
        Quantity::new(1, -1, 1),
    ),
    (
        Slot::Friction,
        "friction",
        Coordinate::Speed,
        "friction force",
        Quantity::FORCE,
    ),
    (
        Slot::PositionForce,
        "force over position",
        Coordinate::Position,
        "force",
        Quantity::FORCE,
    ),
    (
        Slot::PositionDamping,
        "damping over position",
        Coordinate::Position,
        "damping coefficient",
        Quantity::new(1, -1, 1),
    ),
    (
        Slot::PositionFriction,
        "friction over position",
        Coordinate::Position,
        "friction",
        Quantity::FORCE,
    ),
    (
        Slot::Drive,
        "drive",
        Coordinate::Input,
        "change of the input",
        Quantity::INPUT,
    ),
    (
        Slot::Sensor,
        "sensor",
        Coordinate::Reading,
        "error of the sensor",
        Quantity::POSITION,
    ),
    (
        Slot::Inertia,
        "inertia",
        Coordinate::Position,
        "relative change of the inertia",
        Quantity::NUMBER,
    ),
    (
        Slot::StiffnessDrift,
        "stiffness over time",
        Coordinate::Time,
        "relative change of the stiffness",
        Quantity::NUMBER,
    ),
    (
        Slot::SpeedStiffness,
        "stiffness over speed",
        Coordinate::MotorSpeed,
        "relative change of the stiffness",
        Quantity::NUMBER,
    ),
    (
        Slot::JointStiffness,
        "stiffness over position",
        Coordinate::Position,
        "relative change of the stiffness",
        Quantity::NUMBER,
    ),
    (
        Slot::TransmissionError,
        "transmission error",
        Coordinate::Position,
        "error of the transmission",
        Quantity::POSITION,
    ),
    (
        Slot::DampingDrift,
        "damping over time",
        Coordinate::Time,
        "damping coefficient",
        Quantity::new(1, -1, 1),
    ),
    (
        Slot::JointDamping,
        "damping of the joint over position",
        Coordinate::Position,
        "damping coefficient",
        Quantity::new(1, -1, 1),
    ),
    (
        Slot::SensorDrift,
        "sensor over time",
        Coordinate::Time,
        "error of the sensor",
        Quantity::POSITION,
    ),
    (
        Slot::Clock,
        "clock over time",
        Coordinate::Time,
        "shift of the stamps",
        Quantity::TIME,
    ),
    (
        Slot::Hysteresis,
        "hysteresis",
        Coordinate::Displacement,
        "hysteresis force",
        Quantity::FORCE,
    ),
];

impl Slot {
    /// Its name within a sentence.
    pub fn name(self) -> &'static str {
        SLOTS[self as usize].1
    }

    /// The coordinate of its laws.
    pub fn coordinate(self) -> Coordinate {
        SLOTS[self as usize].2
    }

    /// The quantity of its laws, within a sentence.
    pub fn law(self) -> &'static str {
        SLOTS[self as usize].3
    }

    /// The quantity of its coordinate and that of its laws.
    pub fn quantities(self) -> [Quantity; 2] {
        [self.coordinate().quantity(), SLOTS[self as usize].4]
    }
}

impl Coordinate {
    /// Its name within a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deformation => "deformation",
            Self::Speed => "velocity",
            Self::MotorSpeed => "speed of the motor side",
            Self::Position => "position",
            Self::Input => "input",
            Self::Reading => "reading",
            Self::Time => "time",
            Self::Displacement => "displacement",
        }
    }

    /// Its quantity.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Deformation | Self::Displacement | Self::Position | Self::Reading => {
                Quantity::POSITION
            }
            Self::Speed | Self::MotorSpeed => Quantity::VELOCITY,
            Self::Input => Quantity::INPUT,
            Self::Time => Quantity::TIME,
        }
    }
}
