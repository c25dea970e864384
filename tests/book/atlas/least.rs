//! The least size of an effect that a sensor sees, above a noise that is stated.

use super::arm::{Arm, without};
use nalgebra::DVector;
use quell::model::Term;

/// Standard deviation of the noise of each kind of sensor, white, in its unit and in words: a joint's tip sensor, a small
/// accelerometer, a linear encoder.
const NOISES: [(&str, f64, &str); 3] = [
    ("link_position", 1e-5, "10 urad"),
    ("link_acceleration", 0.05, "0.05 rad/s^2"),
    ("motor_position", 1e-6, "1 um"),
];
/// Log evidence from which an effect is told, and the temperature of samples that are not independent: those of the
/// diagnosis.
const EVIDENCE: f64 = 10.0;
const TEMPERATURE: f64 = 4.0;
/// Steps over the sizes: each is this factor, and is halved so often, down to 9 %.
const STEP: f64 = 4.0;
const HALVINGS: u32 = 4;
/// Steps until an effect counts as unseen: sizes of 1e-12 and 1e12 of the typical one.
const STEPS: u32 = 20;

/// Noise of a sensor by its channel's name: in its unit, and as a reader is told it.
pub fn noise(channel: &str) -> (f64, &'static str) {
    let known = NOISES.iter().find(|own| own.0 == channel);
    let known = known.expect("each sensor of the atlas has a noise");
    (known.1, known.2)
}

/// Which sizes a sensor sees.
pub enum Seen {
    /// From this one on: 0 where it sees all, infinite where it sees none.
    From(f64),
    /// Up to this one, as of a limit that acts where it is small: infinite where it sees all, 0 where it sees none.
    UpTo(f64),
}

/// The sizes of a term's effect that a sensor of the arm sees, its other parameters as they are.
pub fn seen(arm: &Arm, sensor: usize, term: &Term) -> Seen {
    let keys = arm.model.keys();
    let (plain, refit) = (arm.shown(sensor, &keys, &[]), arm.refit(sensor));
    let channel = arm.sensors[sensor].outputs[0].channel.name();
    // N r^2 / (2 T n^2) is the evidence of a misfit with the root mean square r.
    let needed = noise(channel).0 * (2.0 * TEMPERATURE * EVIDENCE).sqrt();
    let index = term.effect.size();
    let typical = term.values[index];
    let misfit = |factor: f64| -> f64 {
        let mut term = term.clone();
        term.values[index] = typical * factor;
        let change: DVector<f64> = arm.shown(sensor, &keys, &[term]) - &plain;
        without(&change, &refit).norm()
    };
    // A limit is seen where it is small: the first pair of sizes that differ tells.
    let factors = (1..=STEPS).map(|step| STEP.powf(f64::from(step)));
    let mut pairs = factors.map(|own| [misfit(1.0 / own), misfit(own)]);
    let shrinks = pairs
        .find(|[small, large]| small != large)
        .is_some_and(|[small, large]| small > large);
    // In powers of the step towards sizes that are seen better.
    let factor = |power: f64| STEP.powf(if shrinks { -power } else { power });
    let size = typical * factor(edge(|power| misfit(factor(power)) >= needed));
    match shrinks {
        true => Seen::UpTo(size),
        false => Seen::From(size),
    }
}

/// Where something begins to hold, from the typical size at 0 on; infinite where it never does, or always.
fn edge(holds: impl Fn(f64) -> bool) -> f64 {
    let mut steps = (1..=STEPS).map(f64::from);
    let found = match holds(0.0) {
        true => steps
            .find(|back| !holds(-back))
            .map_or(f64::NEG_INFINITY, |back| 1.0 - back),
        false => steps.find(|on| holds(*on)).unwrap_or(f64::INFINITY),
    };
    let (mut low, mut high) = (found - 1.0, found);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match found.is_finite() && holds(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    high
}
