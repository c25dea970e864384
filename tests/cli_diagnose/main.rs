//! `quell diagnose` as a user types it, and its report and text of real diagnoses. The reports are written to the
//! target directory, to be looked at: `target/tmp/diagnose-damped.html` and so on.
//!
//! Which verdict a recording gets is not asked here, but where it cannot be another; what page and text owe to a
//! diagnosis is asked of each.

mod fixtures;
mod schema;
mod verb;

use fixtures::{Diagnosed, all};
use quell::diagnosis::{Diagnosis, Finding, FittedParameter, Traces, Verdict};
use quell::effects::EFFECTS;
use quell::report::{Case, Shown, page_of, text};

/// Every verdict, what its page must say, and what it must not.
const PAGES: &[(Verdict, &[&str], &[&str])] = &[
    (
        Verdict::NoMismatch,
        &["class=\"verdict good\"", "What was looked for"],
        &["The ranking", "after: with", "class=\"chain\""],
    ),
    (Verdict::Named, &["What it changes", "after: with"], &[]),
    (
        Verdict::Ambiguous,
        &["What it changes", "Its size"],
        &["class=\"verdict good\""],
    ),
    (
        Verdict::PartlyExplained,
        &["That is not all", "class=\"verdict bad\""],
        &[],
    ),
    (
        Verdict::Unexplained,
        &["What is known of it", "What the model misses"],
        &["after: with", "class=\"verdict good\""],
    ),
    (
        Verdict::NotExcited,
        &["Recorded and predicted", "class=\"verdict bad\""],
        &[
            "class=\"verdict good\"",
            "What was looked for",
            "The ranking",
        ],
    ),
];

fn reported<'a>(one: &'a Diagnosed, traces: &'a Traces) -> Case<'a> {
    Case {
        catalogue: one.catalogue,
        ..Case::new(&one.outcome.diagnosis, traces)
    }
}

/// All that a diagnosis says that page and text must both show.
fn owed(case: &Case) -> Vec<String> {
    let Diagnosis {
        summary,
        findings,
        next_move,
        ..
    } = case.diagnosis;
    let mut owed = vec![summary.clone()];
    owed.extend(next_move.iter().map(|next| next.why.clone()));
    for finding in findings {
        let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
        owed.extend(names.map(|name| case.catalogue.title(name)));
        match finding.learned() {
            None => owed.extend(finding.parameters.iter().flat_map(number_and_unit)),
            Some(learned) => {
                owed.push(learned.sentence.clone());
                let nearest = learned.nearest.iter();
                owed.extend(nearest.map(|nearest| case.catalogue.title(&nearest.effect)));
            }
        }
    }
    owed
}

/// A fitted number as it is shown, its interval, and the unit of both.
fn number_and_unit(parameter: &FittedParameter) -> [String; 3] {
    let shown = Shown::of(&parameter.unit, parameter.value);
    // What has a unit is not shown without; that of a number is 1.
    let is_number = matches!(parameter.unit.as_str(), "" | "1");
    assert_eq!(is_number, shown.unit.is_empty());
    let value = shown.quoted(parameter.value, parameter.ci95);
    [value, shown.interval(parameter.ci95), shown.unit]
}

#[test]
fn what_must_come_out_comes_out() {
    let verdict = |name: &str| {
        let one = all().iter().find(|one| one.name == name).unwrap();
        one.outcome.diagnosis.verdict
    };
    assert_eq!(verdict("clean"), Verdict::NoMismatch);
    let unlisted = all().iter().find(|one| one.name == "unlisted").unwrap();
    let learned = |finding: &Finding| finding.learned().is_some();
    assert!(
        unlisted.outcome.diagnosis.findings.iter().any(learned),
        "{:?}",
        unlisted.outcome.diagnosis
    );
    assert_eq!(verdict("rest"), Verdict::NotExcited);
    let with_findings = all()
        .iter()
        .filter(|one| !one.outcome.diagnosis.findings.is_empty());
    assert!(with_findings.count() >= 2);
}

