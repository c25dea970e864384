//! The catalogue of physics that a model of an axis may lack.
//!
//! An [`Effect`] is one file and one line in [`EFFECTS`]. It says where it sits in the chain from
//! drive to sensor, what its parameters are, and gives the [`Law`] that the model integrates. A law
//! with its parameters at their neutral values changes nothing, to the bit.
//!
//! Forces are in the unit of the model: N or N.m where an inertia is known; divided by the joint's
//! stiffness, so in rad, where only its natural frequency is (`flexible_joint`, `oscillator`).

mod asymmetric_friction;
mod cogging;
mod coulomb_friction;
mod cubic_stiffness;
mod dead_zone;
mod force_offset;
mod grid;
mod law;
mod parameter;
mod scales;
mod sensor_lag;
mod stiction;
mod stribeck_friction;
mod viscous_friction;

pub use law::{Drive, Force, Friction, Inertia, Law, Memory, Motion, Reading, Resonance, Sensor};
pub use parameter::{Parameter, Quantity};
pub use scales::Scales;

/// Where in the chain an effect sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Place {
    /// Between the command or current and the motor side.
    Drive,
    /// Between the motor side and the link.
    Transmission,
    /// At the link.
    Link,
    /// Under the robot.
    Base,
    /// In what the sensor makes of the motion.
    Sensor,
    /// Outside the machine.
    Environment,
}

/// All places, from the command to the sensor.
pub const PLACES: &[(Place, &str)] = &[
    (Place::Drive, "drive"),
    (Place::Transmission, "transmission"),
    (Place::Link, "link"),
    (Place::Base, "base"),
    (Place::Sensor, "sensor"),
    (Place::Environment, "environment"),
];

impl Place {
    /// Name in files.
    pub fn name(self) -> &'static str {
        PLACES[self as usize].1
    }

    /// The place of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        PLACES
            .iter()
            .find(|entry| entry.1 == name)
            .map(|entry| entry.0)
    }
}

/// One entry of the catalogue.
pub struct Effect {
    /// Name in files, as the literature names it.
    pub name: &'static str,
    /// Where it can sit.
    pub places: &'static [Place],
    /// What happens, in a few sentences, with a source.
    pub physics: &'static str,
    /// What describes it.
    pub parameters: &'static [Parameter],
    /// The law for values of the parameters, in their order, SI.
    pub law: fn(&[f64]) -> Law,
    /// Values to try first, each in the order of the parameters, for a motion of these scales. The
    /// grid spans the sizes that matter: from what is barely seen to what dominates.
    pub starts: fn(&Scales) -> Vec<Vec<f64>>,
}

/// The catalogue.
pub const EFFECTS: &[&Effect] = &[
    &coulomb_friction::COULOMB_FRICTION,
    &stribeck_friction::STRIBECK_FRICTION,
    &viscous_friction::VISCOUS_FRICTION,
    &asymmetric_friction::ASYMMETRIC_FRICTION,
    &force_offset::FORCE_OFFSET,
    &cogging::COGGING,
    &dead_zone::DEAD_ZONE,
    &stiction::STICTION,
    &cubic_stiffness::CUBIC_STIFFNESS,
    &sensor_lag::SENSOR_LAG,
];

impl Effect {
    /// The effect of this name.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        EFFECTS.iter().copied().find(|effect| effect.name == name)
    }

    /// Values at which the effect vanishes.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.neutral).collect()
    }
}
