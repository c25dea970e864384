//! Pages and text of a law that was learned, and of a named one.

use super::law::lines;
use super::{Case, page_of, text};
use quell_diagnosis::{Diagnosis, Finding, Scored, Traces};

/// A learned spring that was visited to 2 mrad in both directions, with a nearest law that leaves its band in these
/// ranges.
fn finding(outside: &str) -> Finding {
    let text = format!(
        r#"{{
            "effect": "learned_spring", "place": "transmission", "probability": 0.998,
            "parameters": [{{"name": "y0", "value": 0.1, "unit": "N", "ci95": [0.0, 0.2]}}],
            "evidence": "", "alternatives": [],
            "curve": {{
                "law": "spring force", "unit": "N", "coordinate": "deformation", "coordinate_unit": "rad",
                "points": [-0.002, 0.0, 0.002], "values": [-8.0, 0.0, 8.0],
                "ci95": [[-9.0, -7.0], [-1.0, 1.0], [7.0, 9.0]],
                "learned": {{
                    "sentence": "The learned spring is odd.",
                    "nearest": {{
                        "effect": "cubic_stiffness",
                        "parameters": [{{"name": "k3", "value": 1e9, "unit": "1/rad^2"}}],
                        "values": [-7.5, 0.0, 7.5], "chi_squared": 0.9, "outside": {outside}
                    }}
                }}
            }}
        }}"#
    );
    serde_json::from_str(&text).unwrap()
}

fn with<T>(finding: &Finding, told: impl Fn(&Case) -> T) -> T {
    let text = r#"{
        "verdict": "named", "summary": "One.", "findings": [],
        "location": {"place": null, "phases": [], "times_s": [], "coordinate": null, "frequency_hz": null},
        "fit": {
            "noise_std": 1e-5, "unit": "rad",
            "before": {"train_rms": 4e-5, "held_out_rms": 5e-5, "held_out_over_noise": 5.0},
            "after": {"train_rms": 1e-5, "held_out_rms": 1.1e-5, "held_out_over_noise": 1.1}
        },
        "nuisances": {}, "next_move": null, "remarks": [],
        "candidates": [{
            "effect": "learned_spring", "place": "transmission", "log_evidence": 30723.36, "probability": 0.998,
            "held_out_ratio": 0.05
        }]
    }"#;
    let mut diagnosis: Diagnosis = serde_json::from_str(text).unwrap();
    diagnosis.findings = vec![finding.clone()];
    told(&Case::new(&diagnosis, &Traces::default()))
}

#[test]
fn a_learned_law_is_told_as_a_curve() {
    let finding = finding("[]");
    let (page, words) = with(&finding, |case| {
        let page = page_of(case, "model.toml", &[]).render();
        // A page keeps a number and its percent sign on one line.
        (page.replace('\u{a0}', " "), text(case, &[]))
    });
    for told in [&page, &words] {
        for words in [
            "The learned spring is odd.",
            "It is like cubic stiffness",
            "stays inside its 95 % band",
            "deformation is \u{2212}2 to 2 mrad; nothing is claimed outside of that",
            "11 urad rms, 1.10 times the noise",
        ] {
            assert!(told.contains(words), "{words}");
        }
        // No ordinate is told as a number.
        assert!(!told.contains("0.00 to 0.20"));
    }
    for words in [
        "Learned spring, like cubic stiffness, in the transmission",
        "Learned spring: spring force over the deformation",
        "nearest named law: cubic stiffness",
        "&gt; 99",
    ] {
        assert!(page.contains(words), "{words}");
    }
    // Only differences of the evidence say something.
    assert!(!page.contains("30723"));
}

#[test]
fn a_law_that_leaves_the_band_is_no_likeness() {
    let finding = finding("[[-0.002, -0.001], [0.0015, 0.0015]]");
    let lines = with(&finding, |case| lines(case, &finding)).join(" ");
    assert!(
        lines.contains("leaves it from \u{2212}2 to \u{2212}1 and at 1.5 mrad"),
        "{lines}"
    );
    let page = with(&finding, |case| page_of(case, "model.toml", &[]).render());
    assert!(page.contains("Learned spring, in the transmission"));
}

#[test]
fn a_named_law_has_a_picture_and_its_numbers() {
    let mut finding = finding("[]");
    finding.effect = "cubic_stiffness".into();
    finding.curve.as_mut().unwrap().learned = None;
    finding.parameters[0].name = "k3".into();
    let page = with(&finding, |case| {
        assert!(lines(case, &finding).is_empty());
        page_of(case, "model.toml", &[]).render()
    });
    assert!(page.contains("Cubic stiffness: spring force over the deformation"));
    assert!(page.contains("0.00 to 0.20") && !page.contains("nearest named law"));
    // What has no curve has no picture.
    finding.curve = None;
    let page = with(&finding, |case| page_of(case, "m", &[]).render());
    assert!(!page.contains("spring force over the deformation"));
}

