//! The report of `quell move`.

use nalgebra::Point3;

use super::document::{self, Learned, SETTLED};
use crate::closed_loop::{Comparison, MoveKind, MoveTrace, Scenario, Tick};
use crate::page::{Bars, Chart, Figure, Page, Table, Verdict, decimals_beside, digits, number};
use crate::recording::Role;
use crate::signal::{CubicSpline, End, Window, spectrum};

/// The report.
pub fn page(scenario: &Scenario, comparison: &Comparison) -> Page {
    let mut page = Page::new(title(scenario))
        .subtitle(document::headline(scenario))
        .verdict(verdict(comparison), sentence(comparison))
        .figures(figures(comparison))
        .table(table(comparison))
        .bars(bars(comparison))
        .heading("Vibration at the tip")
        .chart(deformation(comparison))
        .chart(left_over(comparison))
        .heading("What was learned while the arm moved")
        .chart(estimates(comparison, "natural frequency", "Hz", |e| {
            (
                e.mode.hertz(),
                e.natural_frequency_std / core::f64::consts::TAU,
            )
        }))
        .chart(estimates(comparison, "damping ratio", "", |e| {
            (e.mode.damping_ratio(), e.damping_ratio_std)
        }))
        .heading("Command")
        .chart(command(comparison))
        .chart(trains(comparison))
        .heading("The unshaped move as encoder and tracker saw it");
    for chart in paper_figures(comparison.unshaped()) {
        page = page.chart(chart);
    }
    page.footnote(document::learned(comparison).replace('\n', " "))
        .footnote(document::remarks(scenario, comparison))
        .footnote(format!("Simulated; seed {}.", scenario.simulation.seed))
}

fn title(scenario: &Scenario) -> String {
    format!(
        "Joint {} moves by {} degrees",
        scenario.joint + 1,
        number(scenario.displacement.to_degrees())
    )
}

/// Good if the adapted shaper keeps the 5 % that define insensitivity, at the end and in the whole move.
fn verdict(comparison: &Comparison) -> Verdict {
    let next = MoveKind::AdaptiveNext;
    match comparison.ratio(next).max(comparison.whole_ratio(next)) <= 0.05 {
        true => Verdict::Good,
        false => Verdict::Bad,
    }
}

fn sentence(comparison: &Comparison) -> String {
    let percent = |kind| comparison.ratio(kind) * 100.0;
    let whole = |kind| comparison.whole_ratio(kind) * 100.0;
    format!(
        "The adaptive shaper leaves {:.1} % of the unshaped vibration after its first move, and {:.1} % after the next. The \
         shaper of the wrong belief leaves {:.0} %. During the move, too, while the plan does not accelerate, the tip \
         vibrates by at most {:.1} % with the adaptive shaper on its first move, {:.1} % on the next, and {:.0} % with the \
         wrong belief.",
        percent(MoveKind::AdaptiveFirst),
        percent(MoveKind::AdaptiveNext),
        percent(MoveKind::WrongBelief),
        whole(MoveKind::AdaptiveFirst),
        whole(MoveKind::AdaptiveNext),
        whole(MoveKind::WrongBelief),
    )
}

/// The settling time of the tip, in words.
fn settled(trace: &MoveTrace) -> String {
    let time = trace.settling_time(SETTLED);
    time.map_or_else(
        || "later than watched".to_owned(),
        |time| format!("{time:.2} s"),
    )
}

fn figures(comparison: &Comparison) -> Vec<Figure> {
    let unshaped = comparison.unshaped();
    let next = comparison.adaptive_next();
    let mut figures = vec![
        Figure::text(
            "left after the next move",
            number(digits(next.residual() * 1e6, 3)),
        )
        .unit("um")
        .note(format!("{:.2} mm unshaped", unshaped.residual() * 1e3)),
        Figure::text("settled after", settled(next))
            .note(format!("{} unshaped, to 0.05 mm", settled(unshaped))),
        Figure::new("added delay", next.added_delay() * 1e3, "ms").note("of the command"),
    ];
    if let Some(learned) = Learned::from(comparison) {
        let std = learned.frequency_std();
        let hertz = decimals_beside(std, 3);
        let text = format!("{:.hertz$}", learned.estimate.mode.hertz());
        let truth = format!(
            "± {std:.hertz$}; {:.3} Hz in truth",
            comparison.truth.hertz()
        );
        figures.push(
            Figure::text("frequency learned", text)
                .unit("Hz")
                .note(truth),
        );
        if let (Some(time), Some(periods)) = (learned.converged_at, learned.periods()) {
            let figure = Figure::new("learned after", time * 1e3, "ms");
            figures.push(figure.note(format!("{periods:.1} periods after the move began")));
        }
    }
    figures
}

