//! Laws that no name of the catalogue has.

use crate::concealed::{conceal, learned};
use crate::machines::joint;
use crate::outcome;
use std::f64::consts::TAU;

/// A ball screw, softest between its bearings and with a bump that no named law has: told as a curve, and so well that the
/// better model leaves only noise.
#[test]
fn a_stiffness_over_the_position_is_learned() {
    let machine = joint();
    let screw = |x: f64| -0.5 * x * (1.0 - x) + 0.04 * (1.7 * TAU * x).sin();
    let term = learned(&machine, "learned_position_stiffness", screw);
    let said = outcome(&machine, &[conceal(&machine, term, 1).recording]).diagnosis;
    println!("{}", said.summary);
    let told: Vec<&str> = said.findings.iter().map(|own| &*own.effect).collect();
    assert_eq!(told, ["learned_position_stiffness"]);
    assert!(said.fit.after.held_out_over_noise < 1.1);
}

/// A stiffness that changed during a recording belongs to it, and its mean to the machine: the better model predicts no
/// worse than the one before.
#[test]
fn a_change_over_time_leaves_the_machine_at_its_mean() {
    let machine = joint();
    let change = |t: f64| -0.25 + 0.08 * (1.3 * TAU * t).sin();
    let term = learned(&machine, "learned_drift", change);
    let outcome = outcome(&machine, &[conceal(&machine, term, 1).recording]);
    let said = &outcome.diagnosis;
    println!("{}", said.summary);
    let told: Vec<&str> = said.findings.iter().map(|own| &*own.effect).collect();
    assert_eq!(told, ["learned_drift"]);
    assert!(outcome.model.effects.is_empty());
    let [before, alone] = [said.fit.before, said.fit.model_alone.unwrap()];
    assert!(
        alone.train_rms < 1.01 * before.train_rms,
        "{alone:?} after {before:?}"
    );
}
