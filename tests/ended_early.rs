//! A search that is ended early. Its work is counted in the simulations of this process, so all is one test.

use quell::diagnosis::{Diagnosis, Options, Stop, Verdict, diagnose};
use quell::model::{Model, simulations};
use quell::proof::{Case, Kind, generate_kind};
use std::slice::from_ref;

/// The diagnosis of a case whose search is to end after so many simulations, and the number that was made in all.
fn diagnosed(case: &Case, most: u64) -> (Diagnosis, u64) {
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let before = simulations();
    let options = Options {
        enough: Stop::when(move || simulations() - before > most),
        ..Options::default()
    };
    let outcome = diagnose(&model, from_ref(&case.train), &[], &options, &|_, _| {}).unwrap();
    (outcome.diagnosis, simulations() - before)
}

/// Wherever the search is ended, the rest of the work is a small part of it, and what is found is not told as certain.
#[test]
fn what_follows_is_short_and_nothing_is_certain() {
    let case = generate_kind(Kind::Pair, 1, 0).unwrap();
    let (whole, all) = diagnosed(&case, u64::MAX);
    assert_eq!((whole.verdict, whole.ended_early), (Verdict::Named, false));
    let mut found = 0;
    for share in [0.0, 0.1, 0.2, 0.4, 0.6] {
        let most = (share * all as f64) as u64;
        let (early, made) = diagnosed(&case, most);
        let after = made.saturating_sub(most);
        println!("{share}: {after} of {all} after it, {:?}", early.verdict);
        // The explanations that are kept are fitted to their ends and judged, each with a Jacobian of ten unknowns.
        assert!(10 * after < all, "{after} of {all} after {most}");
        assert!(early.ended_early && early.verdict != Verdict::Named);
        assert!(
            early
                .summary
                .ends_with("; the search was ended before all was tried.")
        );
        assert!(early.next_move.is_none());
        for finding in &early.findings {
            found += 1;
            let numbers = finding.parameters.iter();
            assert!(
                numbers
                    .clone()
                    .all(|own| own.ci95[0] < own.ci95[1] && own.ci95[1].is_finite())
            );
        }
        let undrawn = |own: &String| own.contains("before the bootstrap");
        assert!(early.remarks.iter().any(undrawn), "{:?}", early.remarks);
    }
    assert!(found > 0);
}
