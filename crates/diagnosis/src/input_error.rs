//! Other draws of the error of a recorded input.

use quell_model::InputError;
use rand::Rng;
use rand_distr::StandardNormal;
use std::ops::Range;

/// The input with another draw of an error added; `None` where there is no error.
pub fn drawn(error: InputError, values: &[f64], random: &mut impl Rng) -> Option<Vec<f64>> {
    match error {
        InputError::None => None,
        InputError::Rounding(step) => Some(rounded_again(values, step, random)),
        InputError::White(noise) => {
            let noisy = |u: &f64| u + noise * random.sample::<f64, _>(StandardNormal);
            Some(values.iter().map(noisy).collect())
        }
    }
}

/// Values rounded again, with the steps at other places.
///
/// The rounding is first undone: between two steps of the record the value went from one edge of its level to
/// the other, at rest it stayed in the middle. Where it moves by more than a step per sample, the errors are
/// independent of each other.
fn rounded_again(values: &[f64], step: f64, random: &mut impl Rng) -> Vec<f64> {
    let phase: f64 = random.random();
    let levels = levels(values, step);
    let mut rounded = Vec::with_capacity(values.len());
    for (index, level) in levels.iter().enumerate() {
        let value = values[level.start];
        let before = index.checked_sub(1).map(|i| &levels[i]);
        let after = levels.get(index + 1);
        let jump = |other: Option<&Range<usize>>| other.map_or(0.0, |o| values[o.start] - value);
        let (from, to) = (jump(before), jump(after));
        let fast = from.abs().max(to.abs()) > 1.5 * step;
        let length = |other: Option<&Range<usize>>| other.map_or(0.0, |o| o.len() as f64);
        let half = 0.5 * level.len() as f64;
        let (enters, leaves) = (length(before).min(half), length(after).min(half));
        for k in level.clone() {
            if fast {
                rounded.push(value + step * (random.random::<f64>() - 0.5));
                continue;
            }
            let since = (k - level.start) as f64 + 0.5;
            let left = level.len() as f64 - since;
            let share = |passed: f64, length: f64| (1.0 - passed / length).max(0.0);
            let place = 0.5 * (from * share(since, enters) + to * share(left, leaves));
            let shifted = (value + place) / step + phase;
            rounded.push(step * (shifted.round() - phase));
        }
    }
    rounded
}

/// Stretches of equal values.
pub fn levels(values: &[f64], step: f64) -> Vec<Range<usize>> {
    let mut levels: Vec<Range<usize>> = Vec::new();
    for (k, value) in values.iter().enumerate() {
        match levels.last_mut() {
            Some(level) if (values[level.start] - value).abs() < 0.5 * step => level.end = k + 1,
            _ => levels.push(k..k + 1),
        }
    }
    levels
}
