//! The error of a recorded input: how much of it is noise, and other draws of it.

use quell_model::InputError;
use rand::Rng;
use rand_distr::StandardNormal;
use std::ops::Range;

/// Standard deviation of the part of an error that is drawn anew with each sample. Of a rounding that is the part where the
/// values move by more than a step per sample, a share `p` of all: its mean variance is `p q^2 / 12`.
///
/// Source: Widrow and Kollar, Quantization Noise (2008), chapters 4 and 5.
pub fn noise(error: InputError, values: &[f64]) -> Option<f64> {
    match error {
        InputError::None => None,
        InputError::White(deviation)
        | InputError::Walk(deviation)
        | InputError::Smoothed(deviation) => Some(deviation),
        InputError::Rounding(step) => {
            let levels = levels(values, step);
            let fast =
                |&index: &usize| is_fast(&levels[index], jumps(values, &levels, index), step);
            let count = (0..levels.len()).filter(fast).count();
            let share = count as f64 / values.len().max(1) as f64;
            (count > 0).then(|| step * (share / 12.0).sqrt())
        }
    }
}

/// The input with another draw of an error added; `None` where there is no error. That of a smoothed input is a part of the
/// noise of the outputs.
pub fn drawn(error: InputError, values: &[f64], random: &mut impl Rng) -> Option<Vec<f64>> {
    match error {
        InputError::None | InputError::Smoothed(_) => None,
        InputError::Rounding(step) => Some(rounded_again(values, step, random)),
        InputError::White(noise) => {
            let noisy = |u: &f64| u + noise * random.sample::<f64, _>(StandardNormal);
            Some(values.iter().map(noisy).collect())
        }
        InputError::Walk(step) => {
            let mut off = 0.0;
            let noisy = |u: &f64| {
                off += step * random.sample::<f64, _>(StandardNormal);
                u + off
            };
            Some(values.iter().map(noisy).collect())
        }
    }
}

/// Whether a level of these [`jumps`] is passed within a sample, by more than a step.
fn is_fast(level: &Range<usize>, jumps: [f64; 2], step: f64) -> bool {
    level.len() == 1 && jumps.iter().any(|jump| jump.abs() > 1.5 * step)
}

/// Changes from the level before to this one, negative, and from this one to the next; 0 where there is none.
fn jumps(values: &[f64], levels: &[Range<usize>], index: usize) -> [f64; 2] {
    let value = values[levels[index].start];
    let before = index.checked_sub(1).map(|i| &levels[i]);
    let jump = |other: Option<&Range<usize>>| other.map_or(0.0, |o| values[o.start] - value);
    [jump(before), jump(levels.get(index + 1))]
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
        let [from, to] = jumps(values, &levels, index);
        let fast = is_fast(level, [from, to], step);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A ramp of many steps a sample is rounded with errors of `q^2 / 12`; where it is still there is no noise.
    #[test]
    fn val_rounding_is_noise_where_it_moves() {
        let step = 1e-3;
        let rounded = |value: f64| (value / step).round() * step;
        let ramp = |k: u32| 7.381e-3 * f64::from(k);
        let values: Vec<f64> = (0..4000).map(|k| rounded(ramp(k.min(1000)))).collect();
        let errors = (0..1000).map(|k| (rounded(ramp(k)) - ramp(k)).powi(2));
        let truth = (errors.sum::<f64>() / 4000.0).sqrt();
        let found = noise(InputError::Rounding(step), &values).unwrap();
        assert!((found / truth - 1.0).abs() < 0.03, "{found} {truth}");
        let slow: Vec<f64> = (0..4000).map(|k| rounded(0.01 * ramp(k))).collect();
        assert_eq!(noise(InputError::Rounding(step), &slow), None);
    }
}
