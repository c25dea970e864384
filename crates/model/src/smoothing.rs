//! Smoothing of a recorded input.

use super::Model;
use super::effects::Law;
use super::experiment::Experiment;
use super::input_error::InputError;
use super::observation::{LONG, LONGEST, SPARED};
use super::piecewise::{Grid, Hold, RADIANS_A_STEP};
use quell_signal::noise_floor;

/// Refinement at which the error of the integration is negligible beside that of the input.
const FINER: f64 = 4.0;

/// Difference of two predictions, in standard deviations of a sensor's noise, that is not visible. Its square
/// is below the scatter of the chi-squared of a million samples.
const UNSEEN: f64 = 0.1;

/// Distance of knots, in samples, from which smoothing averages: the cubic of a knot then has five samples, of whose
/// error it has `17/35` in the variance (Savitzky and Golay, Analytical Chemistry 36, 1964). The spectral density of
/// the error below the knots' rate is no higher than that of the samples.
const AVERAGED: f64 = 2.0;

/// Samples over which the mean square of what smoothing takes away is formed: so few that a short motion, as of a
/// knock, is not averaged away.
const STRETCH: usize = 50;

/// Ratio of that mean square to the variance of the error that chance exceeds once in a million stretches:
/// chi-squared of [`STRETCH`] degrees of freedom (Wilson and Hilferty, PNAS 17, 1931).
const BY_CHANCE: f64 = 2.26;

impl Experiment {
    /// Smooths an input that was sampled more densely than its motion needs, if no sensor sees the difference, or if
    /// that is no more than the error of the recorded motion: friction would stick and slide on the encoder's
    /// rounding, and an acceleration behind a damper would show the encoder's noise. The first test uses the modes
    /// alone, so that a model with friction gets the same input as the diagnosis that found the friction.
    pub(super) fn smoothen(&mut self, model: &Model) {
        if self.hold != Hold::Spline {
            return;
        }
        let mut modes = model.terms();
        modes.retain(|term| matches!((term.effect.law)(&term.values), Law::Resonance(_)));
        let error = InputError::of_motion(self);
        let (short, mut rough) = (RADIANS_A_STEP / self.fastest(model), None);
        for spacing in [LONG * short, short] {
            let hold = Hold::Smooth(spacing);
            let smooth = |step| Grid::new(&self.input_time, &self.input_values, hold, step);
            let Ok(grid) = smooth(LONGEST * spacing) else {
                return;
            };
            if grid.input.len() as f64 > SPARED * self.input_time.len() as f64 {
                continue;
            }
            let other = |step| {
                let grid = smooth(step).unwrap_or_else(|_| self.grid.clone());
                Self {
                    grid,
                    hold,
                    ..self.clone()
                }
            };
            let rough = rough.get_or_insert_with(|| self.predicted(model, &modes));
            // With fewer samples to a knot it would leave samples out, and the error of the rest would weigh more.
            let averages = spacing >= AVERAGED * self.mean_interval();
            if error.is_some_and(|error| averages && self.is_within(error, &grid))
                // With steps that are short enough for an error below that of the input.
                || self.sees_no_difference(rough, &other(short / FINER).predicted(model, &modes))
            {
                *self = other(short);
                return;
            }
        }
    }

    /// Whether the input differs from a smooth one by no more than an error of this standard deviation.
    fn is_within(&self, deviation: f64, smooth: &Grid) -> bool {
        let mut k = 0;
        let squares = self.input_time.iter().zip(&self.input_values);
        let squares = squares.map(|(&time, value)| {
            while k + 1 < smooth.input.len() && smooth.time[k + 1] <= time {
                k += 1;
            }
            (value - smooth.input[k].at(time - smooth.time[k])[0]).powi(2)
        });
        let squares: Vec<f64> = squares.collect();
        let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
        let mut stretches = squares.chunks(STRETCH);
        stretches.all(|part| mean(part) <= BY_CHANCE * deviation.powi(2))
    }

    /// Whether the difference of two predictions is below the sensors' noise.
    fn sees_no_difference(&self, one: &[Vec<f64>], other: &[Vec<f64>]) -> bool {
        let pairs = one.iter().zip(other);
        let mut unseen = self
            .outputs
            .iter()
            .zip(pairs)
            .map(|(output, (one, other))| {
                let noise = noise_floor(&output.values).standard_deviation;
                let square: f64 = one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
                square < (UNSEEN * noise).powi(2) * one.len() as f64
            });
        unseen.all(|unseen| unseen)
    }
}
