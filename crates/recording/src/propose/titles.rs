//! The titles of columns from the lines above the numbers: names, a row of units, a block of lines.

use super::cells::{split, unmarked};
use super::{name, units};

/// What stands in a row of units for a quantity that has none, or whose unit is that of the device.
const NO_UNITS: [&str; 16] = [
    "-", "--", "%", "\u{2030}", "1/1", "a.u.", "bool", "bit", "lsb", "n/a",
    // Of quantities that are no joint's.
    "\u{b0}c", "degc", "w", "kw", "hz", "khz",
];

/// What a row of units may begin with.
const LABELS: [&str; 5] = ["unit", "units", "einheit", "einheiten", "unit_string"];

/// The names of columns in a block of lines above the numbers, as of a trace with a line of names, of types, of factors:
/// those of the topmost line that has most names of roles, where the lowest has none. A line of units is joined to them.
pub fn of_block<'a>(
    lowest: &str,
    over: impl Iterator<Item = &'a str>,
    delimiter: char,
) -> Option<Vec<String>> {
    let tell = |line: &str| {
        let cells = split(line, delimiter).into_iter();
        cells
            .filter(|cell| name::parse(cell).role().is_some())
            .count()
    };
    if tell(lowest) > 0 {
        return None;
    }
    let over: Vec<&str> = over.collect();
    let best = over.iter().max_by_key(|line| tell(line))?;
    let units = std::iter::once(lowest).chain(over.iter().copied());
    let names = match units.into_iter().find(|line| is_units(line, delimiter)) {
        Some(units) => joined(best, units, delimiter),
        None => split(best, delimiter)
            .into_iter()
            .map(str::to_owned)
            .collect(),
    };
    (tell(best) > 0).then_some(names)
}

/// The names of a header in which one stands twice: the columns are then called by their numbers.
pub fn repeated(header: &str, delimiter: char) -> Option<Vec<String>> {
    let names = named(header, delimiter);
    let again = |(k, name): (usize, &String)| !name.is_empty() && names[..k].contains(name);
    let is_one = names.iter().enumerate().any(again);
    is_one.then_some(names)
}

/// The names of a header.
pub fn named(header: &str, delimiter: char) -> Vec<String> {
    let names = split(unmarked(header), delimiter).into_iter();
    names.map(str::to_owned).collect()
}

/// Whether a line contains only units, more than one. A cell may be blank, a quantity without a physical unit has a
/// sign of its own, and what is in brackets may be the unit of any quantity; but one at least is a unit.
pub fn is_units(line: &str, delimiter: char) -> bool {
    let cells = split(line, delimiter);
    let said: Vec<&str> = cells.into_iter().filter(|cell| !cell.is_empty()).collect();
    let is_one = |cell: &&str| units::is_unit(units::in_brackets(bare(cell)));
    let is_sign = |cell: &&str| NO_UNITS.contains(&bare(cell).to_lowercase().as_str());
    let is_in_brackets = |cell: &&str| bare(cell) != *cell;
    let is_any = |own: &&str| is_one(own) || is_sign(own) || is_label(own) || is_in_brackets(own);
    said.len() > 1 && said.iter().any(is_one) && said.iter().all(is_any)
}

/// Whether a cell tells that the others of its line are units.
fn is_label(cell: &str) -> bool {
    LABELS.contains(&cell.to_lowercase().trim_end_matches(':'))
}

/// A unit without its brackets.
fn bare(unit: &str) -> &str {
    unit.trim_matches(['(', ')', '[', ']', '<', '>']).trim()
}

/// `name [unit]` of each column.
pub fn joined(names: &str, units: &str, delimiter: char) -> Vec<String> {
    let pairs = split(names, delimiter)
        .into_iter()
        .zip(split(units, delimiter));
    let titled = |(name, unit): (&str, &str)| match bare(unit) {
        "" | "-" | "--" => name.to_owned(),
        unit if is_label(unit) => name.to_owned(),
        unit => format!("{name} [{unit}]"),
    };
    pairs.map(titled).collect()
}
