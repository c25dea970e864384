//! The report: the result, and the estimates over time as in the paper's Fig. 7.

use super::{Findings, registrations, words};
use crate::estimators::offline::amplitude_spectrum;
use crate::estimators::{ESTIMATORS, Estimate};
use crate::identification::{OffLine, Recommended, Run};
use crate::page::{
    Chart, Figure, Page, Table, Verdict, decimals_beside, digits, fixed, number, significant,
};
use quell_shapers::UncertainMode;

const TAU: f64 = core::f64::consts::TAU;

/// The whole page.
pub fn page(findings: &Findings) -> Page {
    let found = &findings.found;
    let mut page = Page::new(format!("Vibratory mode of {}", findings.recording));
    page = match found.recommended() {
        Some(best) => headline(page, findings, &best),
        None => page.verdict(
            Verdict::Bad,
            "No vibratory mode was found in this recording.",
        ),
    };
    for remark in words::remarks(findings) {
        page = page.text(remark);
    }
    page = page
        .table(on_line(findings))
        .table(off_line(found.reference()));
    if let Some(table) = registrations::table(&findings.registered) {
        page = page.table(table);
    }
    page = page.heading("Estimates over time");
    let run = found.reference();
    page = page.chart(frequencies(run)).chart(dampings(run));
    if run.is_free_decay {
        page = page
            .chart(frequencies(&found.whole))
            .chart(dampings(&found.whole));
    }
    page = page
        .heading("The recording")
        .chart(positions(findings))
        .chart(deformation(findings));
    page = page.chart(spectrum(findings, run));
    if let Some(chart) = by_amplitude(findings) {
        page = page.chart(chart);
    }
    page
}

fn headline(page: Page, findings: &Findings, best: &Recommended) -> Page {
    let UncertainMode {
        mode,
        natural_frequency_std,
        damping_ratio_std,
    } = best.mode;
    let beside = |value: f64, std: f64| format!("{value:.*}", decimals_beside(std, 2));
    let (hertz, hertz_std) = (mode.hertz(), natural_frequency_std / TAU);
    let frequency = Figure::text("natural frequency", beside(hertz, hertz_std)).unit("Hz");
    let damping = beside(mode.damping_ratio(), damping_ratio_std);
    let damping = Figure::text("damping ratio", damping);
    let verdict = match words::of_servo(findings) {
        Some(_) => Verdict::Plain,
        None => Verdict::Good,
    };
    let mut page = page
        .verdict(verdict, words::recommended(findings, best))
        .figure(frequency.note(format!(
            "± {} (one standard deviation)",
            two_digits(hertz_std)
        )))
        .figure(damping.note(format!("± {}", two_digits(damping_ratio_std))));
    let line = ESTIMATORS.iter().position(|line| line.name == best.method);
    let run = line.and_then(|line| findings.found.quoted(line));
    let result = run.and_then(|run| run.estimator(best.method));
    if let Some(periods) = result.and_then(|result| result.periods) {
        page = page.figure(Figure::new("to converge", digits(periods, 2), "periods"));
    }
    if let Some(fit) = findings.found.reference().batch() {
        let off = 100.0 * (mode.hertz() / fit.mode.hertz() - 1.0);
        let figure = Figure::text("off-line fit", beside(fit.mode.hertz(), hertz_std)).unit("Hz");
        let side = if off > 0.0 { "above" } else { "below" };
        let note = match off.abs() < 0.01 {
            true => "the recommended agrees within 0.01 %".into(),
            false => format!("the recommended is {} % {side}", fixed(off.abs(), 2)),
        };
        page = page.figure(figure.note(note));
    }
    page
}

/// A static gain with its standard deviation, where the method has one; most are too small for a row of decimals.
fn gain_quoted(estimate: Estimate) -> String {
    let Estimate { gain, gain_std, .. } = estimate;
    match gain_std.is_finite() && gain_std > 0.0 {
        true => format!(
            "{}\u{a0}±\u{a0}{}",
            significant(gain, 2),
            two_digits(gain_std)
        ),
        false => significant(gain, 2),
    }
}

/// A standard deviation as it is quoted: to two digits.
fn two_digits(value: f64) -> String {
    significant(value, 2)
}

