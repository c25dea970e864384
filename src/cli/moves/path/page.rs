//! The report of `quell move --path`.

use super::super::document::SETTLED;
use super::document;
use crate::closed_loop::{PathComparison, PathJoint, PathKind, PathScenario, PathTrace, Tick};
use crate::page::{Bars, Chart, Figure, Page, Table, Verdict};

/// Share of the unshaped vibration up to which a move counts as calm: the 5 % that define insensitivity.
const CALM: f64 = 0.05;
/// Moves that are drawn: those after which the modes are known.
const DRAWN: [PathKind; 2] = [PathKind::OwnTrainsNext, PathKind::CommonTrainNext];

/// The report.
pub fn page(scenario: &PathScenario, comparison: &PathComparison) -> Page {
    let numbers = scenario
        .joints
        .iter()
        .map(|joint| (joint.joint + 1).to_string());
    let numbers = numbers.collect::<Vec<_>>().join(", ");
    let page = Page::new(format!("Joints {numbers} move on a path"))
        .subtitle(document::headline(scenario))
        .verdict(
            verdict(scenario, comparison),
            document::sentence(comparison),
        )
        .figures(figures(comparison))
        .table(table(scenario, comparison))
        .bars(bars(scenario, comparison))
        .heading("The path")
        .chart(path(scenario, comparison))
        .chart(departures(comparison))
        .heading("Vibration at the tip");
    let page = vibration(scenario, comparison)
        .into_iter()
        .fold(page, Page::chart);
    page.footnote(document::remarks(scenario, comparison))
        .footnote(format!(
            "Simulated, each joint by itself: what one does to another is left out. Seed {}.",
            scenario.simulation.seed
        ))
}

/// Good if every joint that vibrates is calm after the move with the common train.
fn verdict(scenario: &PathScenario, comparison: &PathComparison) -> Verdict {
    let ratio = |joint| comparison.ratio(PathKind::CommonTrainNext, joint);
    // A stiff joint has no ratio.
    match (0..scenario.joints.len()).any(|joint| ratio(joint) > CALM) {
        true => Verdict::Bad,
        false => Verdict::Good,
    }
}

fn figures(comparison: &PathComparison) -> Vec<Figure> {
    let [own, common] = DRAWN.map(|kind| comparison.trace(kind));
    vec![
        Figure::text(
            "off the path, trains for each joint",
            format!("{:.3}", document::off_the_path(own)),
        )
        .unit("deg")
        .note("of the command, in joint space"),
        Figure::text(
            "off the path, common train",
            format!("{:.3}", document::off_the_path(common)),
        )
        .unit("deg")
        .note("but for rounding"),
        Figure::new(
            "added delay, common train",
            common.added_delay() * 1e3,
            "ms",
        )
        .note(format!(
            "{:.0} ms with trains for each joint",
            own.added_delay() * 1e3
        )),
    ]
}

fn table(scenario: &PathScenario, comparison: &PathComparison) -> Table {
    let mut table = Table::new("The moves")
        .text_column("move")
        .text_column("joint")
        .column("off the path", "deg")
        .column("links off the path", "deg")
        .column("residual", "mm")
        .column("residual", "% of unshaped")
        .column("settling", "s")
        .column("added delay", "s");
    for (kind, trace) in &comparison.moves {
        for (index, joint) in trace.joints.iter().enumerate() {
            let ratio = comparison.ratio(*kind, index);
            table = table.row([
                words(*kind).into(),
                (scenario.joints[index].joint + 1).to_string().into(),
                document::off_the_path(trace).into(),
                trace.link_departure().to_degrees().into(),
                (joint.residual() * 1e3).into(),
                ratio.is_finite().then_some(ratio * 100.0).into(),
                joint.settling_time(SETTLED).into(),
                comparison.added_delay(*kind).into(),
            ]);
        }
    }
    table.note("Off the path: the largest distance from the straight line between start and target in joint space.")
}

/// A move in words.
fn words(kind: PathKind) -> &'static str {
    match kind {
        PathKind::Unshaped => "unshaped",
        PathKind::OwnTrainsFirst => "trains for each joint, first move",
        PathKind::OwnTrainsNext => "trains for each joint, next move",
        PathKind::CommonTrainFirst => "common train, first move",
        PathKind::CommonTrainNext => "common train, next move",
        PathKind::WithinTolerance => "fastest within the tolerance",
    }
}

fn bars(scenario: &PathScenario, comparison: &PathComparison) -> Bars {
    let names = scenario
        .joints
        .iter()
        .map(|joint| format!("joint {}", joint.joint + 1));
    let bars = Bars::new("Residual vibration of each joint at the tip", "mm", names);
    comparison.moves.iter().fold(bars, |bars, (kind, trace)| {
        let left: Vec<_> = trace
            .joints
            .iter()
            .map(|joint| joint.residual() * 1e3)
            .collect();
        bars.series(words(*kind), &left)
    })
}

/// The command of the first two moving joints, one over the other.
fn path(scenario: &PathScenario, comparison: &PathComparison) -> Chart {
    let name = |index: usize| format!("joint {}", scenario.joints[index].joint + 1);
    let chart = Chart::lines("Command in joint space", name(0), "deg", name(1), "deg");
    DRAWN.into_iter().fold(chart, |chart, kind| {
        let trace = comparison.trace(kind);
        let of = |joint| column(trace, joint, |tick| tick.position.to_degrees());
        chart.series(words(kind), &of(0), &of(1))
    })
}

fn departures(comparison: &PathComparison) -> Chart {
    let chart = Chart::lines(
        "Distance of the command from the path",
        "time",
        "s",
        "distance",
        "deg",
    );
    DRAWN.into_iter().fold(chart, |chart, kind| {
        let trace = comparison.trace(kind);
        let away = trace.command_departures();
        let away: Vec<_> = away.into_iter().map(f64::to_degrees).collect();
        chart.series(words(kind), &column(trace, 0, |tick| tick.time), &away)
    })
}

fn vibration(scenario: &PathScenario, comparison: &PathComparison) -> Vec<Chart> {
    let kinds = [
        PathKind::Unshaped,
        PathKind::OwnTrainsNext,
        PathKind::CommonTrainNext,
    ];
    let chart = |(index, joint): (usize, &PathJoint)| {
        let title = format!("True deformation at the tip, joint {}", joint.joint + 1);
        let chart = Chart::lines(title, "time", "s", "deformation", "mm");
        kinds.into_iter().fold(chart, |chart, kind| {
            let trace = comparison.trace(kind);
            let time = column(trace, index, |tick| tick.time);
            let deformation = column(trace, index, |tick| tick.tip_deformation * 1e3);
            chart.series(words(kind), &time, &deformation)
        })
    };
    scenario.joints.iter().enumerate().map(chart).collect()
}

fn column(trace: &PathTrace, joint: usize, of: impl Fn(&Tick) -> f64) -> Vec<f64> {
    trace.joints[joint].ticks.iter().map(of).collect()
}
