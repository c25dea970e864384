//! Slots: the coordinates on which static laws live.

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

/// Slots, what they are called within a sentence, and their coordinates.
const SLOTS: &[(Slot, &str, Coordinate)] = &[
    (Slot::Spring, "spring force", Coordinate::Deformation),
    (Slot::Damping, "damping", Coordinate::Deformation),
    (Slot::Friction, "friction", Coordinate::Speed),
    (
        Slot::PositionForce,
        "force over position",
        Coordinate::Position,
    ),
    (Slot::Drive, "drive", Coordinate::Input),
    (Slot::Sensor, "sensor", Coordinate::Reading),
    (Slot::Inertia, "inertia", Coordinate::Position),
    (
        Slot::StiffnessDrift,
        "stiffness over time",
        Coordinate::Time,
    ),
    (Slot::SensorDrift, "sensor over time", Coordinate::Time),
    (Slot::Hysteresis, "hysteresis", Coordinate::Deformation),
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
}
