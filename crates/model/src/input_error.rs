//! The error of the recorded input: an encoder's rounding, or noise.

use super::experiment::Experiment;
use quell_recording::Role;
use quell_recording::health::{noise_std, quantum};

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
    /// The integral of white noise: a random walk whose steps, from sample to sample, have this standard deviation.
    Walk(f64),
    /// What a smoother left of noise and took away of the motion, of this standard deviation; its correlation is that of
    /// [`Experiment::input_smoothed`].
    Smoothed(f64),
}

impl InputError {
    /// The error of an experiment's input. The noise of a force or a current drove the machine, so that only
    /// the rounding of its record is an error.
    pub fn of(experiment: &Experiment) -> Self {
        if let Some(response) = &experiment.input_smoothed {
            return Self::Smoothed(response.iter().map(|own| own * own).sum::<f64>().sqrt());
        }
        Self::of_values(experiment)
    }

    /// The error that the values show; those of a smoothed position show hardly any.
    fn of_values(experiment: &Experiment) -> Self {
        if let Some(step) = experiment.input_walk {
            return match step > 0.0 {
                true => Self::Walk(step),
                false => Self::None,
            };
        }
        let values = &experiment.input_values;
        let noise = noise_std(values).unwrap_or(0.0);
        let measured = is_measured_motion(experiment.input);
        match quantum(values) {
            _ if experiment.input == Role::CommandPosition => Self::None,
            Some(step) if noise <= ROUNDED * step || !measured => Self::Rounding(step),
            _ if measured && noise > 0.0 => Self::White(noise),
            _ => Self::None,
        }
    }

    /// Standard deviation of what is drawn anew with each sample, where the error is noise.
    pub fn of_noise(self) -> Option<f64> {
        match self {
            Self::White(deviation) | Self::Walk(deviation) => Some(deviation),
            Self::None | Self::Rounding(_) | Self::Smoothed(_) => None,
        }
    }

    /// Standard deviation of one sample of a measured motion; of a rounded one the greatest, at the edge of a step.
    pub(super) fn of_motion(experiment: &Experiment) -> Option<f64> {
        if !is_measured_motion(experiment.input) {
            return None;
        }
        match Self::of_values(experiment) {
            Self::None | Self::Smoothed(_) => None,
            Self::Rounding(step) => Some(0.5 * step),
            Self::White(deviation) | Self::Walk(deviation) => Some(deviation),
        }
    }
}

fn is_measured_motion(input: Role) -> bool {
    matches!(
        input,
        Role::MotorPosition | Role::LinkPosition | Role::Deformation
    )
}
