//! The diagnosis: on concealed cases of another simulator, on cases of the project's own generator, and
//! its document.

#[path = "absent/shared.rs"]
mod shared;

use quell::diagnosis::{Diagnosis, FittedParameter, Options, Outcome, Verdict, diagnose, score};
use quell::model::{Experiment, Model};
use quell::proof::{FindingSummary, Judgement, Kind, generate_kind, read_cases, read_truths};
use quell::recording::{Recording, Role};
use quell::signal::noise_floor;
use rand::{Rng, SeedableRng};
use rand_distr::StandardNormal;
use shared::shared;
use std::path::PathBuf;

fn outcome(model: &Model, train: &Recording) -> Outcome {
    let train = std::slice::from_ref(train);
    diagnose(model, train, &[], &Options::default(), &|_, _| {}).unwrap()
}

/// The concealed cases.
fn concealed() -> Option<PathBuf> {
    let truth = shared("QUELL_CONCEALED", "concealed", "truth.json")?;
    Some(truth.with_file_name(""))
}

fn summary(diagnosis: &Diagnosis) -> quell::proof::Verdict {
    quell::proof::Verdict {
        kind: diagnosis.verdict.name().into(),
        findings: diagnosis
            .findings
            .iter()
            .map(|finding| FindingSummary {
                effect: finding.effect.clone(),
                place: finding.place.clone(),
                alternatives: finding.alternatives.clone(),
                parameters: Vec::new(),
            })
            .collect(),
        ..Default::default()
    }
}

/// From the training recording alone: the right family (or a set that holds it) wherever something can be seen, no false alarm,
/// no confident wrong name; and the model that comes out predicts moves that were never shown.
#[test]
fn val_concealed_cases_of_another_simulator() {
    let Some(folder) = concealed() else { return };
    let (mut verdicts, mut scores) = (Vec::new(), Vec::new());
    for case in read_cases(&folder).unwrap() {
        let model = Model::from_path(&case.model).unwrap();
        let outcome = outcome(&model, &Recording::from_path(&case.train).unwrap());
        let test = Recording::from_path(&case.test).unwrap();
        scores.push(score(&outcome.model, &test).unwrap().rms_over_noise);
        verdicts.push((case.name.clone(), outcome.diagnosis));
    }
    // The truth is read after the last diagnosis.
    let truths = read_truths(&folder).unwrap();
    let (mut right, mut known) = (0, 0);
    for (name, diagnosis) in &verdicts {
        let truth = &truths[name];
        let judgement = Judgement::new(truth, &summary(diagnosis));
        println!("{name} ({}): {}", truth.name(), diagnosis.summary);
        match judgement.kind {
            Kind::Outside => {
                // Only a law that was learned in its slot explains it.
                let learned = judgement.learned && judgement.spurious == 0;
                assert!(
                    learned || diagnosis.verdict != Verdict::Named,
                    "{name} is in no catalogue"
                );
                continue;
            }
            Kind::Clean => assert!(!judgement.false_alarm, "{name} is clean"),
            _ => {}
        }
        known += 1;
        // Where two explanations cannot be told apart, the truth is one of them.
        let found = judgement.family || judgement.in_set;
        right += usize::from(found || judgement.kind == Kind::Clean);
    }
    scores.sort_by(f64::total_cmp);
    let median = scores[scores.len() / 2];
    println!("family right in {right} of {known}, median score {median:.3} times the noise");
    assert!(right >= known - 1 && median <= 1.10);
}

