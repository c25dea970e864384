//! Whether adaptation leaves less vibration than the train without it.
//!
//! For each move the residual of the train in force is measured, and that of the other train is predicted by
//! the model fitted to the same move. The discounted sums over the moves decide which of the two is followed:
//! the rule "follow the leader". The measured residual contains sensor noise: a difference within that noise
//! decides nothing.
//!
//! Source: N. Cesa-Bianchi, G. Lugosi, Prediction, Learning, and Games, 2006, ch. 2 and 3.

use super::account::amplitude;
use super::fit::Fit;
use super::path::NODES;
use crate::estimators::Sample;

/// Factor of a move's weight with each later move: about three moves count.
const DISCOUNT: f64 = 0.7;
/// Standard deviations of the noise within which the motor side counts as standing. The link does not follow
/// fast motion of the motor side, so that it appears in the deformation and would be taken for vibration. If
/// the noise is the rounding of an encoder, its step is `sqrt(12)` of them.
const STANDS: f64 = 3.5;
/// Standard deviations of a difference that chance does not explain.
const CERTAIN: f64 = 2.0;

/// Residuals of one move as shares of its unshaped vibration.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Without adaptation.
    pub base: f64,
    /// With it.
    pub adapted: f64,
    /// One standard deviation of the measured one.
    pub std: f64,
}

/// Sums over moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Monitor {
    pub(super) base: f64,
    pub(super) adapted: f64,
    pub(super) weight: f64,
    /// Variance of the difference of the sums.
    pub(super) variance: f64,
}

impl Monitor {
    /// Adds a move. A residual counts as at most the whole vibration.
    pub fn take(&mut self, outcome: Outcome) {
        let Outcome { base, adapted, std } = outcome;
        if !(base.is_finite() && adapted.is_finite() && std.is_finite()) {
            return;
        }
        self.base = DISCOUNT * self.base + base.min(1.0);
        self.adapted = DISCOUNT * self.adapted + adapted.min(1.0);
        self.weight = DISCOUNT * self.weight + 1.0;
        self.variance = DISCOUNT * DISCOUNT * self.variance + std.min(1.0).powi(2);
    }

    /// Whether adaptation has left more, by more than the dead band and the noise.
    pub fn prefers_base(&self, dead_band: f64) -> bool {
        let chance = CERTAIN * self.variance.sqrt();
        self.adapted > self.base + dead_band * self.weight + chance
    }
}

/// Amplitude of the vibration after the motor side has come to rest, over the slowest mode's first period, and
/// one standard deviation of it, rad.
pub fn ringing(samples: &[Sample], fit: &Fit) -> (f64, f64) {
    let Some(last) = samples.last() else {
        return (0.0, 0.0);
    };
    // White noise is no vibration; the unexplained part of the model is.
    let noise = fit.variance / fit.inflation;
    let reach = STANDS * noise.sqrt();
    let away = |s: &Sample| (s.motor_position - last.motor_position).abs() > reach;
    let stands = samples.iter().rposition(away).map_or(0, |k| k + 1);
    let slowest = fit.modes.iter().map(|m| m.point.log_w[NODES - 1].exp());
    let period = std::f64::consts::TAU / slowest.fold(f64::INFINITY, f64::min);
    let from = samples.get(stands).map_or(last.time, |s| s.time);
    let seen = samples[stands..].iter().zip(&fit.residual[stands..]);
    let seen: Vec<&Sample> = seen
        .filter(|(s, r)| s.time <= from + period && r.is_finite())
        .map(|(s, _)| s)
        .collect();
    // Remaining motion of the motor side is no vibration of the link either.
    let n = seen.len().max(1) as f64;
    let mean = seen.iter().map(|s| s.motor_position).sum::<f64>() / n;
    let moved = seen.iter().map(|s| (s.motor_position - mean).powi(2));
    let noise = noise + moved.sum::<f64>() / n;
    let seen: Vec<(f64, f64)> = seen.iter().map(|s| (s.time, s.deformation)).collect();
    let left = amplitude(&seen, noise).unwrap_or(0.0);
    (left, doubt(left, noise, seen.len()))
}

/// One standard deviation of an amplitude `a` measured over `n` samples with white noise of this variance. Its
/// square has the standard deviation of twice the mean square, `2 sqrt(2 s^4 / n + 2 a^2 s^2 / n)`.
fn doubt(amplitude: f64, noise: f64, n: usize) -> f64 {
    let square = amplitude * amplitude;
    let std = 2.0 * (2.0 * noise * (noise + square) / n.max(1) as f64).sqrt();
    let at = |side: f64| (square + side * std).max(0.0).sqrt();
    0.5 * (at(1.0) - at(-1.0))
}
