//! `quell diagnose` as a user types it, and its report for each verdict. The reports are written to
//! the target directory, to be looked at: `target/tmp/diagnose-named.html` and so on.

mod fixtures;
mod verb;

use quell::diagnosis::{Traces, Verdict};
use quell::report::page;

/// Every verdict, its file, what its page must say, and what it must not.
const PAGES: &[(Verdict, &str, &[&str], &[&str])] = &[
    (
        Verdict::NoMismatch,
        "no-mismatch",
        &[
            "Nothing is missing",
            "class=\"verdict good\"",
            "effects of the catalogue were held against",
        ],
        &["The ranking", "after: with", "class=\"chain\""],
    ),
    (
        Verdict::Named,
        "named",
        &[
            "5.84 \u{2192} 1.02",
            "0.2413",
            "0.2361 to 0.2468",
            "What to do:",
            "after: with Coulomb friction",
        ],
        &["What to do next"],
    ),
    (
        Verdict::Ambiguous,
        "ambiguous",
        &[
            "Coulomb friction or Stribeck friction",
            "What to do next",
            "peak speed",
        ],
        &["What the model lacks"],
    ),
    (
        Verdict::PartlyExplained,
        "partly-explained",
        &[
            "That is not all",
            "1.72 times the noise",
            "class=\"verdict bad\"",
        ],
        &[],
    ),
    (
        Verdict::Unexplained,
        "unexplained",
        &[
            "What was tried",
            "something unknown",
            "The whole catalogue was held against it",
        ],
        &["after: with", "What the model lacks"],
    ),
    (
        Verdict::NotExcited,
        "not-excited",
        &[
            "Record a move",
            "class=\"verdict bad\"",
            "Recorded and predicted",
        ],
        &[
            "class=\"verdict good\"",
            "What was looked for",
            "The ranking",
        ],
    ),
];

#[test]
fn each_verdict_has_its_page() {
    for (verdict, file, said, unsaid) in PAGES {
        let (diagnosis, traces) = fixtures::of(*verdict);
        let names = ["arm 7, morning".to_string(), "arm 7, noon".to_string()];
        let page = page(&diagnosis, &traces, "model.toml", &names);
        let path = format!("{}/diagnose-{file}.html", env!("CARGO_TARGET_TMPDIR"));
        page.write(path).unwrap();
        let html = page.render();
        assert!(html.contains(&diagnosis.summary), "{file}");
        for words in *said {
            assert!(html.contains(words), "{file}: {words}");
        }
        for words in *unsaid {
            assert!(!html.contains(words), "{file}: {words}");
        }
    }
}

#[test]
fn a_page_stands_without_series_and_with_long_ones() {
    for (verdict, ..) in PAGES {
        let (diagnosis, traces) = fixtures::of(*verdict);
        let empty = page(&diagnosis, &Traces::default(), "model.toml", &[]).render();
        assert!(empty.contains(&diagnosis.summary) && !empty.contains("NaN"));
        let long = page(&diagnosis, &repeated(traces, 30), "model.toml", &[]).render();
        assert!(long.contains("samples are drawn"));
        assert!(long.len() < 4_000_000, "{} bytes", long.len());
    }
}

/// The first output and the missing force as often one after the other.
fn repeated(mut traces: Traces, times: usize) -> Traces {
    let output = &mut traces.outputs[0];
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
