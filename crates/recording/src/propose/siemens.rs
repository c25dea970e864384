//! Parameters of SINAMICS drives in a trace of Startdrive: which of their encoders a column is of.

use super::super::role::Role;
use super::content::Content;
use super::name::Name;
use std::collections::BTreeSet;

/// What a parameter is.
#[derive(Clone, Copy, PartialEq)]
enum Quantity {
    /// A position of the encoder that its index counts from 0.
    Position,
    /// A speed of the encoder that its index counts from 0.
    Speed,
    /// Something of the motor, whatever its index.
    Motor(Role),
}

/// Parameters by their numbers.
///
/// Source: SINAMICS S120/S150, List Manual: r0482 is `Gn_XIST1` and r0483 `Gn_XIST2`, r0061 the speed by each encoder, r0063 that of
/// the control, r0031 and r0080 the torque.
const PARAMETERS: &[(u32, Quantity)] = &[
    (31, Quantity::Motor(Role::Torque)),
    (61, Quantity::Speed),
    (63, Quantity::Motor(Role::MotorVelocity)),
    (80, Quantity::Motor(Role::Torque)),
    (482, Quantity::Position),
    (483, Quantity::Position),
];

/// Words for an encoder, for a position, and for what is measured.
const ENCODER: [&str; 2] = ["encoder", "geber"];
const POSITION: [&str; 3] = ["position", "pos", "lage"];
const ACTUAL: [&str; 3] = ["actual", "act", "ist"];

/// The role of a column, and whether it is certain. Encoder 1 is the motor's; the next one usually measures the load directly, which the
/// name does not tell for certain. `None` for what is no parameter, and for a third encoder.
pub fn role(content: &Content, index: usize) -> Option<(Role, bool)> {
    let name = &content.columns[index].name;
    if let Some((_, quantity, index)) = parameter(name) {
        let of = |sides: [Role; 2]| sides.get(index).map(|role| (*role, false));
        return match quantity {
            Quantity::Position => of([Role::MotorPosition, Role::LinkPosition]),
            Quantity::Speed => of([Role::MotorVelocity, Role::LinkVelocity]),
            Quantity::Motor(role) => Some((role, role == Role::Torque)),
        };
    }
    let own = encoder(name)?;
    let all: BTreeSet<usize> = content
        .columns
        .iter()
        .filter_map(|other| encoder(&other.name))
        .collect();
    // More of them are of joints.
    let is_pair = all.iter().eq(&[1, 2]);
    let role = [Role::MotorPosition, Role::LinkPosition];
    is_pair.then(|| (role[own - 1], false))
}

/// The joint of a column that has a role by its parameter or encoder: its drive, where the file has several.
pub fn joint(content: &Content, index: usize) -> Option<String> {
    let drive = |name: &Name| parameter(name).map(|(place, ..)| name.words[..place].join("_"));
    let drives: BTreeSet<String> = content
        .columns
        .iter()
        .filter_map(|own| drive(&own.name))
        .collect();
    let own = drive(&content.columns[index].name)?;
    (drives.len() > 1 && !own.is_empty()).then_some(own)
}

/// A parameter in a name, `Drive_1: r0482[1]`: the place of its word, what it is, and its index.
fn parameter(name: &Name) -> Option<(usize, Quantity, usize)> {
    let known = |word: &String| {
        let digits = word.strip_prefix('r').filter(|own| own.len() > 1)?;
        let number: u32 = digits.parse().ok()?;
        PARAMETERS
            .iter()
            .find(|own| own.0 == number)
            .map(|own| own.1)
    };
    let found = name
        .words
        .iter()
        .enumerate()
        .find_map(|(place, word)| Some((place, known(word)?)));
    let (place, quantity) = found?;
    let index = name.words.get(place + 1).and_then(|word| word.parse().ok());
    Some((place, quantity, index.unwrap_or(0)))
}

/// The number, 1 or more, of the encoder whose actual position a column is by its words: `Lageistwert Geber 2`.
fn encoder(name: &Name) -> Option<usize> {
    let has = |words: &[&str]| name.words.iter().any(|own| words.contains(&own.as_str()));
    let place = name
        .words
        .iter()
        .position(|own| ENCODER.contains(&own.as_str()))?;
    let number: usize = name.words.get(place + 1)?.parse().ok()?;
    (has(&POSITION) && has(&ACTUAL) && number > 0).then_some(number)
}
