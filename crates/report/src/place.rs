//! The place of the mismatch: in the chain, in time, over a coordinate, in frequency.

use super::case::Case;
use super::shares::percentages;
use super::shown::{Shown, peak};
use super::{follows, words};
use quell_diagnosis::{Finding, Traces, Verdict};
use quell_model::effects::{PLACES, Place};
use quell_page::{Bars, Chain, Chart, Page};

/// The machine as a row of stations, the place of the mismatch marked.
pub fn chain(page: Page, case: &Case) -> Page {
    let mut chain = Chain::new("Where it sits in the machine");
    let mut any = false;
    for (place, name) in PLACES {
        let (sure, perhaps) = (sure(case, name), perhaps(case, name));
        let outside = matches!(place, Place::Base | Place::Environment);
        let silent = sure.is_empty() && perhaps.is_none();
        if outside && silent {
            continue;
        }
        chain = match outside {
            true => chain.beside(*name, words::place(*place)),
            false => chain.station(*name, words::place(*place)),
        };
        any |= !silent;
        chain = sure.into_iter().fold(chain, Chain::marked);
        chain = perhaps.into_iter().fold(chain, Chain::perhaps);
    }
    match any {
        true => page.chain(chain),
        false => page,
    }
}

/// Effects that certainly act at a place.
fn sure(case: &Case, place: &str) -> Vec<String> {
    let findings = case.diagnosis.findings.iter();
    let here = findings.filter(|finding| finding.place == place && finding.is_certain());
    let mut sure: Vec<_> = here
        .map(|finding| words::capital(&case.title(&finding.effect)))
        .collect();
    let located = case.diagnosis.location.place.as_deref() == Some(place);
    if located && case.diagnosis.verdict == Verdict::Unexplained {
        sure.push("something unknown".into());
    }
    sure
}

/// Effects that may act at a place: uncertain findings and alternatives.
fn perhaps(case: &Case, place: &str) -> Option<String> {
    let findings = case.diagnosis.findings.iter();
    let doubtful = findings.filter(|finding| !finding.is_certain());
    let names = doubtful.flat_map(|finding| {
        let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
        names.filter(|name| sits(case, finding, name) == place)
    });
    let names: Vec<_> = names.map(|name| case.title(name)).collect();
    (!names.is_empty()).then(|| format!("perhaps {}", words::list(&names, "or")))
}

/// The place of a finding or of an alternative: that of the finding, if the catalogue allows it there.
fn sits<'a>(case: &Case, finding: &'a Finding, name: &str) -> &'a str {
    let first = name.split(" + ").next().unwrap_or(name);
    let places = case
        .catalogue
        .effect(first)
        .map_or(&[][..], |own| own.places);
    let allowed = places.iter().any(|own| own.name() == finding.place);
    match places.first() {
        Some(own) if !allowed => own.name(),
        _ => &finding.place,
    }
}

/// The evidence.
pub fn section(page: Page, case: &Case) -> Page {
    let traces = case.traces;
    let charts = [missing(case), follows::scatter(case), spectrum(case)];
    let bars = [
        phases(traces),
        traces.coordinate.as_ref().and_then(follows::explained),
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

/// How to read the missing part.
fn reading(case: &Case) -> &'static str {
    match case
        .diagnosis
        .findings
        .first()
        .map(|finding| finding.place.as_str())
    {
        Some("sensor") => {
            "What would have to act on the model for it to move as recorded. The estimate does not know the cause. Here \
             nothing acts: the sensor only makes it look so."
        }
        _ => {
            "What would have to act on the model for it to move as recorded. The estimate does not know the cause."
        }
    }
}

fn missing(case: &Case) -> Option<Chart> {
    let traces = case.traces;
    if traces.missing_time.is_empty() {
        return None;
    }
    let shown = Shown::of(&traces.missing_unit, peak(&traces.missing));
    let name = words::missing_name(&traces.missing_unit);
    let edge = |sign: f64| -> Vec<f64> {
        let pairs = traces.missing.iter().zip(&traces.missing_std);
        pairs
            .map(|(value, std)| (value + sign * 2.0 * std) * shown.factor)
            .collect()
    };
    let time = &traces.missing_time;
    let title = format!("{} over time", words::capital(name));
    let mut chart = Chart::lines(title, "time", "s", words::short(name), shown.unit.clone());
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
    Some(chart.note(reading(case)))
}

fn phases(traces: &Traces) -> Option<Bars> {
    let title = "When: share of the misfit above the noise in each phase of the motion";
    percentages(title, traces.phases.clone()).map(|bars| bars.0.marked(0))
}

fn spectrum(case: &Case) -> Option<Chart> {
    let trace = &case.traces.spectrum;
    if trace.frequency.is_empty() {
        return None;
    }
    let shown = case.misfit_unit();
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
