//! Parameters of a learned law: the ends of its range, and the list of its values at the knots.

use super::super::{Effect, Value};
use super::signs::signs;
use super::source::{Source, Table};
use super::{ModelError, value};
use crate::effects::{Parameter, ParameterRole};

/// The key of the list.
pub const VALUES: &str = "values";

/// Reads all parameters of a learned law, with as many knots as the file has values.
pub fn parameters(
    source: &Source,
    effect: &'static Effect,
    mut table: Table,
) -> Result<(&'static Effect, Vec<Value>), ModelError> {
    let is_end = |parameter: &&Parameter| parameter.role == ParameterRole::Range;
    let list = table.take(VALUES).ok_or_else(|| table.missing(VALUES))?;
    let entries = list.list(source)?;
    let knots = |own: &Effect| own.parameters.iter().filter(|p| !is_end(p)).count();
    let Some(effect) = effect.resolutions().find(|own| knots(own) == entries.len()) else {
        let known: Vec<_> = effect
            .resolutions()
            .map(|own| knots(own).to_string())
            .collect();
        let (found, known) = (entries.len(), known.join(" or "));
        return Err(list.refuse(
            source,
            format!("{found} values; {} has {known}", effect.name),
        ));
    };
    let mut ordinates = entries.iter();
    let (mut parameters, mut ends) = (Vec::new(), Vec::new());
    for parameter in effect.parameters {
        let range = signs(parameter);
        if !is_end(&parameter) {
            let entry = ordinates.next().unwrap_or(&list);
            parameters.push(value(source, entry, range)?);
            continue;
        }
        let entry = table.take(parameter.name);
        let entry = entry.ok_or_else(|| table.missing(parameter.name))?;
        let end = value(source, &entry, range)?;
        if let Some(before) = ends.last().filter(|before| **before >= end.value) {
            let reason = format!("{:?} is not above {before:?}, where it begins", end.value);
            return Err(entry.refuse(source, reason));
        }
        ends.push(end.value);
        // It is the visited range, which no fit changes.
        parameters.push(Value { fixed: true, ..end });
    }
    let ends = effect.parameters.iter().filter(is_end).map(|p| p.name);
    table.finish(ends.chain([VALUES]))?;
    Ok((effect, parameters))
}
