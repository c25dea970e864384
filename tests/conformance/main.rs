//! Conformance of the whole catalogue: each effect, simulated at its typical size at each of its places, is
//! found again, or told in a set that holds it; or no motion of that machine tells it from another one,
//! and a table says why. And recordings that are awkward, as real ones are.

mod awkward;
mod concealed;
mod curves;
mod damper;
mod delays;
mod heard;
mod machines;
mod sets;

mod untidy;

use concealed::{conceal, conceal_all, typical};
use machines::{Machine, axis, commanded, gauge, held, joint, looped, oscillator, two_masses};
use quell::diagnosis::{Diagnosis, Finding, Options, Outcome, Verdict, diagnose};
use quell::effects::{EFFECTS, Effect, PLACES, ParameterRole, Place};
use quell::model::{Departure, Experiment, Term, simulate};
use quell::recording::Recording;
use sets::known;
use std::f64::consts::TAU;

/// The diagnosis of recordings of a machine.
pub fn outcome(machine: &Machine, recordings: &[Recording]) -> Outcome {
    let options = Options::default();
    diagnose(&machine.model, recordings, &[], &options, &|_, _| {}).unwrap()
}

/// How an effect came out of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Found {
    /// The first name.
    First,
    /// Another name, or one of a set.
    InSet,
    /// Another effect stands for it, and a table says why.
    Known(&'static str),
    /// Not at all.
    Missed,
}

fn found(said: &Diagnosis, effect: &Effect, place: Place) -> Found {
    let first = said.findings.first();
    let name = first.map(|finding| finding.effect.as_str());
    let mut findings = said.findings.iter();
    if name == Some(effect.name) && first.is_some_and(|f| f.place == place.name()) {
        return Found::First;
    }
    let holds = |alternatives: &[String]| alternatives.iter().any(|other| other == effect.name);
    if findings.any(|f| f.effect == effect.name || holds(&f.alternatives)) {
        return Found::InSet;
    }
    known(effect, name).map_or(Found::Missed, Found::Known)
}

/// The first machine that can have it: a force or a current shows what a drive lacks, a joint the rest.
fn machine(effect: &Effect, place: Place) -> Machine {
    let mut machines = [joint(), gauge(), axis()].into_iter();
    let found = machines.find(|machine| machine.can_have(effect, place));
    found.unwrap_or_else(|| panic!("no machine has {} in the {}", effect.name, place.name()))
}

/// The concealed effects and the found ones; for the messages of a test.
fn tried(machine: &Machine, effect: &'static Effect, place: Place, factor: f64) -> Found {
    let hidden = conceal(machine, typical(machine, effect, place, factor), 1);
    let said = outcome(machine, &[hidden.recording]).diagnosis;
    let found = found(&said, effect, place);
    let (name, place) = (effect.name, place.name());
    println!(
        "{name} in the {place}, {}: {found:?}: {}",
        machine.name, said.summary
    );
    found
}

#[test]
fn each_effect_is_found_again() {
    let mut missed = Vec::new();
    for effect in EFFECTS.iter().copied() {
        for &place in effect.places {
            if tried(&machine(effect, place), effect, place, 1.0) == Found::Missed {
                missed.push((effect.name, place.name()));
            }
        }
    }
    assert!(missed.is_empty(), "not found again: {missed:?}");
}

/// At its neutral size an effect is not there, to the bit: every effect, at every place, in every kind of
/// model and under each of its inputs.
#[test]
fn neutral_effects_change_nothing_in_any_kind() {
    let machines = [
        joint(),
        gauge(),
        commanded(),
        axis(),
        looped(),
        two_masses(),
        oscillator(),
        held(),
    ];
    for machine in machines {
        let model = &machine.model;
        let experiment = Experiment::new(model, &machine.blank).unwrap();
        let run = |terms: &[Term]| {
            let simulated = simulate(
                model.kind,
                &model.keys(),
                terms,
                &experiment,
                &Departure::default(),
            );
            let outputs = experiment.outputs.iter();
            let values: Vec<_> = outputs.map(|o| simulated.predict(o, 0.0).values).collect();
            values
        };
        let without = run(&[]);
        for effect in EFFECTS.iter().copied() {
            for place in PLACES.iter().map(|entry| entry.0) {
                if !effect.places.contains(&place) || !machine.can_have(effect, place) {
                    continue;
                }
                let mut values: Vec<f64> = typical(&machine, effect, place, 1.0).values;
                let size = effect.size();
                values[size] = effect.parameters[size].neutral;
                let term = Term::new(effect, place, values);
                assert_eq!(
                    run(&[term]),
                    without,
                    "{} in a {}",
                    effect.name,
                    machine.name
                );
            }
        }
    }
}

