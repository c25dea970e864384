//! The next move: what would tell explanations apart.

use super::page::Case;
use super::shown::digits;
use super::words;
use crate::diagnosis::{NextMove, ProposedMove};
use crate::report::{Page, Table, number};

/// What to do next, if anything.
pub fn section(page: Page, case: &Case) -> Page {
    let Some(next) = &case.diagnosis.next_move else {
        return page;
    };
    let page = page.heading("What to do next").text(next.why.clone());
    match next.moves.is_empty() {
        true => page,
        false => page.table(table(next, is_angle(case))),
    }
}

/// Whether the axis turns: its outputs are angles.
pub fn is_angle(case: &Case) -> bool {
    let units = case
        .traces
        .outputs
        .iter()
        .map(|output| output.unit.as_str());
    units
        .chain([case.diagnosis.fit.unit.as_str()])
        .any(|unit| unit.starts_with("rad"))
}

fn table(next: &NextMove, is_angle: bool) -> Table {
    let unit = if is_angle { "deg" } else { "m" };
    let [one, other] = &next.separates;
    let mut table = Table::new("The move")
        .column("distance", unit)
        .column("peak speed", format!("{unit}/s"))
        .column("peak acceleration", format!("{unit}/s^2"))
        .column("then wait", "s")
        .note(format!(
            "It separates {} from {}: the wrong one would miss by a chi-squared of at least {}.",
            words::effect(one),
            words::effect(other),
            number(next.expected_score),
        ));
    for one in &next.moves {
        table = table.row(shown(one, is_angle).map(Into::into));
    }
    table
}

/// Distance, speed, acceleration and pause, angles in degrees.
pub fn shown(one: &ProposedMove, is_angle: bool) -> [f64; 4] {
    let factor = if is_angle { 1_f64.to_degrees() } else { 1.0 };
    let motion = [one.distance, one.speed, one.acceleration].map(|value| value * factor);
    let [distance, speed, acceleration] = motion;
    [distance, speed, acceleration, one.pause_s].map(|value| digits(value, 3))
}