fn on_line(findings: &Findings) -> Table {
    let mut table = Table::new("On-line estimators")
        .text_column("estimator")
        .column("frequency", "Hz")
        .column("std", "Hz")
        .column("damping ratio", "")
        .column("std", "")
        .column("static gain", "")
        .column("converged at", "s")
        .column("after", "periods")
        .text_column("over")
        .note(
            "Static gain: deformation over position of the motor side at rest, 0 for a plain mode. Periods count from the start of the motion, or of the free decay. Where a method does not know its error, its distance from the \
             recommended one is added to its standard deviation.",
        );
    for (index, line) in ESTIMATORS.iter().enumerate() {
        let run = findings.found.quoted(index);
        let result = run.and_then(|run| run.estimator(line.name));
        let e = result.and_then(|result| result.estimate);
        let std = e.map(|e| findings.found.deviations(&e, line.states_error));
        let [frequency, frequency_std] =
            with_std(e.map(|e| e.mode.hertz()), std.map(|std| std[0] / TAU));
        let [damping, damping_std] =
            with_std(e.map(|e| e.mode.damping_ratio()), std.map(|std| std[1]));
        let gain = e.map_or_else(|| number(f64::NAN), gain_quoted);
        table = table.row([
            line.name.into(),
            frequency.into(),
            frequency_std.into(),
            damping.into(),
            damping_std.into(),
            gain.into(),
            result
                .and_then(|r| r.converged_at)
                .map_or_else(|| number(f64::NAN), |at| fixed(at, 3))
                .into(),
            result.and_then(|r| r.periods).into(),
            run.map_or("needs a free decay".into(), words::shown).into(),
        ]);
    }
    table
}

fn off_line(run: &Run) -> Table {
    let mut table = Table::new("Off-line references")
        .text_column("method")
        .column("frequency", "Hz")
        .column("std", "Hz")
        .column("damping ratio", "")
        .column("std", "")
        .text_column("over");
    for line in &run.off_line {
        let [frequency, frequency_std] = with_std(
            Some(line.mode.hertz()),
            line.natural_frequency_std.map(|std| std / TAU),
        );
        let [damping, damping_std] =
            with_std(Some(line.mode.damping_ratio()), line.damping_ratio_std);
        table = table.row([
            line.method.into(),
            frequency.into(),
            frequency_std.into(),
            damping.into(),
            damping_std.into(),
            words::used(run).into(),
        ]);
    }
    table
}

/// A value and its standard deviation: with the same decimals, which show two digits of the latter. Without one four
/// digits of the value.
fn with_std(value: Option<f64>, std: Option<f64>) -> [String; 2] {
    let value = value.unwrap_or(f64::NAN);
    match std.filter(|std| std.is_finite() && *std > 0.0 && value.is_finite()) {
        Some(std) => [value, std].map(|one| fixed(one, decimals_beside(std, 2))),
        None => [significant(value, 4), number(f64::NAN)],
    }
}

/// One quantity of all estimators over a run, the likelihood's with a band of two standard deviations, the
/// batch fit as a level. The first view shows five periods and all that converge, and a range about the batch fit: an estimate at its
/// start is not worth the scale.
fn over_time(
    run: &Run,
    chart: Chart,
    quantity: impl Fn(&Estimate) -> (f64, f64),
    level: impl Fn(&OffLine) -> f64,
    about: [f64; 2],
) -> Chart {
    let mut chart = chart;
    for (index, result) in run.on_line.iter().enumerate() {
        let time: Vec<f64> = result.history.iter().map(|e| e.time).collect();
        let values: Vec<(f64, f64)> = result.history.iter().map(&quantity).collect();
        let value: Vec<f64> = values.iter().map(|v| v.0).collect();
        if index == 0 {
            let low: Vec<f64> = values.iter().map(|v| v.0 - 2.0 * v.1).collect();
            let high: Vec<f64> = values.iter().map(|v| v.0 + 2.0 * v.1).collect();
            chart = chart.band(result.name, "± 2 std", &time, &low, &high);
        }
        chart = chart.series(result.name, &time, &value);
    }
    let begins = if run.is_free_decay {
        "decay begins"
    } else {
        "motion begins"
    };
    chart = chart.marker(run.counted_from, begins);
    let Some(batch) = run.batch() else {
        return chart;
    };
    let value = level(batch);
    let period = batch.mode.damped_period();
    let converged = run.on_line.iter().filter_map(|result| result.converged_at);
    let shown = converged.fold(run.counted_from + 4.0 * period, f64::max) + period;
    let until = shown.min(run.shown.until);
    chart
        .level(value, "batch fit")
        .x_range(run.counted_from, until)
        .y_range(
            about[0] * value,
            (about[1] * value).max(about[0] * value + 0.01),
        )
}

