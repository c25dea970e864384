//! The two sides of a joint in the letters of robotics.

use super::super::role::Role;
use super::content::Content;
use super::name::Name;
use crate::range;

/// What the two positions of a joint may be called beside their subscripts.
const LETTERS: [&str; 8] = [
    "theta", "q", "phi", "angle", "pos", "position", "enc", "encoder",
];

/// The role of a column whose letter tells it beside that of another one; a guess.
pub fn role(content: &Content, index: usize) -> Option<Role> {
    let side = || subscript(content, index);
    let deflects = || is_alpha_of_theta(content, index).then_some(Role::Deformation);
    match is_link_of_theta(content, index) {
        true => Some(Role::LinkPosition),
        false => side().or_else(deflects),
    }
}

/// The other columns with the unit of one.
fn beside(content: &Content, index: usize) -> impl Iterator<Item = (usize, &Name)> {
    let unit = &content.columns[index].name.unit;
    let names = content
        .columns
        .iter()
        .map(|column| &column.name)
        .enumerate();
    names.filter(move |(k, name)| *k != index && name.unit == *unit)
}

/// Whether a column is a joint's `q` beside its `theta`: the link's position and the motor's, as in M. Spong, Modeling and
/// Control of Elastic Joint Robots, ASME J. Dynamic Systems, Measurement and Control 109 (1987), and the works after it.
fn is_link_of_theta(content: &Content, index: usize) -> bool {
    let [word] = content.columns[index].name.words.as_slice() else {
        return false;
    };
    let is_beside = |number: &str| {
        let theta = format!("theta{number}");
        beside(content, index).any(|(_, name)| name.words == [theta.as_str()])
    };
    word.strip_prefix('q')
        .is_some_and(|number| number.bytes().all(|b| b.is_ascii_digit()) && is_beside(number))
}

/// The side of a column with the subscript `m`, of the motor, or `l`, of the link or load, beside one that differs in it alone:
/// `theta_m` and `theta_l`.
fn subscript(content: &Content, index: usize) -> Option<Role> {
    let words = &content.columns[index].name.words;
    let place = words
        .iter()
        .position(|word| ["m", "l"].contains(&word.as_str()))?;
    let (role, other) = match words[place].as_str() {
        "m" => (Role::MotorPosition, "l"),
        _ => (Role::LinkPosition, "m"),
    };
    let mut twin = words.clone();
    twin[place] = other.into();
    let is_beside = beside(content, index).any(|(_, name)| name.words == twin);
    let is_position = words.iter().any(|word| LETTERS.contains(&word.as_str()));
    (is_position && is_beside).then_some(role)
}

/// Whether a column is the deflection `alpha` of a link beside the angle `theta` of its hub, as in the Quanser Rotary Flexible
/// Joint and Flexible Link: it moves by less than the hub.
fn is_alpha_of_theta(content: &Content, index: usize) -> bool {
    let own = &content.columns[index];
    let moves = |k: usize| {
        let there = content.columns[k].numbers.iter().copied();
        range(&there.filter(|value| value.is_finite()).collect::<Vec<_>>())
    };
    own.name.words == ["alpha"]
        && beside(content, index)
            .any(|(k, name)| name.words == ["theta"] && moves(index) < moves(k))
}
