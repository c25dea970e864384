//! One effect is one constant and one line of the catalogue: all that looks for it or speaks of it knows it then.

use quell::cli::diagnose::long_help;
use quell::diagnosis::{Diagnosis, Options, Outcome, Verdict, diagnose};
use quell::effects::{
    Catalogue, EFFECTS, Effect, Force, LEARNED, Law, Likeness, Memory, Motion, PLACES, Parameter,
    ParameterRole, Place, Property, Quantity,
};
use quell::model::{Departure, Experiment, Model, Term, simulate};
use quell::recording::{Channel, Recording, Role};
use quell::report::{Case, page_of};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::f64::consts::TAU;

/// A pump beside the machine that shakes the link.
struct Pump {
    amplitude: f64,
}

impl Force for Pump {
    fn force(&self, motion: &Motion, _x: f64, _v: f64, _memory: &Memory) -> f64 {
        self.amplitude * (TAU * 3.0 * motion.time).sin()
    }
}

/// The constant that a new effect is.
const PUMP: Effect = Effect {
    name: "toy_pump",
    title: "shaking by Toy's pump",
    places: &[Place::Environment],
    physics: "A pump beside the machine shakes the link three times a second. Source: Toy (1900).",
    remedy: "Move the pump.",
    parameters: &[Parameter {
        name: "toy_amplitude",
        role: ParameterRole::Size,
        quantity: Quantity::FORCE,
        bounds: |scales| (-scales.force, scales.force),
        neutral: 0.0,
        typical: |scales| 0.1 * scales.force,
    }],
    properties: &[Property::Alike(Likeness::Pose)],
    law: |p| Law::Force(Box::new(Pump { amplitude: p[0] })),
    starts: |scales| vec![vec![0.1 * scales.force], vec![-0.1 * scales.force]],
};

/// The effects that no recording tells from it.
const TWIN: Effect = Effect {
    name: "toy_twin",
    title: "shaking by a twin",
    ..PUMP
};

/// The catalogue with further lines.
fn with(further: &[&'static Effect]) -> Catalogue {
    Catalogue([EFFECTS, further].concat().leak())
}

/// A joint beside the pump; `phase` tells recordings apart.
fn recorded(model: &Model, phase: f64) -> Recording {
    let time: Vec<f64> = (0..1500).map(|k| f64::from(k) * 0.004).collect();
    let angle = |t: &f64| 0.3 * (1.3 * t + phase).sin() + 0.1 * (4.1 * t).sin();
    let channel = |role, values| Channel {
        role,
        unit: "rad".into(),
        time: time.clone(),
        columns: vec![values],
    };
    let mut recording = Recording {
        payload: None,
        name: format!("recording {phase}"),
        channels: vec![
            channel(Role::MotorPosition, time.iter().map(angle).collect()),
            channel(Role::LinkPosition, vec![0.0; time.len()]),
        ],
    };
    let experiment = Experiment::new(model, &recording).unwrap();
    let truth = Term::new(&PUMP, Place::Environment, vec![5e-4]);
    let start = Departure::default();
    let motion = simulate(model.kind, &model.keys(), &[truth], &experiment, &start);
    let mut shown = motion.predict(&experiment.outputs[0], 0.0).values;
    let normal = Normal::new(0.0, 1e-5).unwrap();
    let mut random = ChaCha8Rng::seed_from_u64(1 + phase.to_bits());
    for value in &mut shown {
        *value += normal.sample(&mut random);
    }
    recording.channels[1].columns = vec![shown];
    recording
}

fn diagnosed(catalogue: Catalogue) -> Outcome {
    let text = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.06\n";
    let model = Model::from_toml(text, "model.toml").unwrap();
    let [train, test] = [0.0, 2.0].map(|phase| [recorded(&model, phase)]);
    let options = Options {
        catalogue,
        ..Options::default()
    };
    diagnose(&model, &train, &test, &options, &|_, _| {}).unwrap()
}

fn page(catalogue: Catalogue, outcome: &Outcome) -> String {
    let case = Case {
        catalogue,
        ..Case::new(&outcome.diagnosis, &outcome.traces)
    };
    page_of(&case, "model.toml", &[]).render()
}

fn names(diagnosis: &Diagnosis) -> Vec<&str> {
    let findings = diagnosis.findings.iter();
    findings.map(|finding| finding.effect.as_str()).collect()
}

#[test]
fn a_new_effect_is_found_and_spoken_of() {
    let catalogue = with(&[&PUMP]);
    let outcome = diagnosed(catalogue);
    let said = &outcome.diagnosis;
    assert_eq!(said.verdict, Verdict::Named, "{}", said.summary);
    assert_eq!(names(said), ["toy_pump"]);
    assert!(
        said.summary.contains("shaking by Toy's pump"),
        "{}",
        said.summary
    );
    assert!(outcome.model.to_toml().contains("name = \"toy_pump\""));

    let html = page(catalogue, &outcome).replace("&#39;", "'");
    for words in [
        "Shaking by Toy's pump",
        "shakes the link three times a second",
        "What to do: Move the pump.",
        "toy amplitude",
    ] {
        assert!(html.contains(words), "{words}");
    }
    assert!(!names(&diagnosed(Catalogue::default()).diagnosis).contains(&"toy_pump"));
}

#[test]
fn what_tells_a_new_effect_from_its_neighbour_is_said() {
    let catalogue = with(&[&PUMP, &TWIN]);
    let outcome = diagnosed(catalogue);
    let said = &outcome.diagnosis;
    assert_eq!(said.verdict, Verdict::Ambiguous, "{}", said.summary);
    let next = said.next_move.as_ref().unwrap();
    assert!(next.why.contains(Likeness::Pose.remedy()), "{}", next.why);
    assert!(next.why.contains(PUMP.title) && next.why.contains(TWIN.title));
}

#[test]
fn the_help_lists_the_catalogue() {
    let help = long_help(with(&[&PUMP]));
    assert!(
        help.contains(" external_disturbance, harmonic_disturbance, toy_pump\n"),
        "{help}"
    );
}

/// The table of the book, as it should be.
fn rows(catalogue: Catalogue) -> Vec<String> {
    let row = |(place, names): (Place, Vec<&str>)| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        format!("| {} | {} |", place.name(), names.join(", "))
    };
    catalogue.by_place().into_iter().map(row).collect()
}

#[test]
fn the_book_lists_the_catalogue() {
    let toy = rows(with(&[&PUMP]));
    assert!(
        toy.iter().any(|row| row.ends_with(", `toy_pump` |")),
        "{toy:?}"
    );
    let rows = rows(Catalogue::default());
    let book = include_str!("../docs/src/reference/effects.md");
    let all = rows.iter().all(|row| book.contains(row));
    assert!(all, "what the book should list:\n{}", rows.join("\n"));
}

#[test]
fn the_fuzzer_knows_the_words_of_a_model_file() {
    let dictionary = include_str!("../fuzz/dictionaries/model");
    let parameters = EFFECTS.iter().flat_map(|effect| effect.parameters);
    let mut words: Vec<String> = EFFECTS
        .iter()
        .map(|effect| effect.name)
        .chain(parameters.map(|parameter| parameter.name))
        .chain(LEARNED.iter().map(|effect| effect.name))
        .chain(["from", "to", "values"])
        .chain(PLACES.iter().map(|place| place.1))
        .map(|word| format!("\"{word}\""))
        .collect();
    words.retain(|word| !dictionary.lines().any(|line| line == word));
    words.sort();
    words.dedup();
    assert!(
        words.is_empty(),
        "what fuzz/dictionaries/model lacks:\n{}",
        words.join("\n")
    );
}