fn table(comparison: &Comparison) -> Table {
    let mut table = Table::new("The moves")
        .text_column("move")
        .column("residual", "mm")
        .column("residual", "% of unshaped")
        .column("whole move", "mm")
        .column("whole move", "% of unshaped")
        .column("settling", "s")
        .column("added delay", "s")
        .column("final error", "rad");
    for (kind, trace) in comparison.moves() {
        table = table.row([
            words(kind).into(),
            digits(trace.residual() * 1e3, 3).into(),
            digits(comparison.ratio(kind) * 100.0, 3).into(),
            digits(trace.vibration() * 1e3, 3).into(),
            digits(comparison.whole_ratio(kind) * 100.0, 3).into(),
            trace.settling_time(SETTLED).into(),
            comparison.added_delay(kind).into(),
            trace.final_error().into(),
        ]);
    }
    table.note(
        "Residual: peak of the true deformation at the tip after the command has ended and the motor \
         side has followed. Whole move: the same in cruise and at the end, outside the planned phases of \
         acceleration and the length of the train after each. Settling: until the tip stays within 0.05 mm of its target.",
    )
}

fn bars(comparison: &Comparison) -> Bars {
    let residuals: Vec<f64> = comparison
        .moves()
        .map(|(_, trace)| digits(trace.residual() * 1e3, 3))
        .collect();
    let whole: Vec<f64> = comparison
        .moves()
        .map(|(_, trace)| digits(trace.vibration() * 1e3, 3))
        .collect();
    let names = comparison.moves().map(|(kind, _)| words(kind));
    Bars::new("Vibration at the tip", "mm", names)
        .series("after the move", &residuals)
        .series("in the whole move", &whole)
}

fn words(kind: MoveKind) -> &'static str {
    match kind {
        MoveKind::Unshaped => "unshaped",
        MoveKind::WrongBelief => "wrong belief",
        MoveKind::AdaptiveFirst => "adaptive, first move",
        MoveKind::AdaptiveNext => "adaptive, next move",
        MoveKind::WithinTolerance => "fastest within the tolerance",
    }
}

fn column(trace: &MoveTrace, value: impl Fn(&Tick) -> f64) -> Vec<f64> {
    trace.ticks.iter().map(value).collect()
}

fn deformation(comparison: &Comparison) -> Chart {
    deformations(comparison, "Deformation of the joint")
        .note("The next move goes back; it is drawn with its sign turned, to lie over the others.")
}

/// The same, from shortly before the unshaped command ends, at the scale of the residual.
fn left_over(comparison: &Comparison) -> Chart {
    let unshaped = comparison.unshaped();
    let height = 1.1e3 * unshaped.residual();
    let watched = unshaped.ticks.last().map_or(0.0, |tick| tick.time);
    deformations(comparison, "What is left over")
        .x_range(0.9 * unshaped.planned_end, watched)
        .y_range(-height, height)
}

fn deformations(comparison: &Comparison, title: &str) -> Chart {
    let mut chart = Chart::lines(title, "time", "s", "deformation at the tip", "mm");
    for (kind, trace) in comparison.moves() {
        let sign = if kind == MoveKind::AdaptiveNext {
            -1.0
        } else {
            1.0
        };
        let y = column(trace, |tick| sign * tick.tip_deformation * 1e3);
        chart = chart.series(words(kind), &column(trace, |tick| tick.time), &y);
    }
    chart.marker(comparison.unshaped().planned_end, "unshaped command ends")
}

fn estimates(
    comparison: &Comparison,
    name: &str,
    unit: &str,
    value: impl Fn(&crate::estimators::Estimate) -> (f64, f64),
) -> Chart {
    let first = comparison.adaptive_first();
    let seen: Vec<_> = first
        .ticks
        .iter()
        .filter_map(|tick| Some((tick.time, tick.estimate?)))
        .collect();
    let time: Vec<f64> = seen.iter().map(|(time, _)| *time).collect();
    let of = |offset: f64| -> Vec<f64> {
        let at = |(_, estimate): &(f64, _)| {
            let (mean, std) = value(estimate);
            mean + offset * std
        };
        seen.iter().map(at).collect()
    };
    let exact = if unit == "Hz" {
        comparison.truth.hertz()
    } else {
        comparison.truth.damping_ratio()
    };
    let mut chart = Chart::lines(format!("On-line estimate: {name}"), "time", "s", name, unit)
        .band("estimate", "± 2 std", &time, &of(-2.0), &of(2.0))
        .series("estimate", &time, &of(0.0))
        .level(exact, "truth")
        .marker(first.planned_end, "planned move ends")
        .y_range(0.5 * exact, 1.5 * exact)
        .note("Band: two standard deviations.");
    if let Some((time, _)) = first.converged() {
        chart = chart.marker(time, "converged");
    }
    chart
}

