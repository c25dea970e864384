//! The joint of a column: the number or the words in its name, where a file has several joints.

use super::super::role::Role;
use super::column::Column;
use super::content::Content;
use super::name;
use super::words::{BESIDE, WORDS};
use super::{drives, siemens, tool};
use std::collections::{BTreeMap, BTreeSet};

/// Roles that a joint has and a sensor beside it has not: a joint is what moves.
const MOTION: [Role; 5] = [
    Role::MotorPosition,
    Role::MotorVelocity,
    Role::LinkPosition,
    Role::LinkVelocity,
    Role::CommandPosition,
];

/// The joint of each column, with their roles: the index of a list element, else a number that columns of several joints have in
/// their names: `q1` and `q2`, `joint1.position` and `joint2.position`; else their words, as of `shoulder_position` and
/// `elbow_position`.
pub fn of(content: &Content, roles: &[Option<Role>]) -> Vec<Option<String>> {
    let columns = &content.columns;
    let numbers = numbered(columns, roles);
    let labels = match numbers.is_empty() {
        true => labelled(columns, roles),
        false => Vec::new(),
    };
    let joint = |(index, column): (usize, &Column)| {
        if tool::place(content, index).is_some() {
            return None;
        }
        // The numbers of encoders and of indices of a drive count no joints.
        if siemens::role(content, index).is_some() || drives::elmo(content, index).is_some() {
            return siemens::joint(content, index);
        }
        element(&column.title)
            .or_else(|| {
                let (_, number) = column.name.numbered()?;
                numbers.contains(&number).then_some(number)
            })
            .or_else(|| {
                let own = &column.name.words;
                // Of `wrist` and `wrist_roll` the longer.
                let fits = labels
                    .iter()
                    .filter(|label| label.iter().all(|word| own.contains(word)));
                fits.max_by_key(|label| label.len())
                    .map(|label| label.join("_"))
            })
    };
    columns.iter().enumerate().map(joint).collect()
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

/// A role, and the unit and the words of a role in a name.
type Said<'a> = (&'a str, Option<&'a String>, Vec<&'a String>);

/// Words by which names of motions differ that say the same of role and unit: each name has some of its own, and none of
/// them tells two signals of one joint apart.
fn labelled(columns: &[Column], roles: &[Option<Role>]) -> Vec<Vec<String>> {
    let mut alike: BTreeMap<Said, Vec<&Column>> = BTreeMap::new();
    for (column, role) in columns.iter().zip(roles) {
        if let Some(role) = role.filter(|role| MOTION.contains(role)) {
            let said = column
                .name
                .words
                .iter()
                .filter(|word| is_said(word))
                .collect();
            let same = (role.name(), column.name.unit.as_ref(), said);
            alike.entry(same).or_default().push(column);
        }
    }
    let mut labels: Vec<Vec<String>> = Vec::new();
    for columns in alike.into_values() {
        let names: Vec<_> = columns.iter().map(|column| &column.name.words).collect();
        let own = |words: &&Vec<String>| {
            let is_own = |word: &&String| !names.iter().all(|words| words.contains(word));
            words.iter().filter(is_own).cloned().collect()
        };
        let found: Vec<Vec<String>> = names.iter().map(own).collect();
        let is_beside = |word: &String| BESIDE.contains(&word.as_str());
        let is_joint = |label: &Vec<String>| !label.is_empty() && !label.iter().any(is_beside);
        if found.iter().all(is_joint) {
            labels.extend(found);
        }
    }
    labels.sort();
    labels.dedup();
    labels
}

/// Whether a word is one of those that tell a role.
fn is_said(word: &str) -> bool {
    let mut lines = WORDS.iter();
    lines.any(|line| line.1.contains(&word) || line.2.contains(&word))
}
