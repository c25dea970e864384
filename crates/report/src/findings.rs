//! The findings: each in plain words, and its parameters.

use super::case::Case;
use super::{atlas, happened, head, law, words};
use quell_diagnosis::{Finding, Verdict};
use quell_model::effects::Place;
use quell_page::{Page, Table, number};

/// Every finding with its meaning, its remedy, and its parameters.
pub fn section(page: Page, case: &Case) -> Page {
    let mut page = page;
    for finding in &case.diagnosis.findings {
        page = explained(page, case, finding);
    }
    let left = head::left(case);
    page = page.text(match case.diagnosis.verdict {
        Verdict::PartlyExplained => format!(
            "That is not all: what is left is {left}. It could be given to none of the effects that were tried."
        ),
        _ => format!("What is left on the held-out data: {left}."),
    });
    let alone = happened::left_alone(case);
    let alone = alone.map(|alone| format!("{}.", words::capital(&alone)));
    table(alone.into_iter().fold(page, Page::text), case)
}

/// The effects that the data cannot distinguish.
pub fn set(page: Page, case: &Case) -> Page {
    let mut page = page;
    for finding in &case.diagnosis.findings {
        if finding.alternatives.is_empty() {
            page = explained(page, case, finding);
            continue;
        }
        let names = words::list(&case.set(finding), "or");
        page = page.heading(format!("{}?", words::capital(&names)));
        let place = match sits_with_all(case, finding) {
            true => format!(" {}", words::at(&finding.place)),
            false => String::new(),
        };
        page = page.text(match case.may_be_absent(finding) {
            true => format!(
                "One of them may be missing{place}, or nothing; these recordings cannot tell which."
            ),
            false => format!("One of them is missing{place}; these recordings cannot tell which."),
        });
        page = page.table(one_of_them(case, finding));
        page = law::section(page, case, finding);
        page = atlas::pages(page, case, finding);
    }
    page.text(format!(
        "With {} what is left on the held-out data is {}.",
        case.findings(),
        head::left(case)
    ))
}

/// The possible effects of a finding as a table.
fn one_of_them(case: &Case, finding: &Finding) -> Table {
    let table = Table::new("What it may be")
        .text_column("explanation")
        .column("probability", "%")
        .text_column("what it is");
    let all = case.diagnosis.in_place(finding, case.catalogue);
    let table = all
        .effects
        .iter()
        .fold(table, |table, &(name, probability)| {
            let physics = case.physics(name).unwrap_or_default();
            table.row([
                words::capital(&case.title(name)).into(),
                words::percent(probability).into(),
                words::sentences(&physics, 1).into(),
            ])
        });
    match case.may_be_absent(finding) {
        true => table.row([
            "Nothing".into(),
            words::percent(all.nothing).into(),
            "The model does without it.".into(),
        ]),
        false => table,
    }
}

/// Whether all alternatives of a finding can act at its place.
fn sits_with_all(case: &Case, finding: &Finding) -> bool {
    let there = |name: &String| {
        let places = case.catalogue.effect(name);
        let places = places.map_or(&[][..], |effect| effect.places);
        places.iter().any(|place| place.name() == finding.place)
    };
    finding.alternatives.iter().all(there)
}

/// The parameters of the explanation that was written into the model.
pub fn parameters(page: Page, case: &Case) -> Page {
    let names = happened::in_model(&case.diagnosis.findings).map(|own| case.title(&own.effect));
    let names = match words::list(&names.collect::<Vec<_>>(), "and") {
        none if none.is_empty() => "none of them".into(),
        names => names,
    };
    let in_doubt = |own: &Finding| !own.alternatives.is_empty();
    let others = match case.diagnosis.findings.iter().any(in_doubt) {
        true => " The other explanations have sizes of their own.",
        false => "",
    };
    let page = page
        .heading("Its size")
        .text(format!("The model that was written has {names}.{others}",));
    table(page, case)
}

/// The known marks of a mismatch that has no name.
pub fn unknown(page: Page, case: &Case) -> Page {
    let location = &case.diagnosis.location;
    let mut page = page.heading("What is known of it");
    let mut known = Vec::new();
    if let Some(place) = location.place.as_deref().and_then(Place::from_name) {
        let what = words::place(place);
        known.push(format!("it sits in the {} ({what})", place.name()));
    }
    if !location.phases.is_empty() {
        known.push(format!(
            "it is strongest during {}",
            words::list(&location.phases, "and")
        ));
    }
    if let Some(coordinate) = &location.coordinate {
        known.push(format!("it follows the {}", words::plain(coordinate)));
    }
    if let Some(frequency) = location.frequency_hz {
        known.push(format!("it stands out at {} Hz", number(frequency)));
    }
    if !known.is_empty() {
        page = page.text(format!("{}.", words::capital(&words::list(&known, "and"))));
    }
    let look = location.place.as_deref().and_then(words::look);
    let tried = "The whole catalogue was compared with it, and the closest effects were fitted. None brings the \
                 misfit down to the noise on the held-out data. The model is as it was, with its own parameters \
                 refitted.";
    page = page.text(tried);
    match look {
        Some(look) => page.text(look),
        None => page,
    }
}

/// A finding under its name: physics, what to do, and the evidence.
fn explained(page: Page, case: &Case, finding: &Finding) -> Page {
    let name = finding.title(case.catalogue);
    let name = match finding.is_certain() {
        true => words::capital(&name),
        false => format!("Perhaps {name}"),
    };
    let page = page.heading(format!("{name}, {}", words::at(&finding.place)));
    let page = means(page, case, &finding.effect);
    let page = happened::of(finding).into_iter().fold(page, Page::text);
    let page = law::section(page, case, finding);
    let page = match finding.evidence.is_empty() {
        true => page,
        false => page.text(finding.evidence.clone()),
    };
    let page = match case.may_be_absent(finding) {
        true => page.text(format!(
            "These recordings do not decide whether it is there: its probability is {:.1} %.",
            100.0 * finding.probability
        )),
        false => page,
    };
    let page = match finding.alternatives.as_slice() {
        [] => page,
        others => {
            let others: Vec<_> = others.iter().map(|name| case.title(name)).collect();
            let others = words::list(&others, "or");
            page.text(format!("The data would allow {others} in its place."))
        }
    };
    atlas::pages(page, case, finding)
}

/// The physics in a sentence or two, and what to do.
fn means(page: Page, case: &Case, effect: &str) -> Page {
    let remedy = case.remedy(effect);
    let remedy = remedy.map(|remedy| format!("What to do: {remedy}"));
    let parts = [case.physics(effect), remedy];
    parts.into_iter().flatten().fold(page, Page::text)
}

fn table(page: Page, case: &Case) -> Page {
    let mut table = Table::new("Parameters")
        .text_column("parameter")
        .column("value", "")
        .column("95 % interval", "")
        .text_column("unit");
    let mut rows = 0;
    for finding in &case.diagnosis.findings {
        for parameter in words::numbers(finding) {
            let shown = case.shown(&finding.effect, parameter);
            rows += 1;
            table = table.row([
                format!(
                    "{}: {}",
                    words::capital(&case.title(&finding.effect)),
                    case.parameter(finding, &parameter.name)
                )
                .into(),
                shown.quoted(parameter.value, parameter.ci95).into(),
                shown.interval(parameter.ci95).into(),
                shown.unit.into(),
            ]);
        }
    }
    if let Some(told) = case.forces_told() {
        table = table.note(told);
    }
    match rows {
        0 => page,
        _ => page.table(table),
    }
}
