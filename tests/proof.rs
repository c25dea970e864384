//! The generator of concealed cases and the score: repeatable, whole, and counting rightly.

#[path = "absent/python.rs"]
mod python;
#[path = "absent/skipped.rs"]
mod skipped;

use python::python;
use quell::model::Model;
use quell::proof::families::{OUTSIDE, family};
use quell::proof::slots::{is_learned_in_slot_of, slots};
use quell::proof::{
    Case, Claim, FindingSummary, HiddenEffect, Judged, Kind, ParameterSummary, Rate, Source, Truth,
    Verdict, generate, generate_kind, our_name, read_cases, read_truths, run, write_cases,
};
use quell::recording::{Recording, Role};
use serde_json::json;
use std::path::Path;
use tempfile::TempDir;

const SEED: u64 = 7;

fn cases(count: u64) -> Vec<Case> {
    (0..count)
        .map(|index| generate(SEED, index).unwrap())
        .collect()
}

fn bytes(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(bytes(&path));
        } else {
            let name = path.file_name().unwrap().to_str().unwrap();
            files.push((name.to_string(), std::fs::read(&path).unwrap()));
        }
    }
    files.sort();
    files
}

#[test]
fn the_same_seed_gives_the_same_bytes() {
    let [first, second] = [(); 2].map(|()| {
        let folder = TempDir::new().unwrap();
        write_cases(folder.path(), &cases(4)).unwrap();
        bytes(folder.path())
    });
    assert_eq!(first.len(), 4 * 7 + 1);
    assert!(first == second);
}

#[test]
fn recordings_are_whole_and_the_true_machine_leaves_the_noise() {
    for (index, case) in cases(16).iter().enumerate() {
        for recording in [&case.train, &case.test] {
            for channel in &recording.channels {
                assert!(channel.time.len() > 200, "case {index}");
                assert!(channel.time.windows(2).all(|pair| pair[1] > pair[0]));
                assert!(
                    channel
                        .columns
                        .iter()
                        .flatten()
                        .all(|value| value.is_finite())
                );
            }
        }
        assert!(case.train.channel(Role::MotorPosition).is_some());
        assert_ne!(case.train.channels, case.test.channels);
        let model: toml::Table = case.model.parse().unwrap();
        assert!(["flexible_joint", "rigid_axis"].contains(&model["kind"].as_str().unwrap()));
        // The standard deviation of a sample of 800 or more is known to 2.5 %; coloured noise counts a
        // third to a tenth of its samples, and rounding a rest always to the same side leaves less.
        let floor = case.oracle();
        let least = if case.truth.more["noise_colour"] == json!("quantised") {
            0.7
        } else {
            0.85
        };
        assert!(floor > least && floor < 1.15, "case {index}: {floor}");
    }
}

/// Small cases of each kind: what is asked for is hidden, and shows.
#[test]
fn every_kind_hides_what_it_says() {
    for kind in Kind::ALL {
        for index in 0..if kind.effects() > 3 { 1 } else { 2 } {
            let case = generate_kind(kind, SEED, index).unwrap();
            let truth = &case.truth;
            assert_eq!(
                (Kind::of(truth), truth.effects.len()),
                (kind, kind.effects())
            );
            let families: Vec<&str> = truth.effects.iter().map(|e| family(&e.effect)).collect();
            let once = |name: &&str| families.iter().filter(|other| *other == name).count() == 1;
            assert!(families.iter().all(once), "{}", truth.name());
            // Outside the catalogue is outside all families, whatever the shape of a named law.
            let outside = families.contains(&OUTSIDE);
            assert_eq!(outside, kind == Kind::Outside, "{}", truth.name());
            let shaped = truth.more.get("shape").is_some();
            assert_eq!(shaped, kind == Kind::Shaped, "{}", truth.name());
            // The residual that is left when nothing but the nominal structure is fitted.
            let least = if kind == Kind::Clean { 0.95 } else { 1.05 };
            let residual = truth.baseline_residual_over_noise;
            assert!(
                residual.is_none_or(|residual| residual >= least),
                "{truth:?}"
            );
            let floor = case.oracle();
            assert!(floor > 0.7 && floor < 1.15, "{kind:?} {index}: {floor}");
        }
    }
}

#[test]
fn a_kind_and_a_seed_give_the_same_case() {
    for kind in [Kind::Triple, Kind::Outside, Kind::Shaped] {
        let [first, second] = [(); 2].map(|()| generate_kind(kind, SEED, 1).unwrap());
        assert_eq!((first.train, first.test), (second.train, second.test));
        assert_eq!(first.truth, second.truth);
        let other = generate_kind(kind, SEED + 1, 1).unwrap();
        assert_ne!(first.model, other.model);
    }
}

