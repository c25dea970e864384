//! A damper across the joint, or one to ground? The literature writes the one and draws the other
//! (`docs/src/theory/errata.md`). In free decay both are the same; a recording with motion tells them apart.

use crate::machines::{PERIOD, position, stamps, two_angles};
use quell::diagnosis::{Diagnosis, Options, Verdict, diagnose};
use quell::model::Model;
use quell::recording::{Recording, Role};
use quell::signal::{CubicSpline, End, ForcedResponse};
use quell_shapers::Mode;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

const FREQUENCY_HZ: f64 = 8.12;
const DAMPING_RATIO: f64 = 0.084;
/// Noise of the link's sensor, rad: 10 um at a lever of 1 m.
const NOISE: f64 = 1e-5;

/// The link of a joint that has its damper there, by the closed form.
fn recording(to_ground: bool, motor: fn(f64) -> f64, deformation: f64, role: Role) -> Recording {
    let time = stamps(PERIOD);
    let values: Vec<f64> = time.iter().map(|t| motor(*t)).collect();
    let spline = CubicSpline::new(&time, &values, End::NotAKnot).unwrap();
    let mode = Mode::from_hertz(FREQUENCY_HZ, DAMPING_RATIO).unwrap();
    let response = ForcedResponse::new(&spline, mode, to_ground, (deformation, 0.0));
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let seen = |(t, u): (&f64, &f64)| {
        let white: f64 = StandardNormal.sample(&mut random);
        let own = if role == Role::Deformation { 0.0 } else { *u };
        own + response.at(*t).0 + NOISE * white
    };
    let link = time.iter().zip(&values).map(seen).collect();
    two_angles(
        "damper",
        &time,
        [(Role::MotorPosition, values), (role, link)],
    )
}

/// Model with the damper across the joint.
const ACROSS: &str =
    "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.08\n";

/// Model with the damper to ground, of which nothing is certain, and hardly one across.
fn to_ground() -> String {
    let viscous = 2.0 * 0.08 / (8.0 * TAU);
    format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\n\
         damping_ratio = {{ value = 0.001, bounds = [1e-5, 0.3], std = 0.1 }}\n\
         [[effect]]\nname = \"viscous_drag\"\n[effect.parameters]\n\
         viscous = {{ value = {viscous}, std = {viscous} }}\n"
    )
}

fn said(model: &str, recording: Recording) -> (Diagnosis, Model) {
    let model = Model::from_toml(model, "model.toml").unwrap();
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {}).unwrap();
    println!(
        "{}: {:?}",
        outcome.diagnosis.summary, outcome.diagnosis.nuisances
    );
    (outcome.diagnosis, outcome.model)
}

fn still(_: f64) -> f64 {
    0.2
}

#[test]
fn val_in_free_decay_both_dampers_are_one() {
    for to_ground in [false, true] {
        let (said, _) = said(
            ACROSS,
            recording(to_ground, still, 4e-3, Role::LinkPosition),
        );
        assert_eq!(said.verdict, Verdict::NoMismatch);
        let damping_ratio = said.nuisances["damping_ratio"];
        assert!(
            (damping_ratio / DAMPING_RATIO - 1.0).abs() < 0.02,
            "{damping_ratio}"
        );
    }
}

#[test]
fn val_motion_shows_a_damper_to_ground() {
    let (said, _) = said(ACROSS, recording(true, position, 0.0, Role::Deformation));
    assert_eq!(said.verdict, Verdict::Named);
    let finding = &said.findings[0];
    assert_eq!(finding.effect, "viscous_drag");
    let (viscous, exact) = (
        finding.parameters[0].value,
        2.0 * DAMPING_RATIO / (FREQUENCY_HZ * TAU),
    );
    assert!(
        (viscous / exact - 1.0).abs() < 0.05,
        "{viscous} for {exact}"
    );
    let across = said.nuisances["damping_ratio"];
    assert!(across < 0.1 * DAMPING_RATIO, "{across} is left across");
}

/// `w^2 / (s^2 + 2 xi w s + w^2)` is `(2 xi w s + w^2)` over the same, times `1 / (1 + 2 xi s / w)`: a sensor
/// of the link's position in space cannot tell a damper that is wholly to ground from a lag of its own.
#[test]
fn val_a_link_in_space_leaves_a_lag_and_a_damper_to_ground_in_one_set() {
    let (said, _) = said(ACROSS, recording(true, position, 0.0, Role::LinkPosition));
    let finding = &said.findings[0];
    let mut set = finding.alternatives.clone();
    set.push(finding.effect.clone());
    for name in ["viscous_drag", "sensor_lag"] {
        assert!(
            set.iter().any(|other| other == name),
            "no {name} in {set:?}"
        );
    }
}

#[test]
fn val_motion_shows_a_damper_across_the_joint() {
    let (said, better) = said(
        &to_ground(),
        recording(false, position, 0.0, Role::LinkPosition),
    );
    assert_eq!(said.verdict, Verdict::NoMismatch);
    let across = said.nuisances["damping_ratio"];
    assert!(
        (across / DAMPING_RATIO - 1.0).abs() < 0.05,
        "{across} across"
    );
    let ground = better.effects[0].parameters[0].value * FREQUENCY_HZ * TAU / 2.0;
    assert!(ground < 0.05 * DAMPING_RATIO, "{ground} to ground");
}
