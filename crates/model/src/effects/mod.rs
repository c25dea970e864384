//! The catalogue of physics that a model of an axis may lack.
//!
//! An [`Effect`] is one file and one line in [`EFFECTS`]. It says where it sits in the chain from
//! drive to sensor, what its parameters are, and gives the [`Law`] that the model integrates. A law
//! with its parameters at their neutral values changes nothing, to the bit.
//!
//! Forces are in the unit of the model: N or N.m where an inertia is known; divided by the joint's
//! stiffness, so in rad, where only its natural frequency is (`flexible_joint`, `oscillator`).

mod asymmetric_friction;
mod backlash;
mod base_mode;
mod bilinear_stiffness;
mod clock_skew;
mod cogging;
mod coulomb_friction;
mod cubic;
mod cubic_stiffness;
mod dead_zone;
mod deformation_gain;
mod drive_delay;
mod drive_lag;
mod end_stop;
mod external_disturbance;
mod force_offset;
mod gravity_load;
mod grid;
mod hysteretic_stiffness;
mod law;
mod levelling;
mod misalignment;
mod parameter;
mod payload_change;
mod pose_dependent_frequency;
mod presliding_hysteresis;
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
mod stiction;
mod stiffness_drift;
mod stribeck_friction;
mod torque_constant_nonlinearity;
mod transmission_ripple;
mod viscoelastic_creep;
mod viscous_drag;
mod viscous_friction;

pub use law::{Drive, Force, Friction, Inertia, Law, Memory, Motion, Reading, Resonance, Sensor};
pub use parameter::{Parameter, Quantity, Units};
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

/// Laws that contain a simpler one as a limit: what stands for either is named by the simpler.
const NESTED: &[(&str, &str)] = &[
    ("stribeck_friction", "coulomb_friction"),
    ("asymmetric_friction", "coulomb_friction"),
    ("presliding_hysteresis", "coulomb_friction"),
    ("stiction", "coulomb_friction"),
    ("sensor_lag_second_order", "sensor_lag"),
    // Where the axis turns by little.
    ("gravity_load", "force_offset"),
];

/// Laws that act as a simpler one where their frequency is far above the motion.
const QUASI_STATIC: &[(&str, &str)] = &[
    ("second_mode", "deformation_gain"),
    ("base_mode", "deformation_gain"),
];

/// Whether the law of one effect may act as that of another wherever the recording looks.
pub fn becomes(effect: &str, simpler: &str) -> bool {
    QUASI_STATIC.contains(&(effect, simpler))
}

/// Effects that are events, of which there may be several.
const EVENTS: &[&str] = &["external_disturbance"];

/// Whether an effect is an event that may happen again.
pub fn recurs(effect: &str) -> bool {
    EVENTS.contains(&effect)
}

/// Effects whose misfit has many minima over their size: the frequency falls with it, and what fits is
/// found where both are right.
const WINDING: &[&str] = &["backlash"];

/// Whether the sizes of an effect are to be walked through one by one, the smallest first.
pub fn has_many_minima(effect: &str) -> bool {
    WINDING.contains(&effect)
}

/// Parameters that a file may leave out: without them the law is the plain one.
const OPTIONAL: &[(&str, &str)] = &[("backlash", "damping_in_gap")];

/// Whether a file may leave out this parameter of an effect; it then has its neutral value.
pub fn is_optional(effect: &str, parameter: &str) -> bool {
    OPTIONAL.contains(&(effect, parameter))
}

/// Whether the law of one effect contains that of another as a limit.
///
/// # Example
/// ```
/// assert!(quell_model::effects::contains("stribeck_friction", "coulomb_friction"));
/// ```
pub fn contains(effect: &str, simpler: &str) -> bool {
    NESTED.contains(&(effect, simpler))
}

/// The simpler effects that the law of one contains as limits.
pub fn limits(effect: &str) -> impl Iterator<Item = &'static Effect> {
    let own = NESTED.iter().filter(move |pair| pair.0 == effect);
    own.filter_map(|pair| Effect::from_name(pair.1))
}

/// The two simpler effects that a law and its values act as while it slides, with their values:
/// friction `F (1 + a)` one way and `F (1 - a)` the other is Coulomb friction `F` and a constant force
/// `F a`. At rest they differ: the constant force goes on.
///
/// # Example
/// ```
/// let [dry, constant] = quell_model::effects::parts("asymmetric_friction", &[20.0, 0.1]).unwrap();
/// assert_eq!((dry.0.name, constant.0.name), ("coulomb_friction", "force_offset"));
/// assert_eq!((dry.1, constant.1), (vec![20.0], vec![2.0]));
/// ```
pub fn parts(effect: &str, values: &[f64]) -> Option<[(&'static Effect, Vec<f64>); 2]> {
    match (effect, values) {
        ("asymmetric_friction", &[friction, asymmetry]) => Some([
            (&coulomb_friction::COULOMB_FRICTION, vec![friction]),
            (&force_offset::FORCE_OFFSET, vec![friction * asymmetry]),
        ]),
        _ => None,
    }
}
