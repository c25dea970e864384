//! Recordings that are awkward, as real ones are.

use crate::concealed::{conceal, typical};
use crate::machines::{
    Machine, OWN_PERIOD, PERIOD, angle, axis, joint, joint_at, looped, stamps, two_masses,
};
use crate::{Found, found, outcome};
use quell::diagnosis::Outcome;
use quell::effects::{Effect, Place};
use quell::model::Term;
use quell::recording::{Recording, Role};
use std::f64::consts::{PI, TAU};

fn cubic(machine: &Machine) -> Term {
    let effect = Effect::from_name("cubic_stiffness").unwrap();
    typical(machine, effect, Place::Transmission, 1.0)
}

/// Diagnoses, and expects the effect to be named first.
fn named(machine: &Machine, recordings: &[Recording], term: &Term) -> Outcome {
    let outcome = outcome(machine, recordings);
    let said = &outcome.diagnosis;
    println!("{}: {} {:?}", machine.name, said.summary, said.remarks);
    assert_eq!(found(said, term.effect, term.place), Found::First);
    outcome
}

fn remarked(outcome: &Outcome, words: &str) {
    let remarks = &outcome.diagnosis.remarks;
    assert!(
        remarks.iter().any(|r| r.contains(words)),
        "no \"{words}\" in {remarks:?}"
    );
}

/// Stamps that jitter by a fifth of the period, one in twenty lost.
fn irregular(period: f64) -> Vec<f64> {
    let all = stamps(period).into_iter().enumerate();
    let kept = all.filter(|(k, _)| k % 20 != 7);
    kept.map(|(k, t)| t + 0.2 * period * (1.7 * k as f64).sin())
        .collect()
}

#[test]
fn irregular_clocks_and_missing_samples() {
    let machine = joint_at(&irregular(PERIOD), &irregular(OWN_PERIOD));
    let term = cubic(&machine);
    let hidden = conceal(&machine, term.clone(), 1);
    let outcome = named(&machine, &[hidden.recording], &term);
    remarked(&outcome, "at its own stamp");
}

#[test]
fn wrapped_angles() {
    let machine = joint();
    let term = cubic(&machine);
    let mut recording = conceal(&machine, term.clone(), 1).recording;
    for channel in &mut recording.channels {
        for value in &mut channel.columns[0] {
            *value = (*value + 2.8 + PI).rem_euclid(TAU) - PI;
        }
    }
    let outcome = named(&machine, &[recording], &term);
    remarked(&outcome, "was unwrapped");
}

#[test]
fn recordings_with_different_payloads() {
    let empty = joint();
    let mut loaded = joint();
    let keys = loaded.model.kind.loaded(&empty.model.keys(), 1.4);
    for (value, key) in loaded.model.values.iter_mut().zip(keys) {
        value.value = key;
    }
    loaded.blank.payload = Some("2 kg".into());
    let term = cubic(&empty);
    let recordings = [(&empty, 1), (&loaded, 2)]
        .map(|(machine, seed)| conceal(machine, term.clone(), seed).recording);
    let outcome = named(&empty, &recordings, &term);
    let inertia = outcome.diagnosis.nuisances["relative_inertia_with_payload 2 kg"];
    assert!((inertia / 1.4 - 1.0).abs() < 0.01, "{inertia}");
    assert!(outcome.diagnosis.fit.after.held_out_over_noise < 1.1);
    remarked(&outcome, "With the payload \"2 kg\"");
}

#[test]
fn several_outputs_at_once() {
    let machine = two_masses();
    let term = cubic(&machine);
    let hidden = conceal(&machine, term.clone(), 1);
    named(&machine, &[hidden.recording], &term);
}

#[test]
fn data_under_feedback() {
    let machine = looped();
    let effect = Effect::from_name("coulomb_friction").unwrap();
    let term = typical(&machine, effect, Place::Drive, 1.0);
    let hidden = conceal(&machine, term.clone(), 1);
    named(&machine, &[hidden.recording], &term);
}

/// An arm that never stops: the noise is read from differences of what it does.
#[test]
fn no_rest() {
    let mut machine = joint();
    let swing =
        |t: f64| 0.3 * (3.1 * t).sin() + 0.1 * (11.0 * t + 1.0).cos() + 0.02 * (37.0 * t).sin();
    machine.blank.channels[0] = angle(Role::MotorPosition, &stamps(PERIOD), swing);
    let term = cubic(&machine);
    let hidden = conceal(&machine, term.clone(), 1);
    let outcome = named(&machine, &[hidden.recording], &term);
    let told = outcome.diagnosis.fit.noise_std / hidden.noise;
    assert!((0.8..1.25).contains(&told), "{told} times the noise");
}

/// No sample is left out: 60000 of them, an input and an output.
#[test]
fn long_recordings_are_not_thinned() {
    let mut machine = axis();
    let time: Vec<f64> = (0..60_000).map(|k| k as f64 * 1e-3).collect();
    let at = |t: f64| 100.0 * crate::machines::push(t % 6.0) + 3.0 * (0.9 * t).sin();
    machine.blank.channels[0].columns = vec![time.iter().map(|t| at(*t)).collect()];
    for channel in &mut machine.blank.channels {
        channel.time = time.clone();
    }
    machine.blank.channels[1].columns = vec![vec![0.0; time.len()]];
    let effect = Effect::from_name("coulomb_friction").unwrap();
    let term = typical(&machine, effect, Place::Drive, 1.0);
    let hidden = conceal(&machine, term.clone(), 1);
    let outcome = named(&machine, &[hidden.recording], &term);
    assert_eq!(outcome.traces.outputs[0].time.len(), time.len());
}
