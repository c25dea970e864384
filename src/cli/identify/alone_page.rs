//! The page of an output-only identification: modes, spectrum, residuals of the shapers, the recording.

use super::alone::{self, Alone};
use super::printer::{self, Tuned};
use crate::identification::output_only::{Excitation, FoundMode, Taken, density};
use crate::page::{Chart, Figure, Page, Table, Verdict, decimals_beside, fixed};
use quell_shapers::residual_vibration;

const TAU: f64 = core::f64::consts::TAU;
/// Relative width of a band in the drawn spectrum, and points of a drawn response.
const DRAWN: f64 = 0.01;
const POINTS: usize = 300;

/// The whole page.
pub fn page(all: &[Alone], tuned: &[Tuned]) -> Page {
    let names: Vec<_> = all.iter().map(|one| one.recording.as_str()).collect();
    let mut page = Page::new(format!("Vibration of {}", names.join(", ")));
    if let Some(first) = all.first()
        && let Some(mode) = first.found.modes.first()
    {
        let of_axis = |axis: &Tuned| {
            let setting = &axis.settings[axis.best];
            format!(
                "Axis {}: {} at {:.1} Hz leaves {:.1} %.",
                axis.axis,
                setting.shaper.name(),
                setting.mode.hertz(),
                100.0 * setting.residual
            )
        };
        let sentence = match &first.advice {
            _ if !tuned.is_empty() => tuned.iter().map(of_axis).collect::<Vec<_>>().join(" "),
            Some(advice) => format!("Recommended shaper: {}", first.recommended(advice)),
            None => "No shaper can be designed for these modes.".into(),
        };
        let [[hertz, std], [ratio, of_ratio]] = quoted(mode);
        let of_several = match first.found.modes.len() {
            1 => String::new(),
            count => format!(", mode 1 of {count}"),
        };
        page = page
            .verdict(Verdict::Good, sentence)
            .figure(
                Figure::text(format!("natural frequency{of_several}"), hertz)
                    .unit("Hz")
                    .note(format!("\u{b1} {std} (one standard deviation)")),
            )
            .figure(
                Figure::text(format!("damping ratio{of_several}"), ratio)
                    .note(format!("\u{b1} {of_ratio}")),
            );
    }
    for one in all {
        page = page.heading(one.recording.clone()).table(modes(one));
        for remark in one.remarks() {
            page = page.text(remark);
        }
        let axis = tuned
            .iter()
            .find(|axis| one.printer.is_some_and(|own| own.axis == axis.axis));
        page = page.chart(spectrum(one, axis));
        if let Some(axis) = axis {
            page = page.chart(responses(one, axis));
        }
        page = page.chart(over_time(one));
    }
    for axis in tuned {
        page = page.table(shapers(axis));
    }
    if !tuned.is_empty() {
        page = page.heading("Lines to paste");
        for line in printer::lines(tuned)
            .lines()
            .filter(|line| !line.is_empty())
        {
            page = page.text(line);
        }
    }
    page
}

/// Frequency, Hz, and damping ratio of a mode, each with its standard deviation, to two digits of that.
fn quoted(mode: &FoundMode) -> [[String; 2]; 2] {
    let known = &mode.known;
    let hertz = [known.mode.hertz(), known.natural_frequency_std / TAU];
    let ratio = [known.mode.damping_ratio(), known.damping_ratio_std];
    [hertz, ratio].map(|own| own.map(|value| fixed(value, decimals_beside(own[1], 2))))
}

fn modes(one: &Alone) -> Table {
    let mut table = Table::new("Modes")
        .text_column("mode")
        .column("frequency", "Hz")
        .column("std", "Hz")
        .column("damping ratio", "")
        .column("std", "")
        .column("amplitude", "%");
    for (k, mode) in one.found.modes.iter().enumerate() {
        let [[hertz, std], [ratio, of_ratio]] = quoted(mode);
        table = table.row([
            format!("{}", k + 1).into(),
            hertz.into(),
            std.into(),
            ratio.into(),
            of_ratio.into(),
            (100.0 * mode.share).into(),
        ]);
    }
    table.note("Amplitude: of the strongest mode's.")
}

