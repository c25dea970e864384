//! Where the mismatch sits: in the chain, in time, over a coordinate, in frequency.

use super::page::Case;
use super::shown::{Shown, peak};
use super::words;
use crate::diagnosis::{CoordinateTrace, Traces, Verdict};
use crate::effects::{PLACES, Place};
use crate::report::{Bars, Chain, Chart, Page};

/// Points of a scatter that are drawn at most.
const POINTS: usize = 2000;
/// Stretches of a coordinate over which the missing force is averaged.
const STRETCHES: usize = 24;
/// Samples that such an average needs.
const LEAST: usize = 4;

/// The machine as a row of stations, the place of the mismatch marked.
pub fn chain(page: Page, case: &Case) -> Page {
    let mut chain = Chain::new("Where it sits in the machine");
    let mut any = false;
    for (place, name) in PLACES {
        let why = why(case, name);
        let outside = matches!(place, Place::Base | Place::Environment);
        if outside && why.is_none() {
            continue;
        }
        chain = match outside {
            true => chain.beside(*name, words::place(name)),
            false => chain.station(*name, words::place(name)),
        };
        any |= why.is_some();
        if let Some(why) = why {
            chain = chain.marked(why);
        }
    }
    match any {
        true => page.chain(chain),
        false => page,
    }
}

/// What is said at a place, if the mismatch is there.
fn why(case: &Case, place: &str) -> Option<String> {
    let here = case
        .diagnosis
        .findings
        .iter()
        .filter(|finding| finding.place == place);
    let names: Vec<_> = here
        .map(|finding| words::list(&words::set(finding), "or"))
        .collect();
    if !names.is_empty() {
        return Some(words::capital(&words::list(&names, "and")));
    }
    let located = case.diagnosis.location.place.as_deref() == Some(place);
    let unknown = case.diagnosis.verdict == Verdict::Unexplained;
    (located && unknown).then(|| "something unknown".into())
}

/// The evidence.
pub fn section(page: Page, case: &Case) -> Page {
    let traces = case.traces;
    let charts = [
        missing(case),
        traces.coordinate.as_ref().and_then(scatter),
        spectrum(case),
    ];
    let bars = [
        phases(traces),
        traces.coordinate.as_ref().and_then(explained),
    ];
    if charts.iter().all(Option::is_none) && bars.iter().all(Option::is_none) {
        return page;
    }
    let [over_time, over_coordinate, spectrum] = charts;
    let [phases, explained] = bars;
    let mut page = page.heading("Where it was found");
    page = over_time.into_iter().fold(page, Page::chart);
    page = phases.into_iter().fold(page, Page::bars);
    page = over_coordinate.into_iter().fold(page, Page::chart);
    page = explained.into_iter().fold(page, Page::bars);
    spectrum.into_iter().fold(page, Page::chart)
}

/// What it is that is missing: a force, or where the sensor is at fault an error of its.
fn missing_name(case: &Case) -> &'static str {
    match case.diagnosis.location.place.as_deref() {
        Some("sensor") => "missing in the sensor",
        _ => "missing force",
    }
}

fn missing(case: &Case) -> Option<Chart> {
    let traces = case.traces;
    if traces.missing_time.is_empty() {
        return None;
    }
    let shown = Shown::of(&traces.missing_unit, peak(&traces.missing));
    let name = missing_name(case);
    let edge = |sign: f64| -> Vec<f64> {
        let pairs = traces.missing.iter().zip(&traces.missing_std);
        pairs
            .map(|(value, std)| (value + sign * 2.0 * std) * shown.factor)
            .collect()
    };
    let time = &traces.missing_time;
    let title = format!("{} over time", words::capital(name));
    let mut chart = Chart::lines(title, "time", "s", name, shown.unit.clone());
    if traces.missing_std.len() == traces.missing.len() {
        chart = chart.band(
            name,
            "± 2 standard deviations",
            time,
            &edge(-1.0),
            &edge(1.0),
        );
    }
    chart = chart.series(name, time, &shown.values(&traces.missing));
    for (index, &[from, to]) in case.diagnosis.location.times_s.iter().enumerate() {
        chart = chart.shade_x(from, to, if index == 0 { "strong here" } else { "" });
    }
    Some(chart.note(
        "What would have to act besides the model for it to move as recorded, estimated without \
         knowing what it is.",
    ))
}