/// Sizes away from the typical one: 5 and 30 % more inertia, 15 % less.
#[test]
fn a_payload_is_found_at_every_size() {
    let effect = Effect::from_name("payload_change").unwrap();
    for factor in [0.25, 1.5, -0.75] {
        let found = tried(&joint(), effect, Place::Link, factor);
        assert_eq!(found, Found::First, "{factor} times the typical size");
    }
}

/// A stiff part, and a load that hangs like a pendulum.
#[test]
fn a_further_mode_is_found_wherever_it_is() {
    let effect = Effect::from_name("second_mode").unwrap();
    let frequency = effect.index(ParameterRole::Frequency).unwrap();
    let machine = joint();
    for (factor, frequency_hz) in [(0.3, 21.0), (1.0, 1.1), (0.3, 1.6), (-1.0, 30.0)] {
        let mut term = typical(&machine, effect, Place::Link, factor);
        term.values[frequency] = frequency_hz * TAU;
        let hidden = conceal(&machine, term, 1);
        let said = outcome(&machine, &[hidden.recording]).diagnosis;
        println!("{frequency_hz} Hz: {}", said.summary);
        let found = found(&said, effect, Place::Link);
        assert!(
            matches!(found, Found::First | Found::InSet),
            "{frequency_hz} Hz: {found:?}"
        );
    }
}

/// Loads on strings between those that the search begins with: 2 m to 10 cm.
#[test]
fn a_swinging_load_is_found_on_every_string() {
    let effect = Effect::from_name("swinging_load").unwrap();
    let frequency = effect.index(ParameterRole::Frequency).unwrap();
    let machine = joint();
    for frequency_hz in [0.35, 0.65, 1.0, 1.6] {
        let mut term = typical(&machine, effect, Place::Link, 1.0);
        term.values[frequency] = frequency_hz * TAU;
        let said = outcome(&machine, &[conceal(&machine, term, 1).recording]).diagnosis;
        println!("{frequency_hz} Hz: {}", said.summary);
        let found = found(&said, effect, Place::Link);
        assert_eq!(found, Found::First, "{frequency_hz} Hz");
    }
}

/// Knocks against a machine at these times, this hard; so short that the velocity jumps.
fn knocks(machine: &Machine, all: &[(f64, f64)]) -> Vec<Term> {
    let effect = Effect::from_name("external_disturbance").unwrap();
    let when = effect.event_time().unwrap();
    let duration = effect.index(ParameterRole::Shape).unwrap();
    let knock = |&(time, factor): &(f64, f64)| {
        let mut term = typical(machine, effect, Place::Environment, factor);
        term.values[when] = time;
        term.values[duration] = 0.0;
        term
    };
    all.iter().map(knock).collect()
}

/// A recording of a machine that was knocked against at these times, this hard.
fn knocked(machine: &Machine, name: &str, all: &[(f64, f64)], seed: u64) -> Recording {
    Recording {
        name: name.into(),
        ..conceal_all(machine, &knocks(machine, all), seed).recording
    }
}

/// The finding of a diagnosis that names one.
fn only(said: &Diagnosis) -> &Finding {
    println!("{}", said.summary);
    assert_eq!(said.verdict, Verdict::Named);
    let [finding] = &said.findings[..] else {
        panic!("{}", said.summary);
    };
    finding
}