/// Frequencies that are drawn, Hz.
fn band(one: &Alone) -> [f64; 2] {
    let hertz = |mode: &FoundMode| mode.known.mode.hertz();
    let lowest = one
        .found
        .modes
        .iter()
        .map(hertz)
        .fold(f64::INFINITY, f64::min);
    let highest = one.found.modes.iter().map(hertz).fold(0.0, f64::max);
    match one.printer {
        Some(_) => [5.0, 200.0_f64.min(0.45 * one.vibration.rate)],
        None => [0.2 * lowest, (4.0 * highest).min(0.45 * one.vibration.rate)],
    }
}

/// The spectrum, before and after the recommended shaper.
fn spectrum(one: &Alone, axis: Option<&Tuned>) -> Chart {
    let density = density(&one.vibration, band(one), DRAWN, Taken::Tapered);
    let unit = format!("({})^2/Hz", one.vibration.unit);
    let mut chart = Chart::lines("Spectrum", "frequency", "Hz", "power density", unit)
        .series("recorded", &density.frequency, &density.power)
        .y_log();
    if let Some(setting) = axis.and_then(|axis| axis.settings.get(axis.best)) {
        let ratio = setting.mode.damping_ratio();
        let left = density.frequency.iter().zip(&density.power);
        let after: Vec<f64> = left
            .map(|(f, p)| p * residual_vibration(&setting.train, TAU * f, ratio).powi(2))
            .collect();
        chart = chart.series(
            format!("with {}", setting.shaper.name()),
            &density.frequency,
            &after,
        );
    }
    for mode in &one.found.modes {
        chart = chart.marker(
            mode.known.mode.hertz(),
            format!("{:.1} Hz", mode.known.mode.hertz()),
        );
    }
    chart
}

/// The residual of each shaper, over frequency.
fn responses(one: &Alone, axis: &Tuned) -> Chart {
    let [from, to] = band(one);
    let hertz: Vec<f64> = (0..=POINTS)
        .map(|k| from + (to - from) * k as f64 / POINTS as f64)
        .collect();
    let mut chart = Chart::lines(
        "What the shapers leave",
        "frequency",
        "Hz",
        "vibration that is left",
        "",
    );
    for (k, setting) in axis.settings.iter().enumerate() {
        let ratio = setting.mode.damping_ratio();
        let left: Vec<f64> = hertz
            .iter()
            .map(|f| residual_vibration(&setting.train, TAU * f, ratio))
            .collect();
        let name = format!("{} {:.1} Hz", setting.shaper.name(), setting.mode.hertz());
        chart = match k == axis.best {
            true => chart.broad(name + ", recommended", &hertz, &left),
            false => chart.series(name, &hertz, &left),
        };
    }
    chart.level(alone::ACCEPTABLE, "acceptable")
}

fn shapers(axis: &Tuned) -> Table {
    let mut table = Table::new(format!("Shapers of axis {}", axis.axis))
        .text_column("shaper")
        .column("frequency", "Hz")
        .column("vibration that is left", "%")
        .column("smoothing", "mm")
        .column("greatest acceleration", "mm/s^2");
    for (k, one) in axis.settings.iter().enumerate() {
        table = table.row([
            one.shaper.name().into(),
            one.mode.hertz().into(),
            (100.0 * one.residual).into(),
            one.smoothing.into(),
            (100.0 * (one.acceleration / 100.0).round()).into(),
        ]);
        if k == axis.best {
            table = table.marked();
        }
    }
    table.note("Smoothing: how far a corner is rounded at 5000 mm/s^2 and 5 mm/s. The greatest acceleration rounds it by 0.12 mm.")
}

/// The vibration over time.
fn over_time(one: &Alone) -> Chart {
    let samples = one.vibration.axes[0].len();
    let time: Vec<f64> = (0..samples)
        .map(|sample| one.vibration.time(sample))
        .collect();
    let mut chart = Chart::lines(
        "The recording",
        "time",
        "s",
        one.vibration.role.name(),
        one.vibration.unit.clone(),
    );
    for (axis, name) in one.vibration.axes.iter().zip(&one.axes) {
        chart = chart.series(*name, &time, axis);
    }
    for [from, until] in &one.found.stretches {
        if one.found.excitation == Excitation::Decay {
            chart = chart.shade_x(*from, *until, "decay");
        }
    }
    chart
}
