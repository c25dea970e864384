//! The error of the recorded input: an encoder's rounding, or noise.

use quell_model::Experiment;
use quell_recording::Role;
use quell_recording::health::{noise_std, quantum};
use rand::Rng;
use rand_distr::StandardNormal;
use std::ops::Range;

/// Greatest ratio of noise to rounding step at which the rounding explains the noise. A uniform error has `1 /
/// sqrt 12` of the step, an error that the motion repeats at most half of it.
const ROUNDED: f64 = 0.5;

/// The part of a recorded input that did not drive the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InputError {
    /// Nothing: the machine was given these very numbers.
    None,
    /// Rounding to steps of this size.
    Rounding(f64),
    /// White noise of this standard deviation.
    White(f64),
}

impl InputError {
    /// The error of an experiment's input. The noise of a force or a current drove the machine, so that only
    /// the rounding of its record is an error.
    pub fn of(experiment: &Experiment) -> Self {
        let values = &experiment.input_values;
        let noise = noise_std(values).unwrap_or(0.0);
        let measured = matches!(
            experiment.input,
            Role::MotorPosition | Role::LinkPosition | Role::Deformation
        );
        match quantum(values) {
            _ if experiment.input == Role::CommandPosition => Self::None,
            Some(step) if noise <= ROUNDED * step || !measured => Self::Rounding(step),
            _ if measured && noise > 0.0 => Self::White(noise),
            _ => Self::None,
        }
    }

    /// Standard deviation of the error where it is white noise.
    pub fn white(self) -> Option<f64> {
        match self {
            Self::White(deviation) => Some(deviation),
            Self::None | Self::Rounding(_) => None,
        }
    }

    /// The input with another draw of this error added; `None` where there is no error.
    pub fn draw(self, values: &[f64], random: &mut impl Rng) -> Option<Vec<f64>> {
        match self {
            Self::None => None,
            Self::Rounding(step) => Some(rounded_again(values, step, random)),
            Self::White(noise) => Some(
                values
                    .iter()
                    .map(|u| u + noise * random.sample::<f64, _>(StandardNormal))
                    .collect(),
            ),
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