#[test]
fn kinds_are_known_by_their_names() {
    for kind in Kind::ALL {
        assert_eq!(kind.name().parse::<Kind>().unwrap(), kind);
    }
    let error = "quad".parse::<Kind>().unwrap_err().to_string();
    assert!(
        error.contains("\"quad\"") && error.contains("triple"),
        "{error}"
    );
}

/// The truth in words: the reader of JSON may miss a number's last bit.
fn told(truth: &Truth) -> String {
    let figure = |value: Option<f64>| value.map(|value| format!("{value:.12e}"));
    let parameters = truth.effects.iter().flat_map(|effect| &effect.parameters);
    let parameters: Vec<_> = parameters
        .map(|(name, value)| format!("{name} {value:.12e}"))
        .collect();
    let places: Vec<_> = truth.effects.iter().map(|effect| &effect.place).collect();
    let figures = [
        truth.natural_frequency_hz,
        truth.damping_ratio,
        Some(truth.noise),
        truth.clock_offset_s,
        truth.baseline_residual_over_noise,
    ];
    let (known, unit) = (truth.in_catalogue, &truth.noise_unit);
    let (name, figures) = (truth.name(), figures.map(figure));
    format!("{name} {places:?} {known} {unit} {figures:?} {parameters:?}")
}

#[test]
fn a_folder_is_read_back_as_it_was_written() {
    let folder = TempDir::new().unwrap();
    let cases = cases(6);
    let written = write_cases(folder.path(), &cases).unwrap();
    assert_eq!(read_cases(folder.path()).unwrap(), written);
    let truths = read_truths(folder.path()).unwrap();
    for (sealed, case) in written.iter().zip(&cases) {
        assert_eq!(told(&truths[&sealed.name]), told(&case.truth));
        let train = Recording::from_path(&sealed.train).unwrap();
        assert_eq!(train.channels, case.train.channels);
        assert_eq!(train.name, format!("{}/train", sealed.name));
    }
}

#[test]
fn other_generators_truths_are_read() {
    let folder = TempDir::new().unwrap();
    let text = r#"{
        "case-00": {"effect": "none", "parameters": {}, "programme": "train"},
        "case-01": {"effect": "coulomb_friction+hardening_stiffness",
                    "parameters": {"friction_nm": 13.1, "k3": 2e5}, "tracker_noise_m": 1e-5},
        "case-02": {"effect": "root_speed_friction", "parameters": {"c": 342.5}}
    }"#;
    std::fs::write(folder.path().join("truth.json"), text).unwrap();
    let truths = read_truths(folder.path()).unwrap();
    assert!(truths["case-00"].effects.is_empty() && truths["case-00"].in_catalogue);
    assert_eq!(truths["case-01"].name(), "coulomb_friction+cubic_stiffness");
    assert_eq!(truths["case-01"].noise, 1e-5);
    assert!(!truths["case-02"].in_catalogue);
    assert_eq!(our_name("base_compliance"), "base_mode");
    std::fs::write(folder.path().join("truth.json"), r#"{"case-00": {}}"#).unwrap();
    let error = read_truths(folder.path()).unwrap_err().to_string();
    assert!(
        error.contains("case-00") && error.contains("truth.json"),
        "{error}"
    );
}

/// MuJoCo beside integrations of its own laws that share no code with it.
#[test]
fn the_generator_in_mujoco_agrees_with_other_integrations() {
    if let Some(said) = python("mujoco", "requirements.txt", &["check.py".as_ref()]) {
        println!("{}", String::from_utf8_lossy(&said));
    }
}

#[test]
fn cases_of_mujoco_are_read() {
    let folder = TempDir::new().unwrap();
    let options = ["--cases", "2", "--seed", "1"].map(AsRef::as_ref);
    let script = ["generate.py".as_ref(), folder.path().as_os_str()];
    let script = [script.as_slice(), &options].concat();
    if python("mujoco", "requirements.txt", &script).is_none() {
        return;
    }
    let truths = read_truths(folder.path()).unwrap();
    let cases = read_cases(folder.path()).unwrap();
    assert_eq!((cases.len(), truths.len()), (2, 2));
    for case in cases {
        assert!(truths.contains_key(&case.name));
        Model::from_path(&case.model).unwrap();
        for recording in [&case.train, &case.test] {
            let recording = Recording::from_path(recording).unwrap();
            assert!(recording.channel(Role::MotorPosition).is_some());
        }
    }
}