#[test]
fn the_text_marks_what_is_uncertain_and_says_how_likely_each_is() {
    let mut finding = finding("[]");
    finding.effect = "cubic_stiffness".into();
    finding.curve = None;
    finding.parameters[0].name = "k3".into();
    let sure = with(&finding, |case| text(case, &[]));
    assert!(
        !sure.contains("perhaps") && !sure.contains("what it may be"),
        "{sure}"
    );
    // The candidate of the fixture is an alternative, with its probability.
    finding.alternatives = vec!["learned_spring".into()];
    let words = with(&finding, |case| text(case, &[]));
    let table = words.find("what it may be").expect("a table");
    let line = |name: &str| words[table..].lines().find(|line| line.starts_with(name));
    assert!(words.contains("perhaps cubic stiffness"), "{words}");
    assert!(
        line("learned spring").is_some_and(|line| line.ends_with("> 99 %")),
        "{words}"
    );
    assert!(
        line("cubic stiffness").is_some_and(|line| line.ends_with("< 1 %")),
        "{words}"
    );
}

#[test]
fn all_misfits_of_a_text_are_in_one_unit() {
    let score = |rms: f64| {
        serde_json::json!({
            "rms": rms, "unit": "rad", "noise_std": 1e-5, "rms_over_noise": 1e5 * rms, "fit_percent": 99.0,
            "samples": 100, "motion": 1e-3, "windows": 1, "first": null
        })
    };
    let scored = serde_json::json!([{
        "recording": "arm7", "held_out": false, "before": score(9.74e-5), "after": score(1.01e-5)
    }]);
    let scored: Vec<Scored> = serde_json::from_value(scored).unwrap();
    let [words, page] = with(&finding("[]"), |case| {
        let mut diagnosis = case.diagnosis.clone();
        diagnosis.fit.scores = scored.clone();
        let case = Case::new(&diagnosis, case.traces);
        [text(&case, &[]), page_of(&case, "model.toml", &[]).render()]
    });
    assert!(words.contains("noise: 10 urad"), "{words}");
    for told in [&words, &page] {
        assert!(told.contains("rms 97.4 urad, 9.74 times the noise of 10 urad"));
        assert!(told.contains("rms 10.1 urad, 1.01 times the noise of 10 urad"));
    }
}

#[test]
fn a_lesser_fit_of_the_same_effects_is_no_second_explanation() {
    let page = with(&finding("[]"), |case| {
        let mut diagnosis = case.diagnosis.clone();
        let mut lesser = diagnosis.candidates[0].clone();
        (lesser.log_evidence, lesser.probability) = (30693.0, 1e-13);
        diagnosis.candidates.push(lesser);
        page_of(&Case::new(&diagnosis, case.traces), "model.toml", &[]).render()
    });
    assert_eq!(page.matches("<tr class=\"marked\">").count(), 1);
    assert!(!page.contains("\u{2212}30.4"));
}

#[test]
fn a_law_at_another_place_is_another_explanation() {
    let page = with(&finding("[]"), |case| {
        let mut diagnosis = case.diagnosis.clone();
        let mut other = diagnosis.candidates[0].clone();
        other.place = "elsewhere".into();
        diagnosis.candidates.push(other);
        page_of(&Case::new(&diagnosis, case.traces), "model.toml", &[]).render()
    });
    assert!(page.contains("elsewhere"));
}

#[test]
fn what_may_stand_for_the_finding_is_not_as_firm() {
    let mut finding = finding("[]");
    finding.alternatives = vec!["cubic_stiffness".into()];
    let page = with(&finding, |case| {
        let mut diagnosis = case.diagnosis.clone();
        let mut second = diagnosis.candidates[0].clone();
        second.effect = "cubic_stiffness".into();
        (second.log_evidence, second.probability) = (30720.0, 0.04);
        diagnosis.candidates.push(second);
        page_of(&Case::new(&diagnosis, case.traces), "model.toml", &[]).render()
    });
    let rows = |class: &str| page.matches(&format!("<tr class=\"{class}\">")).count();
    assert_eq!([rows("marked"), rows("perhaps")], [1, 1]);
    assert!(page.contains("the data do not exclude it"));
}
