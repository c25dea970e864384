//! The joint of a column: the number in its name, where a file has several joints.

use super::super::role::Role;
use super::content::{Column, Content};
use super::name;
use std::collections::BTreeSet;

/// Roles that a joint has and a sensor beside it has not: a joint is what moves.
const MOTION: [Role; 5] = [
    Role::MotorPosition,
    Role::MotorVelocity,
    Role::LinkPosition,
    Role::LinkVelocity,
    Role::CommandPosition,
];

/// The joint of each column, with their roles: the index of a list element, else a number that columns of several joints have in
/// their names: `q1` and `q2`, `joint1.position` and `joint2.position`.
pub fn of(content: &Content, roles: &[Option<Role>]) -> Vec<Option<String>> {
    let columns = &content.columns;
    let joints = numbered(columns, roles);
    let joint = |column: &Column| {
        element(&column.title).or_else(|| {
            let (_, number) = column.name.numbered()?;
            joints.contains(&number).then_some(number)
        })
    };
    columns.iter().map(joint).collect()
}

/// Each joint once, in their order.
pub fn distinct<'a>(all: impl Iterator<Item = &'a String>) -> Vec<String> {
    let mut joints: Vec<String> = Vec::new();
    for joint in all {
        if !joints.contains(joint) {
            joints.push(joint.clone());
        }
    }
    joints
}

/// The index of a list element: 3 of `state[3]`.
fn element(title: &str) -> Option<String> {
    let at = name::index_of(title)?;
    Some(title[at..].trim_matches(['[', ']']).into())
}

/// Numbers in names of motions that differ in nothing else.
fn numbered(columns: &[Column], roles: &[Option<Role>]) -> BTreeSet<String> {
    let moves = |role: &Option<Role>| role.is_some_and(|role| MOTION.contains(&role));
    let moving = columns.iter().zip(roles).filter(|(_, role)| moves(role));
    let named: Vec<_> = moving
        .filter_map(|(column, _)| Some((column.name.numbered()?, &column.name.unit)))
        .collect();
    let twin = |((stem, number), unit): &&((String, String), _)| {
        let same = |((other, own), its): &((String, String), _)| {
            (other, its) == (stem, unit) && own != number
        };
        named.iter().any(same)
    };
    let twins = named.iter().filter(twin);
    twins.map(|((_, number), _)| number.clone()).collect()
}
