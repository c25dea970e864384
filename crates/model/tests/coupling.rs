//! The coupling of a free motor side to its measured motion.

use quell_model::effects::{EFFECTS, Place};
use quell_model::{Departure, Experiment, Model, StartComponent, Term, simulate};
use quell_recording::{Channel, Recording, Role};

/// An axis of this mass that stands still at 0.5 m, while a force is recorded.
fn still(mass: f64, force: f64) -> (Model, Experiment) {
    let text = format!("kind = \"rigid_axis\"\nmass = {mass}\nviscous = 0.1\n");
    let model = Model::from_toml(&text, "model.toml").unwrap();
    let channel = |role, unit: &str, value: f64| Channel {
        role,
        unit: unit.into(),
        time: (0..1000).map(|k| 0.002 * f64::from(k)).collect(),
        columns: vec![vec![value; 1000]],
    };
    let recording = Recording {
        payload: None,
        name: "still".into(),
        channels: vec![
            channel(Role::Force, "N", force),
            channel(Role::MotorPosition, "m", 0.5),
        ],
    };
    let experiment = Experiment::new(&model, &recording).unwrap();
    (model, experiment)
}

/// A recorded force that the axis, which stands still, did not feel, moves the coupled simulation by `F / (m w^2)`, and
/// without a coupling out of sight.
#[test]
fn val_a_wrong_force_errs_by_itself_over_the_coupling() {
    let (mass, force, rate) = (4.0, 3.0, 20.0);
    let (model, experiment) = still(mass, force);
    let end = |experiment: &Experiment| {
        let start = Departure::default();
        let simulated = simulate(model.kind, &model.keys(), &[], experiment, &start);
        simulated.trace.motor.last().unwrap()[0] - 0.5
    };
    let coupled = end(&experiment.coupled(rate));
    let expected = force / (mass * rate * rate);
    assert!(
        (coupled / expected - 1.0).abs() < 1e-6,
        "{coupled} {expected}"
    );
    let mut free = experiment;
    free.windows.clear();
    assert!(end(&free) > 100.0 * expected);
}

/// What a motor side that friction holds is wrong by fades as `exp(-w t)`, and the friction still holds it.
#[test]
fn val_friction_that_holds_forgets_its_error() {
    let (rate, away) = (5.0, 1e-3);
    let (model, experiment) = still(4.0, 3.0);
    let friction = EFFECTS.iter().find(|own| own.name == "coulomb_friction");
    let terms = [Term::new(friction.unwrap(), Place::Drive, vec![10.0])];
    let mut start = Departure::default();
    start[StartComponent::MotorPosition] = away;
    let coupled = experiment.coupled(rate);
    let trace = simulate(model.kind, &model.keys(), &terms, &coupled, &start).trace;
    for (time, [position, velocity, _]) in trace.time.iter().zip(&trace.motor) {
        let expected = away * (-rate * time).exp();
        assert!(
            (position - 0.5 - expected).abs() < 1e-9 * away,
            "at {time} s"
        );
        assert_eq!(*velocity, 0.0);
    }
}
