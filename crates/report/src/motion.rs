//! Recorded, before and after over time, and the residuals.

use super::case::Case;
use super::shown::{Shown, peak};
use super::{happened, words};
use core::ops::Range;
use quell_diagnosis::{OutputTrace, Verdict};
use quell_page::{Chart, Page};

/// Fewest and most samples of the close look.
const CLOSE: (usize, usize) = (60, 1500);
/// Part of the recording that the close look shows.
const CLOSE_PART: usize = 6;

/// Least ratio of the misfits before and after for a separate chart of the latter.
const LARGER: f64 = 3.0;

/// The names of the curves, on the whole page.
pub struct Names {
    /// Of the given model, refitted.
    pub before: String,
    /// Of the model with the findings.
    pub after: String,
}

const RECORDED: &str = "recorded";

/// The curves of a usual report, in the order of their colours.
pub fn usual(case: &Case) -> [String; 3] {
    let Names { before, after } = names(case);
    [RECORDED.into(), before, after]
}

/// The names for a case.
pub fn names(case: &Case) -> Names {
    let findings = &case.diagnosis.findings;
    let before = match case.has_after() {
        true => "before: the model, refitted",
        false => "the model, refitted",
    };
    let after = match findings.len() {
        0..=2 => case.findings(),
        _ => "all that was found".into(),
    };
    Names {
        before: before.into(),
        after: format!("after: with {after}"),
    }
}

/// Charts of the most important output.
pub fn section(page: Page, case: &Case) -> Page {
    let Some(trace) = case
        .traces
        .outputs
        .first()
        .filter(|trace| !trace.time.is_empty())
    else {
        return page;
    };
    let names = names(case);
    let close = close_look(trace);
    let heading = match case.diagnosis.verdict {
        Verdict::NoMismatch | Verdict::NotExcited => "Recorded and predicted",
        Verdict::Unexplained => "What the model misses",
        _ => "What it changes",
    };
    let (from, to) = (trace.time[close.start], trace.time[close.end - 1]);
    let name = words::capital(&trace.name);
    let title = format!("{name}, {from:.2} to {to:.2} s: a close look");
    let note = match case.diagnosis.verdict {
        Verdict::NoMismatch => "The stretch with the largest misfit of all; it is noise.",
        Verdict::NotExcited => "The stretch with the largest misfit of all.",
        _ => "The stretch in which the model misses most.",
    };
    let near = curves(case, trace, close, title, &names).note(note);
    let all = 0..trace.time.len();
    let whole = curves(
        case,
        trace,
        all.clone(),
        format!("{name}, the whole recording"),
        &names,
    );
    let page = page
        .heading(heading)
        .chart(near)
        .chart(residuals(case, trace, &names));
    let page = enlarged(case, trace, &names)
        .into_iter()
        .fold(page, Page::chart);
    page.chart(held_out(whole, trace))
}

/// Recorded, before and after over a range of samples.
fn curves(
    case: &Case,
    trace: &OutputTrace,
    range: Range<usize>,
    title: String,
    names: &Names,
) -> Chart {
    let shown = Shown::of(&trace.unit, peak(&trace.recorded));
    let time = part(&trace.time, &range);
    let values = |values: &[f64]| shown.values(part(values, &range));
    let chart = Chart::lines(title, "time", "s", quantity(trace), shown.unit.clone())
        .broad(RECORDED, time, &values(&trace.recorded))
        .series(&names.before, time, &values(&trace.before));
    match case.has_after() {
        true => chart.series(&names.after, time, &values(&trace.after)),
        false => chart,
    }
}

/// The residuals of the recording, before and after, with the noise.
fn residuals(case: &Case, trace: &OutputTrace, names: &Names) -> Chart {
    let chart = misfit(case, trace, "Misfit: recorded less predicted");
    let happened = happened::times(case, trace).into_iter();
    let chart = happened.fold(chart, |chart, (time, name)| chart.marker(time, name));
    let chart = over_time(case, chart, trace, &names.before, &trace.before);
    let chart = match case.has_after() {
        true => over_time(case, chart, trace, &names.after, &trace.after),
        false => chart,
    };
    if case.diagnosis.verdict == Verdict::NotExcited {
        return chart;
    }
    chart
        .note("A model that lacks nothing leaves noise: 95 % of its misfit stays in the grey band.")
}

/// The residual after, enlarged, if it is too small beside the one before.
fn enlarged(case: &Case, trace: &OutputTrace, names: &Names) -> Option<Chart> {
    let [before, after] = [&trace.before, &trace.after].map(|model| peak(&residual(trace, model)));
    if !case.has_after() || before < LARGER * after {
        return None;
    }
    let chart = misfit(case, trace, "Misfit after, enlarged");
    Some(over_time(case, chart, trace, &names.after, &trace.after))
}

/// A chart of misfit with the noise and the held-out stretches.
fn misfit(case: &Case, trace: &OutputTrace, title: &str) -> Chart {
    let shown = case.misfit_unit();
    let two = 2.0 * trace.noise_std * shown.factor;
    let chart = Chart::lines(title, "time", "s", "misfit", shown.unit);
    held_out(chart, trace).shade_y(-two, two, "noise, ± 2 standard deviations")
}

fn over_time(case: &Case, chart: Chart, trace: &OutputTrace, name: &str, model: &[f64]) -> Chart {
    let values = case.misfit_unit().values(&residual(trace, model));
    chart.series(name, &trace.time, &values)
}

/// Marks the held-out stretches.
fn held_out(chart: Chart, trace: &OutputTrace) -> Chart {
    let all = trace.held_out.iter().enumerate();
    all.fold(chart, |chart, (index, &[from, to])| {
        let label = if index == 0 { "held out" } else { "" };
        chart.shade_x(from, to, label)
    })
}

/// The stretch with the largest misfit before.
fn close_look(trace: &OutputTrace) -> Range<usize> {
    let count = trace.time.len();
    let length = (count / CLOSE_PART).clamp(CLOSE.0, CLOSE.1).min(count);
    let energy =
        residual(trace, &trace.before)
            .into_iter()
            .map(|residual| match residual.is_finite() {
                true => residual * residual,
                false => 0.0,
            });
    let mut sums = vec![0.0];
    for value in energy {
        sums.push(sums[sums.len() - 1] + value);
    }
    let inside = |start: &usize| sums[start + length] - sums[*start];
    let best = (0..=count - length).max_by(|a, b| inside(a).total_cmp(&inside(b)));
    let start = best.unwrap_or(0);
    start..start + length
}

fn part<'a>(values: &'a [f64], range: &Range<usize>) -> &'a [f64] {
    let end = range.end.min(values.len());
    &values[range.start.min(end)..end]
}

/// Recorded minus predicted; NaN where either is missing.
pub fn residual(trace: &OutputTrace, predicted: &[f64]) -> Vec<f64> {
    let of =
        |(index, recorded): (usize, &f64)| recorded - predicted.get(index).unwrap_or(&f64::NAN);
    trace.recorded.iter().enumerate().map(of).collect()
}

/// The role's name as words: the last part of the trace's.
fn quantity(trace: &OutputTrace) -> String {
    let role = trace.name.rsplit([' ', '/', ':']).next();
    words::plain(role.unwrap_or(&trace.name))
}