fn truth(names: &[&str], in_catalogue: bool) -> Truth {
    let effect = |name: &&str| HiddenEffect {
        effect: name.to_string(),
        place: "transmission".into(),
        parameters: vec![("friction".into(), 1e-4)],
    };
    Truth {
        effects: names.iter().map(effect).collect(),
        in_catalogue,
        ..Truth::default()
    }
}

fn verdict(kind: &str, sets: &[&[&str]]) -> Verdict {
    let finding = |set: &&[&str]| FindingSummary {
        effect: set[0].into(),
        place: "transmission".into(),
        alternatives: set[1..].iter().map(|name| name.to_string()).collect(),
        parameters: vec![ParameterSummary {
            name: "friction".into(),
            value: 1.1e-4,
            ci95: [0.9e-4, 1.3e-4],
        }],
    };
    Verdict {
        kind: kind.into(),
        findings: sets.iter().map(finding).collect(),
        claims: Vec::new(),
        before_over_noise: 4.0,
        after_over_noise: 1.02,
        test_rms_over_noise: 1.05,
        seconds: 0.5,
    }
}

fn judged(hidden: &[&str], in_catalogue: bool, said: Verdict) -> Judged {
    Judged::new("case".into(), truth(hidden, in_catalogue), said, Some(1.0))
}

fn hand_made() -> Vec<Judged> {
    vec![
        judged(&[], true, verdict("no_mismatch", &[])),
        judged(&[], true, verdict("named", &[&["backlash"]])),
        judged(
            &["coulomb_friction"],
            true,
            verdict("named", &[&["coulomb_friction"]]),
        ),
        judged(
            &["stribeck_friction"],
            true,
            verdict("ambiguous", &[&["coulomb_friction", "stribeck_friction"]]),
        ),
        judged(
            &["backlash"],
            true,
            verdict("named", &[&["sensor_lag"], &["backlash"]]),
        ),
        judged(&["sensor_gain"], true, verdict("no_mismatch", &[])),
        judged(
            &["backlash", "sensor_lag"],
            true,
            verdict("named", &[&["sensor_delay"], &["backlash"]]),
        ),
        judged(
            &["backlash", "sensor_lag"],
            true,
            verdict("named", &[&["backlash"]]),
        ),
        judged(
            &["parametric_stiffness"],
            false,
            verdict("unexplained", &[]),
        ),
        judged(
            &["parametric_stiffness"],
            false,
            verdict("named", &[&["second_mode"]]),
        ),
    ]
}

#[test]
fn the_score_counts_as_one_would_by_hand() {
    let score = quell::proof::Score { cases: hand_made() };
    let rate = |key: &str| {
        let line = score
            .lines()
            .into_iter()
            .find(|line| line.key == key)
            .unwrap();
        (line.rate.right, line.rate.of)
    };
    assert_eq!(rate("detected"), (5, 6));
    // A wrong first name is not made good by a right second one.
    assert_eq!(rate("family"), (2, 3));
    assert_eq!(rate("exact"), (1, 3));
    assert_eq!(rate("in_set"), (2, 3));
    // A knock in a clean case, a lag beside the backlash; of the lag's family a delay is not spurious.
    assert_eq!(rate("spurious"), (2, 8));
    assert_eq!(rate("two_families"), (1, 2));
    assert_eq!(rate("false_alarms"), (1, 2));
    assert_eq!(rate("outside_noticed"), (2, 2));
    assert_eq!(rate("outside_flagged"), (1, 2));
    // Only where the name is right: the Coulomb friction of the third case.
    assert_eq!(rate("coverage"), (1, 1));
    assert_eq!(rate("outside_learned"), (0, 2));
    assert_eq!(score.set_sizes().mean, 4.0 / 3.0);
    assert_eq!(score.cases[9].judgement.kind, Kind::Outside);
    let confusion = score.confusion();
    assert_eq!(confusion["dry friction"]["dry friction"], 2);
    assert_eq!(confusion["play"]["sensor dynamics"], 1);
    assert_eq!(confusion["outside"]["unexplained"], 1);
}