/// A machine that was knocked against five times in two recordings: one finding, which tells when and where. What
/// happened in one recording is not in the other, nor in the better model.
#[test]
fn knocks_belong_to_their_recordings() {
    let machine = joint();
    let first = [(1.1, 1.0), (2.9, -0.6), (4.6, 0.8)];
    let second = [(2.0, -0.9), (3.7, 0.7)];
    let recordings = [
        knocked(&machine, "Monday", &first, 1),
        knocked(&machine, "Tuesday", &second, 2),
    ];
    let outcome = outcome(&machine, &recordings);
    let said = &outcome.diagnosis;
    let finding = only(said);
    let told = finding.parameters.iter();
    let told = told.filter(|parameter| parameter.name.starts_with("time"));
    let told = told.map(|parameter| parameter.value);
    let mut told: Vec<(&str, f64)> = finding
        .happened_in
        .iter()
        .map(String::as_str)
        .zip(told)
        .collect();
    told.sort_by(|a, b| a.0.cmp(b.0).then(a.1.total_cmp(&b.1)));
    let times = first.map(|knock| ("Monday", knock.0)).into_iter();
    let times = times.chain(second.map(|knock| ("Tuesday", knock.0)));
    assert_eq!(told.len(), 5, "{told:?}");
    for (told, time) in told.iter().zip(times) {
        let near = told.0 == time.0 && (told.1 - time.1).abs() < 0.01;
        assert!(near, "{told:?} instead of {time:?}");
    }
    assert!(outcome.model.effects.is_empty());
    let fit = &said.fit;
    assert!(fit.model_alone.unwrap().train_rms > 1.5 * fit.after.train_rms);
}

/// Knocks beside an effect of a single parameter: all are told.
#[test]
fn knocks_are_told_beside_friction() {
    let machine = joint();
    let friction = Effect::from_name("coulomb_friction").unwrap();
    let mut all = knocks(&machine, &[(1.1, 1.0), (2.9, -0.6), (4.6, 0.8)]);
    all.push(typical(&machine, friction, Place::Link, 1.0));
    let said = outcome(&machine, &[conceal_all(&machine, &all, 1).recording]).diagnosis;
    println!("{}", said.summary);
    let mut told: Vec<&str> = said
        .findings
        .iter()
        .map(|own| own.effect.as_str())
        .collect();
    told.sort_unstable();
    assert_eq!(told, ["coulomb_friction", "external_disturbance"]);
}

/// A fan beside the machine runs through two recordings: one finding, with a phase of its own in each. The better model
/// does not have it.
#[test]
fn a_fan_belongs_to_its_recordings() {
    let machine = joint();
    let effect = Effect::from_name("harmonic_disturbance").unwrap();
    let phase = effect.index(ParameterRole::Phase).unwrap();
    let mut term = typical(&machine, effect, Place::Environment, 1.0);
    let recordings = [("Monday", 0.4), ("Tuesday", 2.1)].map(|(name, own)| {
        term.values[phase] = own;
        Recording {
            name: name.into(),
            ..conceal(&machine, term.clone(), 1).recording
        }
    });
    let outcome = outcome(&machine, &recordings);
    let said = &outcome.diagnosis;
    let finding = only(said);
    let mut happened = finding.happened_in.clone();
    happened.sort();
    assert_eq!(happened, ["Monday", "Tuesday"]);
    let told = finding.parameters.iter();
    let told = told.filter(|parameter| parameter.name.starts_with("frequency"));
    let frequency = term.values[effect.index(ParameterRole::Frequency).unwrap()] / TAU;
    for own in told {
        assert!((own.value / frequency - 1.0).abs() < 1e-3, "{own:?}");
    }
    assert!(outcome.model.effects.is_empty());
}

/// A link on a prescribed motor side starts at rest on it, wherever that is: its sensor's first sample is
/// a position, not a deformation.
#[test]
fn a_commanded_link_starts_on_its_motor_side() {
    let effect = Effect::from_name("cubic_stiffness").unwrap();
    assert_eq!(
        tried(&commanded(), effect, Place::Transmission, 1.0),
        Found::First
    );
}
