//! Columns of a tool that are counted: `tool_accelerometer_0` to `_2` are axes, and of no joint.

use super::super::role::Role;
use super::content::Content;

/// Words for the tool.
const TOOL: [&str; 5] = ["tip", "tcp", "tool", "ee", "flange"];
/// Axes of a vector.
const AXES: usize = 3;

/// The place of a column among those of a tool that differ in a number alone, if there are three or more.
pub fn place(content: &Content, index: usize) -> Option<usize> {
    let name = &content.columns[index].name;
    let of_tool = name.words.iter().any(|word| TOOL.contains(&word.as_str()));
    let (stem, number) = name
        .numbered()
        .filter(|_| of_tool && name.axis().is_none())?;
    let own: usize = number.parse().ok()?;
    let alike = content
        .columns
        .iter()
        .filter_map(|column| column.name.numbered());
    let numbers = alike.filter(|(other, _)| *other == stem);
    let numbers: Vec<usize> = numbers
        .filter_map(|(_, number)| number.parse().ok())
        .collect();
    let first = *numbers.iter().min()?;
    (numbers.len() >= AXES).then_some(own - first)
}

/// The role that such a column keeps: the first three of an accelerometer are its axes. A pose or a force of the tool that a
/// controller tells beside its joints is computed from them.
pub fn role(place: usize, role: Option<(Role, bool)>) -> Option<(Role, bool)> {
    role.filter(|(role, _)| *role == Role::TipAcceleration && place < AXES)
}