/// The missing force over the coordinate that it follows best, and its mean.
fn scatter(trace: &CoordinateTrace) -> Option<Chart> {
    if trace.x.is_empty() {
        return None;
    }
    let (along, up) = (
        Shown::of(&trace.coordinate_unit, peak(&trace.x)),
        Shown::of(&trace.unit, peak(&trace.missing)),
    );
    let stride = trace.x.len().div_ceil(POINTS);
    let thin = |values: &[f64], shown: &Shown| -> Vec<f64> {
        values
            .iter()
            .step_by(stride)
            .map(|value| value * shown.factor)
            .collect()
    };
    let [x, low, mean, high] = averages(trace);
    let coordinate = words::effect(&trace.coordinate);
    let title = format!("The missing part over the {coordinate}");
    let chart = Chart::lines(
        title,
        coordinate,
        along.unit.clone(),
        "missing",
        up.unit.clone(),
    )
    .points(
        "missing force",
        &thin(&trace.x, &along),
        &thin(&trace.missing, &up),
    )
    .band(
        "mean",
        "± 1 standard deviation",
        &along.values(&x),
        &up.values(&low),
        &up.values(&high),
    )
    .series("mean", &along.values(&x), &up.values(&mean));
    Some(match stride {
        1 => chart,
        _ => chart.note(format!(
            "One sample in {stride} is drawn; the mean is over all."
        )),
    })
}

/// Stretches of equal width that hold samples: coordinate, and mean less, alone, plus one deviation.
fn averages(trace: &CoordinateTrace) -> [Vec<f64>; 4] {
    let pairs = trace.x.iter().copied().zip(trace.missing.iter().copied());
    let pairs: Vec<_> = pairs
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    let low = pairs
        .iter()
        .fold(f64::INFINITY, |low, pair| low.min(pair.0));
    let high = pairs
        .iter()
        .fold(f64::NEG_INFINITY, |high, pair| high.max(pair.0));
    let mut stretches = vec![Vec::new(); STRETCHES];
    for pair in pairs {
        let place = (pair.0 - low) / (high - low) * STRETCHES as f64;
        stretches[(place as usize).min(STRETCHES - 1)].push(pair);
    }
    let mut curves: [Vec<f64>; 4] = Default::default();
    for stretch in stretches.iter().filter(|stretch| stretch.len() >= LEAST) {
        let count = stretch.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| stretch.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let std = mean(&|pair| (pair.1 - y).powi(2)).sqrt();
        let values = [x, y - std, y, y + std];
        curves
            .iter_mut()
            .zip(values)
            .for_each(|(curve, value)| curve.push(value));
    }
    curves
}

fn explained(trace: &CoordinateTrace) -> Option<Bars> {
    let shares: Vec<_> = trace
        .explained
        .iter()
        .map(|(name, share)| (words::effect(name), *share))
        .collect();
    let best = words::effect(&trace.coordinate);
    let bars = percentages(
        "What it follows: share of the missing part that each coordinate explains",
        shares,
    )?;
    Some(
        bars.1
            .iter()
            .position(|name| *name == best)
            .into_iter()
            .fold(bars.0, Bars::marked),
    )
}

fn phases(traces: &Traces) -> Option<Bars> {
    let title = "When: share of the misfit above the noise in each phase of the motion";
    percentages(title, traces.phases.clone()).map(|bars| bars.0.marked(0))
}

/// Bars of shares, the largest first, and their names.
fn percentages(title: &str, mut shares: Vec<(String, f64)>) -> Option<(Bars, Vec<String>)> {
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (names, values): (Vec<String>, Vec<f64>) = shares.into_iter().unzip();
    let rounded = |share: &f64| (1000.0 * share).round() / 10.0;
    let values: Vec<_> = values.iter().map(rounded).collect();
    let bars = Bars::new(title, "%", names.clone()).series("share", &values);
    (!names.is_empty()).then_some((bars, names))
}

fn spectrum(case: &Case) -> Option<Chart> {
    let trace = &case.traces.spectrum;
    if trace.frequency.is_empty() {
        return None;
    }
    let unit = case
        .traces
        .outputs
        .first()
        .map_or("", |output| &output.unit);
    let shown = Shown::of(unit, peak(&trace.before));
    let names = super::motion::names(case);
    let title = "Spectrum of the misfit";
    let mut chart = Chart::lines(title, "frequency", "Hz", "amplitude", shown.unit.clone())
        .series(names.before, &trace.frequency, &shown.values(&trace.before))
        .x_log()
        .y_log();
    if case.has_after() {
        chart = chart.series(names.after, &trace.frequency, &shown.values(&trace.after));
    }
    Some(match case.diagnosis.location.frequency_hz {
        Some(frequency) => chart.marker(frequency, format!("{frequency:.2} Hz stands out")),
        None => chart,
    })
}
