//! Axes on a guide that no model file knows, simulated by this file alone: tight, dry or with a detent at one place, or with
//! friction that builds up over a distance. A loop that the model does not know moves them; the recording has its force.

mod cycloids;

use cycloids::cycloids;
use quell::diagnosis::{Diagnosis, Options, diagnose};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

const MASS: f64 = 20.0;
const VISCOUS: f64 = 40.0;
/// Step of the simulation, and the steps of it for each sample, s.
const FINE: f64 = 1e-4;
const EVERY: usize = 20;

/// Position and velocity of moves over half a metre, m.
fn moves(t: f64) -> [f64; 2] {
    let all = [
        (0.2, 0.6, 0.4),
        (1.2, 0.7, -0.5),
        (2.3, 0.4, 0.2),
        (3.1, 0.8, 0.3),
        (4.4, 0.6, -0.4),
        (5.4, 0.3, 0.1),
    ];
    cycloids(&all, t)
}

/// The diagnosis of an axis on which a force acts beside that of its viscous friction: `resists(u, v)`, which is called
/// step by step.
fn diagnosed(mut resists: impl FnMut(f64, f64) -> f64) -> Diagnosis {
    let mut random = ChaCha8Rng::seed_from_u64(11);
    let ([mut u, mut v], mut force) = ([0.0; 2], 0.0);
    let mut seen = [Vec::new(), Vec::new()];
    for k in 0..(6.0 / FINE) as usize {
        if k % EVERY == 0 {
            let [r, rate] = moves(k as f64 * FINE);
            force = 3e4 * (r - u) + 1500.0 * (rate - v);
            seen[0].push(force);
            seen[1].push(u + 2e-6 * random.sample::<f64, _>(StandardNormal));
        }
        v += FINE * (force - VISCOUS * v - resists(u, v)) / MASS;
        u += FINE * v;
    }
    let channel = |(role, unit, values): (Role, &str, Vec<f64>)| Channel {
        role,
        unit: unit.into(),
        time: (0..values.len())
            .map(|k| (k * EVERY) as f64 * FINE)
            .collect(),
        columns: vec![values],
    };
    let [force, position] = seen;
    let channels = [
        (Role::Force, "N", force),
        (Role::MotorPosition, "m", position),
    ];
    let recording = Recording {
        payload: None,
        name: "moves".into(),
        channels: channels.map(channel).into(),
    };
    let model = "kind = \"rigid_axis\"\ninput_hold = \"zero_order\"\nmass = 19.0\nviscous = 45.0\n";
    let model = Model::from_toml(model, "model.toml").unwrap();
    let outcome = diagnose(&model, &[recording], &[], &Options::default(), &|_, _| {});
    outcome.unwrap().diagnosis
}

/// The one effect that is found explains what was held out.
fn is_explained_by(told: &Diagnosis, effect: &str) {
    let found: Vec<_> = told.findings.iter().map(|own| &own.effect).collect();
    assert_eq!(found, [effect], "{}", told.summary);
    assert!(
        told.fit.after.held_out_over_noise < 1.2,
        "{:?}",
        told.fit.after
    );
}

/// A guide that is tight at one place, with three times the axis' own damping there.
#[test]
fn a_tight_place_is_learned_as_damping_over_the_position() {
    let told = diagnosed(|u, v| 130.0 * (-0.5 * ((u - 0.15) / 0.08).powi(2)).exp() * v);
    is_explained_by(&told, "learned_position_damping");
}

/// A ball in a groove of 4 cm, which the knots of a law over the whole travel do not resolve.
#[test]
fn a_detent_is_learned_as_a_force_over_the_position() {
    let told = diagnosed(|u, _| {
        let x = (u - 0.15) / 0.02;
        30.0 * x * (-0.5 * x * x).exp()
    });
    is_explained_by(&told, "learned_position_force");
}

/// A guide that is dry in the middle. A steep tanh in the place of its jump, since this file only has fixed steps.
#[test]
fn friction_that_varies_along_the_way_is_learned_over_the_position() {
    let told = diagnosed(|u, v| {
        let level = 8.0 + 25.0 * (-0.5 * ((u - 0.2) / 0.06).powi(2)).exp();
        level * (v / 2e-4).tanh()
    });
    is_explained_by(&told, "learned_position_friction");
}

/// Bristles that give way over 2 mm after each reversal.
#[test]
fn friction_that_builds_up_over_a_distance_is_named_at_the_drive() {
    let (friction, distance, mut state) = (25.0, 2e-3, 0.0);
    let told = diagnosed(|_, v| {
        state += FINE * v / distance * (1.0 - state * v.signum());
        friction * state
    });
    let found: Vec<_> = told
        .findings
        .iter()
        .map(|own| (&own.effect[..], &own.place[..]))
        .collect();
    assert_eq!(
        found,
        [("presliding_hysteresis", "drive")],
        "{}",
        told.summary
    );
    for (name, truth) in [("friction", friction), ("presliding_distance", distance)] {
        let mut own = told.findings[0].parameters.iter();
        let value = own.find(|own| own.name == name).unwrap().value;
        assert!((value / truth - 1.0).abs() < 0.1, "{name} {value}, {truth}");
    }
}