/// Three effects, laws that were learned, and a shape: kind by kind as one counts by hand.
fn of_many_kinds() -> Vec<Judged> {
    let three = ["backlash", "sensor_lag", "cubic_stiffness"];
    let mut shaped = truth(&["coulomb_friction"], true);
    shaped.more.insert("kind".into(), json!("shaped"));
    let said = verdict("named", &[&["learned_friction"], &["external_disturbance"]]);
    vec![
        judged(
            &three,
            true,
            verdict(
                "named",
                &[&["sensor_lag"], &["backlash"], &["bilinear_stiffness"]],
            ),
        ),
        // The spring was learned, the drag is not there.
        judged(
            &three,
            true,
            verdict(
                "named",
                &[&["backlash"], &["learned_spring"], &["viscous_drag"]],
            ),
        ),
        Judged::new("case".into(), shaped, said, Some(1.0)),
        judged(
            &["detent"],
            false,
            verdict("named", &[&["learned_position_force"]]),
        ),
        judged(&["detent"], false, verdict("named", &[&["learned_spring"]])),
        judged(
            &["detent"],
            false,
            verdict("ambiguous", &[&["gravity_load"]]),
        ),
    ]
}

#[test]
fn the_score_counts_kind_by_kind() {
    let score = quell::proof::Score {
        cases: of_many_kinds(),
    };
    let kinds = score.by_kind();
    let names: Vec<&str> = kinds.iter().map(|score| score.kind.name()).collect();
    assert_eq!(names, ["triple", "shaped", "outside"]);
    let counts = |rate: Rate| (rate.right, rate.of);
    let [triple, shaped, outside] = [&kinds[0], &kinds[1], &kinds[2]];
    assert_eq!(counts(triple.all_families), (1, 2));
    assert_eq!(counts(triple.families), (4, 6));
    assert_eq!(counts(triple.by_slot), (1, 6));
    assert_eq!(counts(triple.spurious), (1, 6));
    assert_eq!(counts(triple.spurious_cases), (1, 2));
    assert_eq!(counts(triple.right), (1, 2));
    assert_eq!(counts(shaped.families), (0, 1));
    assert_eq!(counts(shaped.by_slot), (1, 1));
    assert_eq!(counts(shaped.spurious), (1, 2));
    // Learned in its slot, or doubted.
    assert_eq!(counts(outside.right), (2, 3));
    assert_eq!(counts(outside.spurious), (2, 3));
    assert_eq!(outside.all_families.of, 0);
    let value = score.to_json();
    assert_eq!(value["kinds"]["triple"]["by_slot"]["right"], json!(1));
    assert_eq!(value["rates"]["outside_learned"]["right"], json!(1));
}

/// Every law that is hidden outside the catalogue says where a curve could show it.
#[test]
fn laws_outside_the_catalogue_have_slots() {
    for index in 0..24 {
        let case = generate_kind(Kind::Outside, SEED, index).unwrap();
        let law = &case.truth.effects[0].effect;
        assert!(!slots(law).is_empty(), "{law}");
    }
    assert!(is_learned_in_slot_of("maxwell_slip", "coulomb_friction"));
    assert!(!is_learned_in_slot_of("cogging", "detent"));
}

/// A campaign in shares: what is read back and joined counts as if it had been run at once.
#[test]
fn shares_that_are_joined_count_as_one_run() {
    let whole: Vec<Judged> = hand_made().into_iter().chain(of_many_kinds()).collect();
    let mut failed = judged(&["backlash"], true, Verdict::failed(0.1));
    failed.oracle = None;
    let shares = [hand_made(), of_many_kinds(), vec![failed.clone()]];
    let read = shares.map(|cases| {
        let text = quell::proof::Score { cases }.to_json().to_string();
        quell::proof::Score::from_json(&text).unwrap()
    });
    let joined = quell::proof::Score::joined(read);
    let cases = whole.into_iter().chain([failed]).collect();
    let whole = quell::proof::Score { cases };
    for key in ["rates", "figures", "kinds", "reliability", "confusion"] {
        assert_eq!(joined.to_json()[key], whole.to_json()[key], "{key}");
    }
    assert_eq!(joined.cases[0].name, "1/case");
    let error = |text| {
        quell::proof::Score::from_json(text)
            .unwrap_err()
            .to_string()
    };
    assert!(error("{}").contains("each"), "{}", error("{}"));
    let untold = error(
        r#"{"each": [{"case": "a", "truth": {}, "verdict": {"kind": "named", "findings": [],
        "before_over_noise": 1, "after_over_noise": 1, "test_rms_over_noise": null, "seconds": 0}}]}"#,
    );
    assert!(untold.contains("case a"), "{untold}");
}

fn claims(hidden: &[&str], said: &[(&str, f64)]) -> Judged {
    let claim = |(effect, probability): &(&str, f64)| Claim {
        effect: effect.to_string(),
        probability: *probability,
    };
    let claims = said.iter().map(claim).collect();
    judged(
        hidden,
        true,
        Verdict {
            claims,
            ..verdict("named", &[])
        },
    )
}

