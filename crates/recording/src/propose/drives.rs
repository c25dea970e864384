//! Names of signals that a standard or a maker of drives has fixed.

use super::super::role::Role;
use super::content::Content;
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

/// Signals of a recorder of Elmo by the commands that read them, and whether no other sensor can be meant: the auxiliary position is
/// a second one.
///
/// Source: Elmo, SimplIQ Software Manual, default mapping of recorded signals: main speed and position, counts; active current, A;
/// position command, counts; auxiliary position.
const ELMO: &[(&[&str], Role, bool)] = &[
    (&["px"], Role::MotorPosition, false),
    (&["py"], Role::MotorPosition, false),
    (&["vx"], Role::MotorVelocity, false),
    (&["iq"], Role::MotorCurrent, true),
    (&["dv", "3"], Role::CommandPosition, true),
];

/// The role of a signal of Elmo's recorder, and whether it is certain. `PX` and `PY` alone may be two axes, so that a current or a
/// command of its own must stand beside it.
pub fn elmo(content: &Content, index: usize) -> Option<(Role, bool)> {
    let known = |name: &Name| ELMO.iter().find(|own| own.0.iter().eq(&name.words));
    let own = known(&content.columns[index].name)?;
    let all: Vec<_> = content
        .columns
        .iter()
        .filter_map(|other| known(&other.name))
        .collect();
    let has = |role: Role| all.iter().any(|own| own.1 == role);
    let is_recorder = has(Role::MotorPosition) && all.iter().any(|own| own.2);
    is_recorder.then_some((own.1, own.2))
}
