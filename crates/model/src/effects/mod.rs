//! The catalogue of physics that a model of an axis may lack.
//!
//! An [`Effect`] is one file and one line in [`EFFECTS`]. It states its place in the chain from drive to sensor
//! and its parameters, and gives the [`Law`] that the model integrates. A law at its neutral size changes
//! nothing, to the bit. Everything else about it that the program needs is in its texts and
//! [properties](Property); no other code refers to it by name. [`LEARNED`] has the laws whose shape is learned:
//! their parameters are their values at knots.
//!
//! Forces are in the unit of the model: N or N.m where an inertia is known; divided by the joint's
//! stiffness, so in rad, where only its natural frequency is (`flexible_joint`, `oscillator`).

mod asymmetric_friction;
mod backlash;
mod base_mode;
mod bilinear_stiffness;
mod catalogue;
mod clock_skew;
mod cogging;
mod coulomb_friction;
mod cubic;
mod cubic_stiffness;
mod curve;
mod dead_zone;
mod deformation_gain;
mod drive_delay;
mod drive_lag;
mod end_stop;
mod external_disturbance;
mod force_offset;
mod friction;
mod gravity_load;
mod grid;
mod harmonic_disturbance;
mod hysteretic_stiffness;
mod law;
mod learned;
mod learned_clock;
mod learned_damping;
mod learned_damping_drift;
mod learned_drift;
mod learned_drive;
mod learned_frequency;
mod learned_friction;
mod learned_joint_damping;
mod learned_position_damping;
mod learned_position_force;
mod learned_position_friction;
mod learned_position_stiffness;
mod learned_sensor;
mod learned_sensor_drift;
mod learned_speed_stiffness;
mod learned_spring;
mod learned_transmission_error;
mod levelling;
mod likeness;
mod maxwell_slip;
mod misalignment;
mod parameter;
mod payload_change;
mod pose_dependent_frequency;
mod presliding_hysteresis;
mod property;
mod quadratic_damping;
mod quadratic_drag;
mod quantisation;
mod rate_limit;
mod saturation;
mod scales;
mod second_mode;
mod sensor_delay;
mod sensor_drift;
mod sensor_gain;
mod sensor_lag;
mod sensor_lag_second_order;
mod shared_parameters;
mod slot;
mod smooth_coulomb_friction;
mod spline;
mod stiction;
mod stiffness_drift;
mod stribeck_friction;
mod swinging_load;
mod torque_constant_nonlinearity;
mod transmission_ripple;
mod viscoelastic_creep;
mod viscous_drag;
mod viscous_friction;

pub use catalogue::{Catalogue, words};
pub use curve::curve;
pub(crate) use friction::Change;
pub use friction::{Friction, Levels, Zone};
pub use law::{
    Drive, Force, Impulse, Inertia, Law, Memory, Motion, Reading, Resonance, STATES, Sensor,
};
pub use learned::KNOTS;
pub(crate) use learned_friction::{even_velocities, slip_velocities};
pub(crate) use levelling::levelling;
pub use likeness::{LIKENESSES, Likeness};
pub(crate) use maxwell_slip::slip_distances;
pub use parameter::{Parameter, ParameterRole, Quantity, Units};
pub use property::{Part, Property};
pub use scales::{CandidateStop, Scales, Visited};
pub use slot::{Coordinate, Slot};
pub use spline::Spline;

use std::fmt;

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
    /// In the sensor's response to the motion.
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
    /// Its name within a sentence.
    pub title: &'static str,
    /// Possible places.
    pub places: &'static [Place],
    /// The physics, in a few sentences, with a source.
    pub physics: &'static str,
    /// The remedy, in a sentence.
    pub remedy: &'static str,
    /// Its parameters.
    pub parameters: &'static [Parameter],
    /// Its further properties.
    pub properties: &'static [Property],
    /// The law for values of the parameters, in their order, SI.
    pub law: fn(&[f64]) -> Law,
    /// Values to try first, each in the order of the parameters, for a motion of these scales. The grid covers
    /// the relevant sizes: from barely visible to dominant.
    pub starts: fn(&Scales) -> Vec<Vec<f64>>,
}

