//! Names of signals that a standard or a maker of drives has fixed.

use super::super::role::Role;
use super::name::Name;

/// Parameters of SERCOS drives by their numbers.
///
/// Source: SERCOS interface, IEC 61491 (2002): position feedback 1 is of the motor, 2 is external.
const SERCOS: &[(&str, Role)] = &[
    ("0047", Role::CommandPosition),
    ("0051", Role::MotorPosition),
    ("0053", Role::LinkPosition),
    ("0040", Role::MotorVelocity),
    ("0084", Role::Torque),
];

/// What ODrive calls its signals, each with all of these words, and its unit: turns since firmware 0.5.
///
/// Source: the API reference of ODrive, `Encoder`, `Controller` and `Motor`.
const ODRIVE: &[(&[&str], Role, &str)] = &[
    (&["pos", "estimate"], Role::MotorPosition, "rev"),
    (&["vel", "estimate"], Role::MotorVelocity, "rev/s"),
    (&["input", "pos"], Role::CommandPosition, "rev"),
    (&["pos", "setpoint"], Role::CommandPosition, "rev"),
];

/// The role of a parameter of a SERCOS drive: `S-0-0051, Lageistwert Geber 1`.
pub fn sercos(name: &Name) -> Option<Role> {
    let [standard, set, number, ..] = name.words.as_slice() else {
        return None;
    };
    let is_one = standard == "s" && set == "0";
    let known = SERCOS.iter().find(|own| is_one && own.0 == number);
    known.map(|own| own.1)
}

/// The role of a signal of ODrive, and its unit: `axis0.encoder.pos_estimate`.
pub fn odrive(name: &Name) -> Option<(Role, &'static str)> {
    let axis = name.words.first()?.strip_prefix("axis")?;
    let is_axis = !axis.is_empty() && axis.bytes().all(|letter| letter.is_ascii_digit());
    let has = |word: &&str| name.words.iter().any(|own| own == word);
    let holds = |own: &&(&[&str], Role, &str)| own.0.iter().all(has);
    let known = ODRIVE.iter().find(holds).filter(|_| is_axis)?;
    Some((known.1, known.2))
}