/// The same input gives the same document, and the model that is written is the one that was fitted.
#[test]
fn the_same_input_gives_the_same_answer() {
    let case = quell::proof::generate(3, 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let sealed = quell::proof::write_case(folder.path(), 0, &case).unwrap();
    let train = Recording::from_path(&sealed.train).unwrap();
    let model = Model::from_path(&sealed.model).unwrap();
    let [first, second] = [0, 1].map(|_| outcome(&model, &train));
    assert_eq!(first.diagnosis, second.diagnosis);
    let text = first.model.to_toml();
    let again = Model::from_toml(&text, "model.toml").unwrap();
    assert_eq!(again.to_toml(), text);
    let test = Recording::from_path(&sealed.test).unwrap();
    let [ours, theirs] = [&first.model, &again].map(|model| score(model, &test).unwrap());
    assert_eq!(ours, theirs);
}

/// A recording that is held out as a whole is judged as `score` judges it, with a clock and an offset of
/// its own, and the summary says what was held out; several recordings are drawn under their names.
#[test]
fn recordings_are_held_out_as_a_whole() {
    let case = quell::proof::generate(3, 1).unwrap();
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let (train, test) = (std::slice::from_ref(&case.train), &case.test);
    let run = |train: &[Recording], held_out: &[Recording]| {
        diagnose(&model, train, held_out, &Options::default(), &|_, _| {}).unwrap()
    };
    let apart = run(train, std::slice::from_ref(test));
    let fit = &apart.diagnosis.fit;
    let scored = score(&apart.model, test).unwrap().rms;
    assert!((fit.after.held_out_rms / scored - 1.0).abs() < 0.01);
    assert!(
        apart
            .diagnosis
            .summary
            .contains("recordings that were held out")
    );
    let both = run(&[case.train.clone(), test.clone()], &[]);
    let names: Vec<_> = both.traces.outputs.iter().map(|o| &o.name).collect();
    assert!(
        names[0].starts_with("train: ") && names[1].starts_with("test: "),
        "{names:?}"
    );
    assert!(!apart.traces.outputs[0].name.contains(':'));
}

/// Stretches that judged which effects are told are fitted in the end: values and intervals are those of a fit that had all
/// rows from the beginning, since another recording was held out. A fit to two thirds of them would be .7 deviations off.
#[test]
fn what_is_told_is_fitted_to_the_whole_recording() {
    let case = generate_kind(Kind::Single, 3, 0).unwrap();
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let run = |held_out: &[Recording]| {
        let train = std::slice::from_ref(&case.train);
        let options = Options::default();
        diagnose(&model, train, held_out, &options, &|_, _| {}).unwrap()
    };
    let [stretches, apart] = [run(&[]), run(std::slice::from_ref(&case.test))];
    let parameters = |outcome: &Outcome| {
        let findings = outcome.diagnosis.findings.iter();
        let each = findings.flat_map(|own| own.parameters.iter().cloned());
        each.collect::<Vec<_>>()
    };
    let [found, all] = [&stretches, &apart].map(parameters);
    assert!(
        !found.is_empty() && found.len() == all.len(),
        "{found:?} {all:?}"
    );
    for (own, other) in found.iter().zip(&all) {
        assert_eq!(own.name, other.name);
        let width = |of: &FittedParameter| of.ci95[1] - of.ci95[0];
        let deviation = width(other) / (2.0 * 1.96);
        assert!(
            (own.value - other.value).abs() < 0.2 * deviation,
            "{own:?} {other:?}"
        );
        assert!(
            (width(own) / width(other) - 1.0).abs() < 0.05,
            "{own:?} {other:?}"
        );
    }
}

/// A model that already holds an effect at its neutral size simulates as the model without it does, to
/// the bit, for every effect of the catalogue and every place.
#[test]
fn neutral_effects_change_nothing() {
    use quell::effects::EFFECTS;
    use quell::model::{Departure, Experiment, Term, simulate};
    let case = quell::proof::generate(3, 0).unwrap();
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let experiment = Experiment::new(&model, &case.train).unwrap();
    let run = |terms: &[Term]| {
        let simulated = simulate(
            model.kind,
            &model.keys(),
            terms,
            &experiment,
            &Departure::default(),
        );
        simulated.predict(&experiment.outputs[0], 0.0).values
    };
    let baseline = run(&[]);
    for effect in EFFECTS {
        for &place in effect.places {
            let values = effect.neutral();
            assert_eq!(
                run(&[Term::new(effect, place, values)]),
                baseline,
                "{}",
                effect.name
            );
        }
    }
}

/// Adds hum of 50 Hz and a drift that remembers a thousand samples to the sensors of the tip: together they are as large as
/// the noise that is there.
fn hum(recording: &mut Recording, random: &mut impl Rng) {
    let sensors = recording
        .channels
        .iter_mut()
        .filter(|channel| !matches!(channel.role, Role::MotorPosition | Role::CommandPosition));
    for channel in sensors {
        for values in &mut channel.columns {
            let noise = noise_floor(values).standard_deviation;
            let (mut drift, pole) = (0.0, 0.999f64);
            for (value, time) in values.iter_mut().zip(&channel.time) {
                let white: f64 = random.sample(StandardNormal);
                drift = pole * drift + (1.0 - pole * pole).sqrt() * white;
                let hum = (100.0 * std::f64::consts::PI * time).sin();
                *value += noise * (0.7 * drift + hum);
            }
        }
    }
}

/// Third differences take noise of such a colour for less than it is. Where it is told, it is told as hum and as a drift of the
/// sensor; a drift that remembers a thousand samples is no line, so of two recordings another slow law is told as well, with
/// hum and without.
#[test]
fn hum_and_drift_are_no_other_mismatch() {
    const THERE: [&str; 3] = [
        "harmonic_disturbance",
        "sensor_drift",
        "learned_sensor_drift",
    ];
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let mut wrong = Vec::new();
    for index in 0..8 {
        let mut case = generate_kind(Kind::Clean, 3, index).unwrap();
        hum(&mut case.train, &mut random);
        let model = Model::from_toml(&case.model, "model.toml").unwrap();
        let said = outcome(&model, &case.train).diagnosis;
        let mut findings = said.findings.iter();
        if findings.any(|own| !THERE.contains(&own.effect.as_str())) {
            wrong.push((index, said.summary));
        }
    }
    assert!(wrong.len() <= 2, "{wrong:?}");
}

/// Rounds the encoder's positions to steps as large as what the sensor of the link has of noise.
fn round_coarsely(model: &Model, recording: &mut Recording) {
    let is_encoder = |role: Role| role == Role::MotorPosition;
    let sensor = recording
        .channels
        .iter()
        .find(|own| !is_encoder(own.role))
        .unwrap();
    let noise = sensor
        .columns
        .iter()
        .map(|own| noise_floor(own).standard_deviation)
        .fold(0.0, f64::max);
    let lever = match sensor.role {
        Role::TipPosition => model.value("lever_arm_m").unwrap(),
        _ => 1.0,
    };
    let step = noise / lever;
    let encoders = recording
        .channels
        .iter_mut()
        .filter(|own| is_encoder(own.role));
    for value in encoders.flat_map(|own| own.columns.iter_mut().flatten()) {
        *value = step * (*value / step).round();
    }
}

/// While an encoder rests its error is one and the same: the residual of a clean machine has a shape. In motion its error
/// makes a lightly damped mode ring, which of one machine is told as a lag of the sensor.
#[test]
fn rounding_at_rest_is_no_mismatch() {
    let mut told = Vec::new();
    for index in 0..12 {
        let mut case = generate_kind(Kind::Clean, 3, index).unwrap();
        let model = Model::from_toml(&case.model, "model.toml").unwrap();
        round_coarsely(&model, &mut case.train);
        let outcome = outcome(&model, &case.train);
        if !outcome.diagnosis.findings.is_empty() {
            told.push((index, outcome.diagnosis.summary));
        }
    }
    assert!(told.len() <= 1, "{told:#?}");
}

/// A tracker that sees a single move over a short arc, which the unknown frame of the tracker explains: the sensor is not dead.
#[test]
fn a_short_arc_is_no_dead_sensor() {
    let case = generate_kind(Kind::Single, 4407, 13).unwrap();
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let outcome = outcome(&model, &case.train);
    assert_eq!(
        outcome.diagnosis.verdict,
        Verdict::Named,
        "{}",
        outcome.diagnosis.summary
    );
}

/// What a tracker rounds in space is rounding of the angle that is made of it.
#[test]
fn the_step_of_coordinates_is_that_of_the_angle() {
    let cases = (0..).map(|index| generate_kind(Kind::Clean, 3, index).unwrap());
    let is_tip = |case: &quell::proof::Case| case.train.channel(Role::TipPosition).is_some();
    let mut case = cases.into_iter().find(is_tip).unwrap();
    let channels = case.train.channels.iter_mut();
    let tip = channels.filter(|own| own.role == Role::TipPosition);
    for value in tip.flat_map(|own| own.columns.iter_mut().flatten()) {
        *value = 1e-4 * (*value / 1e-4).round();
    }
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let experiment = Experiment::new(&model, &case.train).unwrap();
    let step = experiment.outputs[0].coordinate_step.unwrap();
    let arm = model.value("lever_arm_m").unwrap();
    assert!((step * arm / 1e-4 - 1.0).abs() < 0.01, "{step}");
}
