//! Where a linearisation may go, and how far at once.

use quell_shapers::Mode;

use crate::estimators::Settings;

/// Largest step of `ln w` and of `xi` before the track is moved: a tenth of the ratio between two
/// grid points less would never reach from one to the next, more would leave its linear range.
pub const TRUST: [f64; 2] = [0.15, 0.08];
/// Damping ratios a linearisation may take.
pub const DAMPING_RANGE: (f64, f64) = (1e-4, 0.7);

/// `ln w` and `xi` of a mode.
pub fn log_point(mode: Mode) -> [f64; 2] {
    [mode.natural_frequency().ln(), mode.damping_ratio()]
}

/// The end of a step cut to the trusted length.
pub fn trusted(mode: Mode, step: [f64; 2], shrink: f64) -> [f64; 2] {
    let excess = (step[0].abs() / TRUST[0])
        .max(step[1].abs() / TRUST[1])
        .max(1.0);
    let point = log_point(mode);
    [0, 1].map(|k| point[k] + shrink * step[k] / excess)
}

/// The mode at a point, moved into the allowed ranges.
pub fn bounded(settings: &Settings, point: [f64; 2]) -> Option<Mode> {
    let (low, high) = settings.frequency_range;
    let w = point[0].exp().max(low).min(high);
    let xi = point[1].max(DAMPING_RANGE.0).min(DAMPING_RANGE.1);
    Mode::new(w, xi).ok()
}
