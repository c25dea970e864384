//! `quell diagnose` as a user types it, and its report for each verdict. The reports are written to
//! the target directory, to be looked at: `target/tmp/diagnose-named.html` and so on.

mod fixtures;

use quell::cli::diagnose::page::page;
use quell::diagnosis::Verdict;

/// Every verdict, its file, what its page must say, and what it must not.
const PAGES: &[(Verdict, &str, &[&str], &[&str])] = &[
    (
        Verdict::NoMismatch,
        "no-mismatch",
        &[
            "Nothing is missing",
            "class=\"verdict good\"",
            "2 explanations were tried",
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
            "9 explanations were fitted",
        ],
        &["after: with", "What the model lacks"],
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
