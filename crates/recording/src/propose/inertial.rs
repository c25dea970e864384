//! Columns of inertial sensors: what programs call the axes of an accelerometer, and the rates and angles beside them.

use super::super::role::Role;
use super::super::unit::Dimension;
use super::content::Content;
use super::name::Name;

/// Names of the axes of an accelerometer that have no word for it, with the unit where it is fixed.
///
/// Sources: the CSV files of Physics Toolbox Sensor Suite, `time,gFx,gFy,gFz,TgF`; the example of Arduino's library for the
/// MPU-6050, which prints counts.
const ACCELEROMETERS: &[([[&str; 2]; 3], Option<&str>)] = &[
    ([["g", "fx"], ["g", "fy"], ["g", "fz"]], Some("g")),
    ([["ac", "x"], ["ac", "y"], ["ac", "z"]], None),
];

/// Words for the axes about which a body turns.
const TURNS: [[&str; 3]; 3] = [
    ["x", "wx", "roll"],
    ["y", "wy", "pitch"],
    ["z", "wz", "yaw"],
];

/// Words for a rate of turn.
const RATES: [&str; 4] = ["angular", "gyro", "gyr", "gyroscope"];

/// The axis of a column that a program calls by a fixed name, 0, 1 or 2, and its unit where that is fixed.
pub fn axis(name: &Name) -> Option<(usize, Option<&'static str>)> {
    let mut tables = ACCELEROMETERS.iter();
    tables.find_map(|(names, unit)| {
        let axis = names.iter().position(|words| name.words == words)?;
        Some((axis, *unit))
    })
}

/// The axis about which a column has a rate of turn, by its name: 0, 1 or 2. `wx` is one, as in the files of Physics Toolbox; `roll` may be
/// a joint of a robot where no word tells a rate.
pub fn turns_about(name: &Name) -> Option<usize> {
    let is_told = has_word_of_rate(name) || name.words.last()?.starts_with('w');
    turning_axis(name).filter(|_| is_told)
}

/// The axis about which the last word of a name says that something turns.
fn turning_axis(name: &Name) -> Option<usize> {
    let last = name.words.last()?.as_str();
    TURNS.iter().position(|words| words.contains(&last))
}

fn has_word_of_rate(name: &Name) -> bool {
    name.words.iter().any(|word| RATES.contains(&&**word))
}

/// Whether a column has a rate or an angle about an axis of an accelerometer that stands in the same file with several axes:
/// they are of one body, and of no joint.
pub fn is_of_accelerometer(content: &Content, index: usize) -> bool {
    let name = &content.columns[index].name;
    let turns = has_word_of_rate(name)
        || [Dimension::Angle, Dimension::AngularVelocity]
            .map(Some)
            .contains(&name.dimension());
    let accelerates = |other: &&Name| {
        let is_named = matches!(other.role(), Some((Role::TipAcceleration, _)));
        other.axis().is_some() && (is_named || other.dimension() == Some(Dimension::Acceleration))
    };
    let axes = content
        .columns
        .iter()
        .map(|own| &own.name)
        .filter(accelerates);
    turns && turning_axis(name).is_some() && axes.count() > 1
}
