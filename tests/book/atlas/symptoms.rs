//! What somebody notices of an effect who only watches the machine.

use super::arm::{Arm, MOVES, stamps};
use super::told::{TOLD, told};
use nalgebra::DVector;
use quell::effects::Place;
use quell::model::Term;
use std::f64::consts::PI;

/// Changes of frequency and of damping from which somebody notices them, relative.
const FREQUENCY: f64 = 2e-3;
const DAMPING: f64 = 0.05;
/// Share of the change that is one thing alone: a shift in time.
const MOSTLY: f64 = 0.8;
/// The same of an error at rest, besides which the motion differs, too.
const HALF: f64 = 0.5;
/// Swings over the first one that are still looked at.
const LEAST: f64 = 0.1;

/// What the standard motion and the [physics](TOLD) of an effect show.
pub const SHIFTED: &str = "comes late or early";
pub const OVER_AMPLITUDE: &str = "frequency changes with amplitude";
pub const OVER_TIME: &str = "frequency changes with pose or over time";

/// What can be noticed in the standard motion.
const SYMPTOMS: [&str; 8] = [
    "stops off target",
    SHIFTED,
    "rings longer than it should",
    "rings shorter than it should",
    "rings slower than it should",
    "rings faster than it should",
    OVER_AMPLITUDE,
    OVER_TIME,
];

/// All symptoms, each once.
pub fn all() -> impl Iterator<Item = &'static str> {
    let told = TOLD.iter().map(|own| own.0);
    SYMPTOMS
        .into_iter()
        .chain(told.filter(|own| !SYMPTOMS.contains(own)))
}

/// The symptoms of an effect: what the standard motion shows, and what its physics tells.
pub fn symptoms(arm: &Arm, term: &Term) -> Vec<&'static str> {
    let (shown, told): (_, Vec<_>) = (shown(arm, term), told(term.effect.name).collect());
    all()
        .filter(|own| shown.contains(own) || told.contains(own))
        .collect()
}

/// Which of the [`SYMPTOMS`] the standard motion shows.
fn shown(arm: &Arm, term: &Term) -> Vec<&'static str> {
    let keys = arm.model.keys();
    let with = arm.shown(0, &keys, std::slice::from_ref(term));
    let plain = arm.shown(0, &keys, &[]);
    let change = &with - &plain;
    let mut found = [false; SYMPTOMS.len()];
    found[0] = share(&change, &at_rest(&change)) > HALF;
    found[1] = !found[0] && share(&change, &rates(&plain)) > MOSTLY;
    // What a sensor does, or something outside, makes the machine ring no other way.
    let of_machine = !matches!(term.place, Place::Sensor | Place::Environment);
    if arm.model.mode().is_some() && of_machine {
        let nominal = rings(&plain);
        let own = rings(&with);
        // A tail that does not swing has stopped before.
        found[3] = own[0].is_none();
        if let ([Some(large), Some(back), _], [Some(first), Some(second), _]) = (own, nominal) {
            let change = |own: f64, nominal: f64| own / nominal - 1.0;
            found[2] = change(large.damping, first.damping) < -DAMPING;
            found[3] = change(large.damping, first.damping) > DAMPING;
            found[4] = change(large.frequency, first.frequency) < -FREQUENCY;
            found[5] = change(large.frequency, first.frequency) > FREQUENCY;
            let there_and_back =
                change(large.frequency, back.frequency) - change(first.frequency, second.frequency);
            found[6] = change(large.falls, first.falls).abs() > FREQUENCY;
            found[7] = !found[6] && there_and_back.abs() > FREQUENCY;
        }
    }
    let pairs = SYMPTOMS.into_iter().zip(found);
    pairs.filter(|own| own.1).map(|own| own.0).collect()
}

/// The samples between the end of a move and the start of the next.
fn tail(index: usize) -> std::ops::Range<usize> {
    let time = stamps();
    let [start, length, _] = MOVES[index];
    let end = MOVES.get(index + 1).map_or(f64::INFINITY, |next| next[0]);
    let at = |instant: f64| time.partition_point(|stamp| *stamp < instant);
    at(start + length)..at(end)
}

/// The mean over each rest, which is 0 elsewhere.
fn at_rest(change: &DVector<f64>) -> DVector<f64> {
    let mut held = DVector::zeros(change.len());
    for index in 0..MOVES.len() {
        let own = tail(index);
        let mean = change.rows(own.start, own.len()).mean();
        held.rows_mut(own.start, own.len()).fill(mean);
    }
    held
}

fn rates(seen: &DVector<f64>) -> DVector<f64> {
    let last = seen.len() - 1;
    DVector::from_fn(seen.len(), |k, _| {
        seen[(k + 1).min(last)] - seen[k.saturating_sub(1)]
    })
}

/// Share of a change that is along another series.
fn share(change: &DVector<f64>, along: &DVector<f64>) -> f64 {
    let square = change.norm_squared() * along.norm_squared();
    match square > 0.0 {
        true => change.dot(along).powi(2) / square,
        false => 0.0,
    }
}

/// How a tail swings.
#[derive(Clone, Copy)]
struct Swings {
    /// Frequency, Hz.
    frequency: f64,
    /// Damping ratio.
    damping: f64,
    /// Frequency of its later half over that of its first.
    falls: f64,
}

/// How the first three tails swing.
fn rings(seen: &DVector<f64>) -> [Option<Swings>; 3] {
    [0, 1, 2].map(|index| tail_rings(seen, index))
}

/// From the turning points: two a period, and the ratio of one swing to the next is `exp(-pi xi)`.
fn tail_rings(seen: &DVector<f64>, index: usize) -> Option<Swings> {
    let own = tail(index);
    let turns: Vec<[f64; 2]> = (own.start + 1..own.end - 1)
        .filter_map(|k| turn(seen[k - 1], seen[k], seen[k + 1], k))
        .collect();
    let swing = |pair: &[[f64; 2]]| (pair[1][1] - pair[0][1]).abs();
    let swings: Vec<f64> = turns.windows(2).map(swing).collect();
    let large = swings
        .iter()
        .take_while(|swing| **swing > LEAST * swings[0]);
    let count = large.count();
    if count < 4 {
        return None;
    }
    let half = |from: usize, to: usize| (to - from) as f64 / (turns[to][0] - turns[from][0]);
    Some(Swings {
        frequency: 0.5 * half(0, count) / stamps()[1],
        damping: (swings[0] / swings[count - 1]).ln() / ((count - 1) as f64 * PI),
        falls: half(count / 2, count) / half(0, count / 2),
    })
}

/// Where and how high a series turns between three samples: the vertex of the parabola through them.
fn turn(before: f64, here: f64, after: f64, index: usize) -> Option<[f64; 2]> {
    let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
    let at = -slope / bend;
    let turns = (here - before) * (after - here) <= 0.0 && at.abs() <= 0.5;
    turns.then_some([index as f64 + at, here + 0.5 * slope * at])
}
