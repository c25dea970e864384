//! Names of signals that makers of robots have fixed, by their axes.

use super::super::role::Role;
use super::content::Content;
use super::name::Name;

/// What a signal is: a role, its unit, and whether the maker's public documents say both; or nothing that a joint's sensor tells.
type Signal = Option<(Role, &'static str, bool)>;

/// Words before the number of an axis, and what the signal is. Poses are computed from the axes; of speeds and currents no public
/// document tells the unit.
///
/// Sources: KUKA.RobotSensorInterface 3.1: AIPos and ASPos are actual and setpoint positions of the axes, RIst and RSol those of the
/// tool, MACur currents of motors. KUKA, System Variables, for KSS 8.1 to 8.4, has the others, which are read here by their names.
const KUKA: &[(&[&str], Signal)] = &[
    (&["aipos"], Some((Role::MotorPosition, "deg", true))),
    (&["aspos"], Some((Role::CommandPosition, "deg", true))),
    (
        &["axis", "act", "meas"],
        Some((Role::MotorPosition, "deg", false)),
    ),
    (
        &["torque", "axis", "act"],
        Some((Role::Torque, "N.m", false)),
    ),
    (&["vel", "axis", "act"], None),
    (&["curr", "act"], None),
    (&["macur"], None),
    (&["pos", "act"], None),
    (&["pos", "act", "mes"], None),
    (&["rist"], None),
    (&["rsol"], None),
];

/// Signals of the state of a Franka robot, whose `tau_J` stands beside. `theta` is the motor's, `q` the joint's, behind the gear.
///
/// Source: libfranka, `franka::RobotState`.
const FRANKA: &[(&[&str], Signal)] = &[
    (&["q"], Some((Role::LinkPosition, "rad", true))),
    (&["q", "d"], Some((Role::CommandPosition, "rad", true))),
    (&["dq"], Some((Role::LinkVelocity, "rad/s", true))),
    (&["dq", "d"], None),
    (&["theta"], Some((Role::MotorPosition, "rad", true))),
    (&["dtheta"], Some((Role::MotorVelocity, "rad/s", true))),
    // A sensor on the link's side, not what the motor gives.
    (&["tau", "j"], None),
    (&["tau", "j", "d"], None),
    (&["dtau", "j"], None),
];

/// What a column is by its maker's name; `None` for a name that no maker has fixed.
pub fn signal(content: &Content, index: usize) -> Option<Signal> {
    let name = &content.columns[index].name;
    let of = |table: &[(&[&str], Signal)]| {
        let known = table.iter().find(|own| is_axis_of(name, own.0));
        known.map(|own| own.1)
    };
    let has = |words: &[&str]| {
        content
            .columns
            .iter()
            .any(|own| is_axis_of(&own.name, words))
    };
    let is_franka = has(&["tau", "j"]) && (has(&["q", "d"]) || has(&["theta"]));
    of(KUKA).or_else(|| of(FRANKA).filter(|_| is_franka))
}

/// Whether a name is these words and an axis: a number, `A1`, or one letter of a pose.
fn is_axis_of(name: &Name, words: &[&str]) -> bool {
    // What ends as a unit, as the angle `A` of a pose, is taken from the words.
    let ends = name.unit.as_ref().map(|unit| unit.to_lowercase());
    let mut own: Vec<&str> = name.words.iter().map(String::as_str).collect();
    own.extend(ends.as_deref());
    let Some((axis, before)) = own.split_last() else {
        return false;
    };
    let digits = axis.trim_start_matches(['a', 'e']);
    let is_number = !digits.is_empty() && digits.bytes().all(|letter| letter.is_ascii_digit());
    before == words && (is_number || axis.len() == 1 && "xyzabc".contains(axis))
}
