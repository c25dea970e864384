//! The report of a comparison.

use super::print::{describe, percent_label};
use super::{Comparison, ERRORS, errors};
use crate::page::{Cell, Chart, Figure, Page, Table, Verdict, digits};

/// The page: advice first, then table, curves and trains.
pub fn page(comparison: &Comparison) -> Page {
    let modes: Vec<String> = comparison
        .modes
        .iter()
        .map(|known| describe(&known.mode))
        .collect();
    let mut page = Page::new(format!("Shapers for {}", comparison.machine)).subtitle(format!(
        "{}, commands at {} Hz",
        modes.join(" and "),
        comparison.rate
    ));
    page = match comparison.choice() {
        Some(choice) => page
            .verdict(Verdict::Good, format!("Recommended: {}", choice.reason))
            .figure(Figure::text("recommended", choice.figures.shaper.title()))
            .figure(Figure::new("delay", choice.delay, "s").note("added to the end of a move"))
            .figure(
                Figure::new(
                    "residual vibration",
                    digits(100.0 * choice.figures.worst_95, 3),
                    "%",
                )
                .note("of the unshaped; below that with 95 % probability"),
            ),
        None => page.verdict(Verdict::Bad, super::NO_CHOICE),
    };
    page = page.table(figures(comparison)).chart(curves(comparison));
    if let Some(chart) = train(comparison) {
        page = page.chart(chart);
    }
    if comparison.unshaped.is_some() {
        page = page.table(simulated(comparison));
    }
    let note = |page: Page, remark: &String| page.text(format!("Note: {remark}."));
    comparison.remarks.iter().fold(page, note)
}

/// A share in percent; rounding errors around an exact zero are set to zero.
fn percent(share: f64) -> f64 {
    (1e8 * share).round() / 1e6
}

fn percent_header(table: Table, unit: &str) -> Table {
    ERRORS.iter().fold(table, |table, error| {
        table.column(format!("at {}", percent_label(*error)), unit)
    })
}

fn figures(comparison: &Comparison) -> Table {
    let table = Table::new("Residual vibration, in percent of the unshaped, by frequency error")
        .text_column("shaper")
        .column("95 % bound", "%")
        .column("delay", "s")
        .column("insensitivity", "")
        .column("gain", "");
    let mut table = percent_header(table, "%");
    for (shaper, design) in comparison.designs() {
        let mut cells: Vec<Cell> = vec![
            shaper.name().into(),
            comparison
                .uncertain(shaper)
                .map(|(worst, _)| percent(worst))
                .into(),
            design.train.duration().into(),
            design.insensitivity.into(),
            design.train.gain().into(),
        ];
        cells.extend(ERRORS.map(|error| percent(design.residual(error)).into()));
        table = table.row(cells);
        let chosen = comparison
            .choice()
            .map(|choice| choice.figures.shaper.name());
        if chosen == Some(shaper.name()) {
            table = table.marked();
        }
    }
    table.note(
        "Amplitude after the shaped command over the amplitude after the unshaped one, each at its \
         own end. The head of a column says how far the machine's frequency is from the believed one. \
         95 % bound: the vibration is below this with 95 % probability, for the given uncertainty of the modes. Insensitivity: width \
         of the band of frequencies with at most 5 %, over the frequency. Gain: sum of the amplitudes' absolute values; \
         above 1, velocity and acceleration can exceed the command's.",
    )
}

fn simulated(comparison: &Comparison) -> Table {
    let table = Table::new("The robot's move, simulated: greatest tip deformation after its end");
    let mut table = percent_header(table.text_column("shaper"), "mm");
    let row = |name: &str, values: &[f64]| {
        let cells = [name.into()]
            .into_iter()
            .chain(values.iter().map(|value| digits(*value, 3).into()));
        cells.collect::<Vec<Cell>>()
    };
    if let Some(unshaped) = &comparison.unshaped {
        table = table.row(row("unshaped", &unshaped.residual_mm));
    }
    for (shaper, design) in comparison.designs() {
        if let Some(simulated) = &design.simulated {
            table = table.row(row(shaper.name(), &simulated.residual_mm));
        }
    }
    table.note("Counted from where the motor side has followed to one encoder step.")
}

fn curves(comparison: &Comparison) -> Chart {
    let error: Vec<f64> = errors(comparison.spread)
        .map(|error| 100.0 * error)
        .collect();
    let title = "Residual vibration over the frequency error";
    let mut chart = Chart::lines(
        title,
        "frequency error",
        "%",
        "residual vibration",
        "% of unshaped",
    )
    .level(100.0 * comparison.wish.acceptable, "acceptable");
    for (shaper, design) in comparison.designs() {
        let left = errors(comparison.spread).map(|error| 100.0 * design.residual(error));
        chart = chart.series(shaper.name(), &error, &left.collect::<Vec<_>>());
    }
    chart.note("Unshaped is 100 %.")
}

/// The recommended shaper's taps.
fn train(comparison: &Comparison) -> Option<Chart> {
    let chosen = comparison.choice()?.figures.shaper.name();
    let (shaper, design) = comparison
        .designs()
        .find(|(shaper, _)| shaper.name() == chosen)?;
    let period = design.train.sample_time();
    let taps = design.train.taps();
    let time: Vec<f64> = taps
        .iter()
        .map(|tap| f64::from(tap.delay) * period)
        .collect();
    let amplitude: Vec<f64> = taps.iter().map(|tap| tap.amplitude).collect();
    let title = format!("Taps of {} on the controller's grid", shaper.title());
    let chart = Chart::stems(title, "time", "s", "amplitude", "");
    let chart = chart.series(shaper.name(), &time, &amplitude);
    Some(
        chart.note(
            "Each number is the amplitude of a tap. quell shape prints times and amplitudes.",
        ),
    )
}