#[test]
fn page_and_text_say_what_the_diagnosis_says() {
    for one in all() {
        let diagnosis = &one.outcome.diagnosis;
        let name = one.name;
        let case = reported(one, &one.outcome.traces);
        let names = ["arm 7, morning".to_string(), "arm 7, noon".to_string()];
        let page = page_of(&case, "model.toml", &names);
        let path = format!("{}/diagnose-{name}.html", env!("CARGO_TARGET_TMPDIR"));
        page.write(path).unwrap();
        let html = plain(&page.render());
        let text = text(&case, &["out/report.html".into()]);
        for words in owed(&case) {
            let capital = capital(&words);
            let shown = |place: &str| place.contains(&words) || place.contains(&capital);
            assert!(shown(&html), "{name}: no {words:?} on the page");
            assert!(shown(&text), "{name}: no {words:?} in {text}");
        }
        assert!(
            text.contains("out/report.html") && !text.contains("NaN"),
            "{text}"
        );
        for finding in &diagnosis.findings {
            let names = std::iter::once(&finding.effect).chain(&finding.alternatives);
            for name in names.filter(|name| EFFECTS.iter().any(|one| one.name == **name)) {
                let page = format!("<summary>{}: ", capital(&case.catalogue.title(name)));
                assert!(html.contains(&page), "no page of {name}");
            }
        }
        for words in names.iter().map(String::as_str).chain(["model.toml"]) {
            assert!(html.contains(words), "{name}: {words}");
        }
        let mut pages = PAGES.iter();
        let (_, said, unsaid) = pages.find(|page| page.0 == diagnosis.verdict).unwrap();
        for words in *said {
            assert!(html.contains(words), "{name}: {words}");
        }
        for words in *unsaid {
            assert!(!html.contains(words), "{name}: {words}");
        }
        let curves = diagnosis.findings.iter().filter_map(|f| f.curve.as_ref());
        for curve in curves {
            let title = format!("{} over the {}", curve.law, curve.coordinate);
            assert!(html.contains(&title), "{name}: {title}");
        }
        assert_eq!(
            html.contains("What to do next"),
            diagnosis.next_move.is_some(),
            "{name}"
        );
    }
}

/// A page as text has it: a number is not parted from its percent sign.
fn plain(html: &str) -> String {
    html.replace('\u{a0}', " ")
}

fn capital(words: &str) -> String {
    let (first, rest) = words.split_at(words.chars().next().map_or(0, char::len_utf8));
    first.to_uppercase() + rest
}

#[test]
fn a_page_stands_without_series_and_with_long_ones() {
    for one in all() {
        let (empty, long) = (Traces::default(), repeated(one.outcome.traces.clone()));
        let [empty, long] = [&empty, &long]
            .map(|traces| plain(&page_of(&reported(one, traces), "model.toml", &[]).render()));
        let summary = &one.outcome.diagnosis.summary;
        assert!(empty.contains(summary) && !empty.contains("NaN"));
        assert!(long.contains("samples are drawn"), "{}", one.name);
        assert!(long.len() < 4_000_000, "{}: {} bytes", one.name, long.len());
    }
}

/// The first output and the missing force one after the other, until there are more samples than are drawn.
fn repeated(mut traces: Traces) -> Traces {
    const SAMPLES: usize = 100_000;
    let output = &mut traces.outputs[0];
    let times = SAMPLES.div_ceil(output.time.len());
    let duration = output.time[output.time.len() - 1] + 0.003;
    let stamps = |time: &[f64]| -> Vec<f64> {
        let turn = |turn: usize| time.iter().map(move |t| t + duration * turn as f64);
        (0..times).flat_map(turn).collect()
    };
    (output.time, traces.missing_time) = (stamps(&output.time), stamps(&traces.missing_time));
    let values = [&mut output.recorded, &mut output.before, &mut output.after];
    for values in values
        .into_iter()
        .chain([&mut traces.missing, &mut traces.missing_std])
    {
        *values = values.repeat(times);
    }
    traces
}