/// The catalogue.
pub const EFFECTS: &[&Effect] = &[
    &coulomb_friction::COULOMB_FRICTION,
    &smooth_coulomb_friction::SMOOTH_COULOMB_FRICTION,
    &stribeck_friction::STRIBECK_FRICTION,
    &asymmetric_friction::ASYMMETRIC_FRICTION,
    &stiction::STICTION,
    &viscous_friction::VISCOUS_FRICTION,
    &force_offset::FORCE_OFFSET,
    &cogging::COGGING,
    &dead_zone::DEAD_ZONE,
    &saturation::SATURATION,
    &rate_limit::RATE_LIMIT,
    &torque_constant_nonlinearity::TORQUE_CONSTANT_NONLINEARITY,
    &drive_lag::DRIVE_LAG,
    &drive_delay::DRIVE_DELAY,
    &presliding_hysteresis::PRESLIDING_HYSTERESIS,
    &hysteretic_stiffness::HYSTERETIC_STIFFNESS,
    &backlash::BACKLASH,
    &cubic_stiffness::CUBIC_STIFFNESS,
    &bilinear_stiffness::BILINEAR_STIFFNESS,
    &quadratic_damping::QUADRATIC_DAMPING,
    &viscoelastic_creep::VISCOELASTIC_CREEP,
    &stiffness_drift::STIFFNESS_DRIFT,
    &transmission_ripple::TRANSMISSION_RIPPLE,
    &viscous_drag::VISCOUS_DRAG,
    &quadratic_drag::QUADRATIC_DRAG,
    &gravity_load::GRAVITY_LOAD,
    &pose_dependent_frequency::POSE_DEPENDENT_FREQUENCY,
    &payload_change::PAYLOAD_CHANGE,
    &end_stop::END_STOP,
    &second_mode::SECOND_MODE,
    &base_mode::BASE_MODE,
    &swinging_load::SWINGING_LOAD,
    &sensor_delay::SENSOR_DELAY,
    &sensor_lag::SENSOR_LAG,
    &sensor_lag_second_order::SENSOR_LAG_SECOND_ORDER,
    &sensor_gain::SENSOR_GAIN,
    &deformation_gain::DEFORMATION_GAIN,
    &misalignment::MISALIGNMENT,
    &sensor_drift::SENSOR_DRIFT,
    &quantisation::QUANTISATION,
    &clock_skew::CLOCK_SKEW,
    &external_disturbance::EXTERNAL_DISTURBANCE,
    &harmonic_disturbance::HARMONIC_DISTURBANCE,
];

/// Laws whose shape is learned, one or more for each [`Slot`], for recordings that no law of the catalogue
/// explains.
pub const LEARNED: &[&Effect] = &[
    &learned_friction::LEARNED_FRICTION,
    &learned_position_force::LEARNED_POSITION_FORCE,
    &learned_position_damping::LEARNED_POSITION_DAMPING,
    &learned_position_friction::LEARNED_POSITION_FRICTION,
    &learned_drive::LEARNED_DRIVE,
    &learned_spring::LEARNED_SPRING,
    &learned_damping::LEARNED_DAMPING,
    &learned_joint_damping::LEARNED_JOINT_DAMPING,
    &maxwell_slip::MAXWELL_SLIP,
    &learned_transmission_error::LEARNED_TRANSMISSION_ERROR,
    &learned_drift::LEARNED_DRIFT,
    &learned_damping_drift::LEARNED_DAMPING_DRIFT,
    &learned_speed_stiffness::LEARNED_SPEED_STIFFNESS,
    &learned_position_stiffness::LEARNED_POSITION_STIFFNESS,
    &learned_frequency::LEARNED_FREQUENCY,
    &learned_sensor::LEARNED_SENSOR,
    &learned_sensor_drift::LEARNED_SENSOR_DRIFT,
    &learned_clock::LEARNED_CLOCK,
];

impl Effect {
    /// The effect of this name, of the catalogue or learned.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        Catalogue::default().effect(name)
    }

    /// Values at which the effect vanishes.
    pub fn neutral(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.neutral).collect()
    }

    /// Values to try first at one of its places: of a learned law, the neutral one over the range visited there.
    pub fn starts_at(&self, place: Place, scales: &Scales) -> Vec<Vec<f64>> {
        let mut all = (self.starts)(scales);
        let own = self.places.iter().position(|own| *own == place);
        match own.filter(|_| self.is_learned()) {
            Some(own) => vec![all.swap_remove(own)],
            None => all,
        }
    }

    /// Index of the first parameter of this role.
    pub fn index(&self, role: ParameterRole) -> Option<usize> {
        self.parameters.iter().position(|p| p.role == role)
    }

    /// Index of its size; of the first ordinate of a learned law.
    pub fn size(&self) -> usize {
        self.index(ParameterRole::Size).unwrap_or(0)
    }

    /// Whether the effect vanishes, to the bit, for these values.
    pub fn vanishes(&self, values: &[f64]) -> bool {
        self.sizes(values)
            .all(|(parameter, value)| value == parameter.neutral)
    }

    /// Whether the effect is invisible for these values, in a motion of these scales: its size, or all
    /// ordinates of a learned law, are within a thousandth of the typical value.
    pub fn is_negligible(&self, values: &[f64], scales: &Scales) -> bool {
        self.sizes(values).all(|(parameter, value)| {
            (value - parameter.neutral).abs() < 1e-3 * (parameter.typical)(scales).abs()
        })
    }

    /// The parameters without which the effect vanishes, with their values: its size, or the ordinates of a
    /// learned law.
    fn sizes<'v>(
        &self,
        values: &'v [f64],
    ) -> impl Iterator<Item = (&'static Parameter, f64)> + use<'v> {
        let all = self.parameters.iter().zip(values.iter().copied());
        all.filter(|own| matches!(own.0.role, ParameterRole::Size | ParameterRole::Ordinate))
    }

    /// A parameter's name in words; proper names are spelled as in the title.
    pub fn parameter_title(&self, name: &str) -> String {
        let proper = |word: &str| {
            let mut own = self.title.split(' ');
            own.find(|own| own.to_lowercase() == word)
                .unwrap_or(word)
                .to_string()
        };
        let words: Vec<String> = name.split('_').map(proper).collect();
        words.join(" ")
    }
}

/// Effects with the same name are equal.
impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Effect {}

impl fmt::Debug for Effect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.name, f)
    }
}