fn frequencies(run: &Run) -> Chart {
    let title = format!("Natural frequency, {}", words::shown(run));
    let chart = Chart::lines(title, "time", "s", "frequency", "Hz");
    over_time(
        run,
        chart,
        |e| (e.mode.hertz(), e.natural_frequency_std / TAU),
        |l| l.mode.hertz(),
        [0.75, 1.25],
    )
}

fn dampings(run: &Run) -> Chart {
    let title = format!("Damping ratio, {}", words::shown(run));
    let chart = Chart::lines(title, "time", "s", "damping ratio", "");
    let quantity = |e: &Estimate| (e.mode.damping_ratio(), e.damping_ratio_std);
    over_time(run, chart, quantity, |l| l.mode.damping_ratio(), [0.0, 2.0])
}

fn positions(findings: &Findings) -> Chart {
    let time: Vec<f64> = findings.series.samples.iter().map(|s| s.time).collect();
    let position: Vec<f64> = findings
        .series
        .samples
        .iter()
        .map(|s| s.motor_position.to_degrees())
        .collect();
    Chart::lines("Motor side", "time", "s", "position", "deg").series(
        "motor position",
        &time,
        &position,
    )
}

fn deformation(findings: &Findings) -> Chart {
    let samples = &findings.series.samples;
    let time: Vec<f64> = samples.iter().map(|s| s.time).collect();
    let (scale, unit) = match findings.series.lever_arm {
        Some(lever_arm) => (1e3 * lever_arm, "mm"),
        None => (1e3, "mrad"),
    };
    let values: Vec<f64> = samples.iter().map(|s| scale * s.deformation).collect();
    let mut chart = Chart::lines("Deformation", "time", "s", "deformation", unit).series(
        "deformation",
        &time,
        &values,
    );
    for run in &findings.found.free_decays {
        chart = chart.marker(run.stretch.from, "free decay");
    }
    chart
}

fn spectrum(findings: &Findings, run: &Run) -> Chart {
    let samples = run.shown.of(&findings.series.samples);
    let centre = run.batch().map_or(1.0, |line| line.mode.hertz());
    let grid: Vec<f64> = (1..=400).map(|k| centre * k as f64 / 100.0).collect();
    let angular: Vec<f64> = grid.iter().map(|f| f * TAU).collect();
    let amplitude: Vec<f64> = amplitude_spectrum(samples, &angular)
        .iter()
        .map(|a| 1e3 * a)
        .collect();
    Chart::lines(
        format!(
            "Fourier transform of the deformation, {}",
            words::shown(run)
        ),
        "frequency",
        "Hz",
        "amplitude",
        "mrad",
    )
    .series("spectrum", &grid, &amplitude)
}

fn by_amplitude(findings: &Findings) -> Option<Chart> {
    let dependence = findings.found.amplitude_dependence.as_ref()?;
    let mut cycles = dependence.cycles.clone();
    cycles.sort_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
    let amplitude: Vec<f64> = cycles.iter().map(|c| 1e3 * c.amplitude).collect();
    let xi: Vec<f64> = cycles.iter().map(|c| c.damping_ratio).collect();
    let edge = |sign: f64| -> Vec<f64> {
        cycles
            .iter()
            .map(|c| c.damping_ratio + sign * 2.0 * c.damping_ratio_std)
            .collect()
    };
    Some(
        Chart::lines(
            "Damping cycle by cycle",
            "amplitude",
            "mrad",
            "damping ratio",
            "",
        )
        .band("one cycle", "± 2 std", &amplitude, &edge(-1.0), &edge(1.0))
        .points("one cycle", &amplitude, &xi)
        .note("Each point is one period of the free decay. Band: two standard deviations."),
    )
}
