//! Whether what was learned leaves less than no adaptation.
//!
//! Of each move there is what it left, and what the other train would have left, by the model that was fitted to that very
//! move. The sums of both, older moves discounted, say which of the two is followed: the rule of following the leader.
//!
//! Source: N. Cesa-Bianchi, G. Lugosi, Prediction, Learning, and Games, 2006, ch. 2 and 3.

use super::account::amplitude;
use super::fit::Fit;
use super::path::NODES;
use crate::estimators::Sample;

/// Weight of a move against the one after it: some three moves count.
const DISCOUNT: f64 = 0.7;
/// Distance from its end within which the motor side stands, as a part of its way.
const STANDS: f64 = 1e-4;

/// Shares of the unshaped vibration of one move.
#[derive(Clone, Copy, Debug)]
pub struct Outcome {
    /// Without adaptation.
    pub base: f64,
    /// With it.
    pub adapted: f64,
}

/// Sums over moves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Monitor {
    pub(super) base: f64,
    pub(super) adapted: f64,
    pub(super) weight: f64,
}

impl Monitor {
    /// Takes a move. One counts for no more than the whole vibration.
    pub fn take(&mut self, outcome: Outcome) {
        let Outcome { base, adapted } = outcome;
        if !(base.is_finite() && adapted.is_finite()) {
            return;
        }
        self.base = DISCOUNT * self.base + base.min(1.0);
        self.adapted = DISCOUNT * self.adapted + adapted.min(1.0);
        self.weight = DISCOUNT * self.weight + 1.0;
    }

    /// Whether adaptation has left more, by more than the dead band.
    pub fn prefers_base(&self, dead_band: f64) -> bool {
        self.adapted > self.base + dead_band * self.weight
    }
}

/// Amplitude of what rings once the motor side stands, over the slowest mode's first period there, rad.
pub fn ringing(samples: &[Sample], fit: &Fit) -> f64 {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return 0.0;
    };
    let reach = STANDS * (last.motor_position - first.motor_position).abs();
    let away = |s: &Sample| (s.motor_position - last.motor_position).abs() > reach;
    let stands = samples.iter().rposition(away).map_or(0, |k| k + 1);
    let slowest = fit.modes.iter().map(|m| m.point.log_w[NODES - 1].exp());
    let period = std::f64::consts::TAU / slowest.fold(f64::INFINITY, f64::min);
    let from = samples.get(stands).map_or(last.time, |s| s.time);
    let seen: Vec<(f64, f64)> = samples[stands..]
        .iter()
        .zip(&fit.residual[stands..])
        .filter(|(s, r)| s.time <= from + period && r.is_finite())
        .map(|(s, _)| (s.time, s.deformation))
        .collect();
    // White noise is no vibration; what the model does not explain is.
    amplitude(&seen, fit.variance / fit.inflation).unwrap_or(0.0)
}