#[test]
fn claims_fall_into_bins_and_are_judged_by_the_truth() {
    let mut cases: Vec<Judged> = (0..19)
        .map(|_| claims(&["backlash"], &[("backlash", 0.9), ("stiction", 0.94)]))
        .collect();
    cases.push(claims(
        &["backlash"],
        &[("sensor_lag", 0.92), ("end_stop", 1.0)],
    ));
    cases.push(claims(
        &["cubic_stiffness"],
        &[("learned_spring", 0.3), ("cogging", f64::NAN)],
    ));
    let bins = quell::proof::Score { cases }.reliability();
    let ranges: Vec<String> = bins.iter().map(|bin| bin.range()).collect();
    assert_eq!(ranges, ["30-40 %", "90-95 %", "99-100 %"]);
    assert_eq!(
        (bins[0].so.right, bins[0].so.of, bins[0].is_reliable()),
        (1, 1, None)
    );
    assert_eq!((bins[1].so.right, bins[1].so.of), (38, 39));
    // (19 x 0.90 + 19 x 0.94 + 0.92) / 39, and 38 of 39 are 97.4 %: 5.4 points apart.
    assert!((bins[1].said - 92.0).abs() < 1e-9);
    assert_eq!(bins[1].is_reliable(), Some(false));
    assert_eq!((bins[2].so.right, bins[2].verdict()), (0, "too few"));
}

/// R. G. Newcombe, Statistics in Medicine 17 (1998), table I: Wilson's score method without continuity correction.
#[test]
fn val_wilson_intervals_are_the_published_ones() {
    let published = [
        ((81, 263), [0.2553, 0.3662]),
        ((15, 148), [0.0624, 0.1605]),
        ((0, 20), [0.0, 0.1611]),
        ((1, 29), [0.0061, 0.1718]),
    ];
    for ((right, of), expected) in published {
        let interval = Rate { right, of }.interval();
        for (edge, expected) in interval.into_iter().zip(expected) {
            assert!(
                (edge / 100.0 - expected).abs() < 6e-5,
                "{right} of {of}: {edge}"
            );
        }
    }
}

#[test]
fn the_score_is_told_as_text_json_and_page() {
    let score = quell::proof::Score { cases: hand_made() };
    let text = score.to_text();
    for header in ["kind", "within 5 points"] {
        assert!(text.contains(header), "{text}");
    }
    assert!(
        text.contains("family, once detected") && text.contains("2 of 3"),
        "{text}"
    );
    assert!(text.contains("backlash+sensor_lag"), "{text}");
    let value = score.to_json();
    assert_eq!(value["rates"]["false_alarms"]["percent"], json!(50.0));
    assert_eq!(value["each"][2]["judgement"]["kind"], json!("single"));
    let html = score.page("10 cases, by hand").render();
    assert!(html.contains("What was taken for what") && html.contains("parametric_stiffness"));
    let empty = quell::proof::Score::default();
    assert!(empty.to_text().contains("0 of 0") && !empty.page("").render().is_empty());
}

#[test]
fn a_run_asks_the_diagnosis_and_then_breaks_the_seal() {
    let folder = TempDir::new().unwrap();
    let keep = folder.path().join("cases");
    let generated = Source::Generated {
        cases: 6,
        seed: SEED,
        kinds: Vec::new(),
        keep: Some(keep.clone()),
    };
    let diagnose = |model: &Path, train: &Recording, test: &Recording| {
        assert!(model.is_file() && train.channels.len() == 2 && test.channels.len() == 2);
        match train.channels[0].time.len() % 2 {
            0 => Ok(verdict("named", &[&["coulomb_friction"]])),
            _ => Err("an odd one".to_string()),
        }
    };
    let first = run(&generated, &diagnose, &|| ()).unwrap();
    let second = run(&Source::Folder(keep), &diagnose, &|| ()).unwrap();
    assert_eq!(first.cases.len(), 6);
    for (a, b) in first.cases.iter().zip(&second.cases) {
        assert_eq!(
            (&a.name, told(&a.truth), &a.judgement),
            (&b.name, told(&b.truth), &b.judgement)
        );
    }
}

/// Who says that a recording tells nothing neither found what was hidden nor raised a false alarm.
#[test]
fn a_recording_that_excites_nothing_is_neither_found_nor_alarmed_at() {
    let silent = || verdict("not_excited", &[]);
    let hidden = judged(&["backlash"], true, silent()).judgement;
    assert!(!hidden.detected && !hidden.is_right(), "{hidden:?}");
    assert_eq!(hidden.confusion[1], "not_excited");
    let clean = judged(&[], true, silent()).judgement;
    assert!(!clean.false_alarm, "{clean:?}");
}
