//! Slots: the coordinates on which static laws live.

use super::Quantity;

/// What a static law is a function of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coordinate {
    /// Deformation of the transmission.
    Deformation,
    /// Velocity of the effect's place; at the transmission the rate of the deformation.
    Speed,
    /// Position of the effect's place.
    Position,
    /// What the drive is given.
    Input,
    /// What the sensor would show.
    Reading,
    /// Time.
    Time,
}

/// What a static law does, and over which coordinate. Laws of one slot are curves that can be drawn over each
/// other.
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
    /// What the drive adds to its input, over the input.
    Drive,
    /// What the sensor adds to its reading, over the reading.
    Sensor,
    /// Relative change of the link's inertia over the position; the frequency falls with its root.
    Inertia,
    /// Relative change of the stiffness over time.
    StiffnessDrift,
    /// What the sensor adds to a reading of 0, over time.
    SensorDrift,
    /// Force over the deformation on the first way out from rest. A hysteresis has a memory: this curve says what it
    /// does after a turn, too, where it follows Masing's rules.
    Hysteresis,
}

/// Slots, what they are called within a sentence, their coordinates, and what their laws give.
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
        Slot::SensorDrift,
        "sensor over time",
        Coordinate::Time,
        "error of the sensor",
        Quantity::POSITION,
    ),
    (
        Slot::Hysteresis,
        "hysteresis",
        Coordinate::Deformation,
        "hysteresis force",
        Quantity::FORCE,
    ),
];

impl Slot {
    /// What it is called within a sentence.
    pub fn name(self) -> &'static str {
        SLOTS[self as usize].1
    }

    /// What its laws are functions of.
    pub fn coordinate(self) -> Coordinate {
        SLOTS[self as usize].2
    }

    /// What its laws give, within a sentence.
    pub fn law(self) -> &'static str {
        SLOTS[self as usize].3
    }

    /// The quantity of its coordinate and that of its laws.
    pub fn quantities(self) -> [Quantity; 2] {
        [self.coordinate().quantity(), SLOTS[self as usize].4]
    }
}

impl Coordinate {
    /// What it is called within a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Deformation => "deformation",
            Self::Speed => "velocity",
            Self::Position => "position",
            Self::Input => "input",
            Self::Reading => "reading",
            Self::Time => "time",
        }
    }

    /// Its quantity.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Deformation | Self::Position | Self::Reading => Quantity::POSITION,
            Self::Speed => Quantity::VELOCITY,
            Self::Input => Quantity::INPUT,
            Self::Time => Quantity::TIME,
        }
    }
}
