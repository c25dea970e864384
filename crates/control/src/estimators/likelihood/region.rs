//! The allowed range of a linearisation, and its largest step.

use quell_shapers::Mode;

/// Largest step of `ln w` and of `xi` before the track is moved. A smaller one would not reach from one grid
/// point to the next; a larger one would leave the linear range.
pub const TRUST: [f64; 2] = [0.15, 0.08];
/// Damping ratios a linearisation may take.
pub const DAMPING_RANGE: (f64, f64) = (1e-4, 0.7);

/// `ln w` and `xi` of a mode.
pub fn log_point(mode: Mode) -> [f64; 2] {
    [mode.natural_frequency().ln(), mode.damping_ratio()]
}

/// The end of a step from a point, cut to the trusted length.
pub fn trusted(point: [f64; 2], step: [f64; 2], shrink: f64) -> [f64; 2] {
    let excess = (step[0].abs() / TRUST[0])
        .max(step[1].abs() / TRUST[1])
        .max(1.0);
    [0, 1].map(|k| point[k] + shrink * step[k] / excess)
}

/// The range of modes in which the estimator searches.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// Natural frequencies, rad/s.
    frequencies: (f64, f64),
    /// Their logarithms.
    logarithms: (f64, f64),
}

impl Region {
    /// Of frequencies from the lowest to the highest, rad/s, and all dampings.
    pub fn new((low, high): (f64, f64)) -> Self {
        Self {
            frequencies: (low, high),
            logarithms: (low.ln(), high.ln()),
        }
    }

    /// The nearest point within, `ln w` and `xi`.
    pub fn nearest(&self, point: [f64; 2]) -> [f64; 2] {
        let (low, high) = self.logarithms;
        [
            point[0].max(low).min(high),
            point[1].max(DAMPING_RANGE.0).min(DAMPING_RANGE.1),
        ]
    }

    /// The mode at the nearest point within.
    pub fn mode(&self, point: [f64; 2]) -> Option<Mode> {
        let (low, high) = self.frequencies;
        let [log, xi] = self.nearest(point);
        Mode::new(log.exp().max(low).min(high), xi).ok()
    }
}