fn command(comparison: &Comparison) -> Chart {
    let unshaped = comparison.unshaped();
    let first = comparison.adaptive_first();
    let velocity = |trace: &MoveTrace| column(trace, |tick| tick.velocity.to_degrees());
    let time = |trace: &MoveTrace| column(trace, |tick| tick.time);
    let chart = Chart::lines("Commanded velocity", "time", "s", "velocity", "deg/s")
        .series(
            words(MoveKind::Unshaped),
            &time(unshaped),
            &velocity(unshaped),
        )
        .series(
            words(MoveKind::AdaptiveFirst),
            &time(first),
            &velocity(first),
        )
        .x_range(0.0, 1.2 * first.command_end);
    let within = MoveKind::WithinTolerance;
    match comparison.trace(within) {
        Some(trace) => chart.series(words(within), &time(trace), &velocity(trace)),
        None => chart,
    }
}

fn trains(comparison: &Comparison) -> Chart {
    let mut chart = Chart::stems("Impulse trains", "time", "s", "amplitude", "");
    for (name, trace) in [
        ("believed", comparison.wrong_belief()),
        ("learned", comparison.adaptive_next()),
    ] {
        let impulses = trace.train.clone();
        let time: Vec<f64> = impulses
            .impulses()
            .iter()
            .map(|impulse| impulse.time)
            .collect();
        let amplitude: Vec<f64> = impulses
            .impulses()
            .iter()
            .map(|impulse| impulse.amplitude)
            .collect();
        chart = chart.series(name, &time, &amplitude);
    }
    chart.note("On the controller's grid, where each impulse is split over two ticks.")
}

/// Path in the plane, position along X, and spectrum of the deformation, as the paper's Figs. 3 to 5.
fn paper_figures(trace: &MoveTrace) -> Vec<Chart> {
    let encoder = trace.recording.channel(Role::MotorPosition);
    let tracker = trace.recording.channel(Role::TipPosition);
    let (Some(encoder), Some(tracker)) = (encoder, tracker) else {
        return Vec::new();
    };
    let Ok(motor) = CubicSpline::new(&encoder.time, &encoder.columns[0], End::NotAKnot) else {
        return Vec::new();
    };
    let base = &trace.registration;
    let stamps: Vec<f64> = tracker
        .time
        .iter()
        .map(|&stamp| base.clock.time(stamp))
        .collect();
    let laser: Vec<Point3<f64>> = (0..stamps.len())
        .map(|k| {
            let seen = Point3::new(
                tracker.columns[0][k],
                tracker.columns[1][k],
                tracker.columns[2][k],
            );
            base.sensor_to_base * seen
        })
        .collect();
    let encoder: Vec<Point3<f64>> = stamps
        .iter()
        .map(|&time| trace.arc.tip(motor.value(time)))
        .collect();
    let axis = |points: &[Point3<f64>], axis: usize, scale: f64| -> Vec<f64> {
        points.iter().map(|point| point[axis] * scale).collect()
    };
    let start = stamps.first().copied().unwrap_or(0.0);
    let time: Vec<f64> = stamps.iter().map(|stamp| stamp - start).collect();
    let difference: Vec<f64> = laser
        .iter()
        .zip(&encoder)
        .map(|(laser, encoder)| (laser.x - encoder.x) * 1e3)
        .collect();
    let mut charts = vec![
        Chart::lines("Path of the tip, unshaped", "X", "m", "Y", "m")
            .series(
                "encoder and kinematics",
                &axis(&encoder, 0, 1.0),
                &axis(&encoder, 1, 1.0),
            )
            .series(
                "laser tracker, registered",
                &axis(&laser, 0, 1.0),
                &axis(&laser, 1, 1.0),
            ),
        Chart::lines("Position along X, unshaped", "time", "s", "X", "m")
            .series("encoder and kinematics", &time, &axis(&encoder, 0, 1.0))
            .series("laser tracker, registered", &time, &axis(&laser, 0, 1.0)),
        Chart::lines(
            "Deformation along X, unshaped",
            "time",
            "s",
            "difference",
            "mm",
        )
        .series("laser tracker minus encoder", &time, &difference),
    ];
    charts.extend(fourier(trace, &time, &difference));
    charts
}

fn fourier(trace: &MoveTrace, time: &[f64], difference: &[f64]) -> Option<Chart> {
    let rest = time.iter().position(|&time| time >= trace.motor_end)?;
    let free = difference.get(rest..)?;
    let period = (time.last()? - time.first()?) / (time.len() - 1) as f64;
    let spectrum = spectrum(free, period, Window::Rectangular, 8).ok()?;
    let hertz = spectrum.resolution / core::f64::consts::TAU;
    let lines: Vec<f64> = (0..spectrum.amplitude.len())
        .map(|line| line as f64 * hertz)
        .collect();
    Some(
        Chart::lines(
            "Amplitude spectrum of the free decay",
            "frequency",
            "Hz",
            "amplitude",
            "mm",
        )
        .series("deformation along X", &lines, &spectrum.amplitude)
        .x_range(0.0, 40.0),
    )
}
