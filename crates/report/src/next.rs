//! The next move, which separates explanations.

use super::case::Case;
use quell_diagnosis::{NextMove, ProposedMove};
use quell_page::{Page, Table, digits};

/// The next move, if there is one.
pub fn section(page: Page, case: &Case) -> Page {
    let Some(next) = &case.diagnosis.next_move else {
        return page;
    };
    let page = page.heading("What to do next").text(next.why.clone());
    match next.moves.is_empty() {
        true => page,
        false => page.table(table(next)),
    }
}

fn table(next: &NextMove) -> Table {
    let unit = next.moves.first().map_or("", shown_unit);
    let mut table = Table::new("The moves")
        .column("distance", unit)
        .column("peak speed", format!("{unit}/s"))
        .column("peak acceleration", format!("{unit}/s^2"))
        .column("peak jerk", format!("{unit}/s^3"))
        .column("then wait", "s")
        .note(
            "The first starts where the first recording does, each further one where the one before it has \
             ended.",
        );
    for one in &next.moves {
        table = table.row(shown(one).map(Into::into));
    }
    table
}

/// The unit in which a move is shown.
pub fn shown_unit(one: &ProposedMove) -> &str {
    match one.unit.as_str() {
        "rad" => "deg",
        unit => unit,
    }
}

/// Distance, speed, acceleration, jerk and pause, angles in degrees.
pub fn shown(one: &ProposedMove) -> [f64; 5] {
    let factor = match one.unit.as_str() {
        "rad" => 1_f64.to_degrees(),
        _ => 1.0,
    };
    let motion = [one.distance, one.speed, one.acceleration, one.jerk].map(|value| value * factor);
    let [distance, speed, acceleration, jerk] = motion;
    [distance, speed, acceleration, jerk, one.pause_s].map(|value| digits(value, 3))
}
