//! The maximum of a function of one variable.

use quell_signal::golden_section;

/// Golden sections of two steps that leave a fiftieth of one.
const SECTIONS: usize = 10;

/// Where `f` is greatest between `from` and `to`, and its value: a scan with this step, then golden
/// sections of the three points around the best to a fiftieth of the step.
pub(super) fn maximum(from: f64, to: f64, step: f64, mut f: impl FnMut(f64) -> f64) -> (f64, f64) {
    let mut best = (from, f64::NEG_INFINITY);
    let count = ((to - from) / step).round().max(1.0) as usize;
    for k in 0..=count {
        let x = from + (to - from) * k as f64 / count as f64;
        let value = f(x);
        if value > best.1 {
            best = (x, value);
        }
    }
    let ends = [(best.0 - step).max(from), (best.0 + step).min(to)];
    let (x, negative) = golden_section(|x| -f(x), ends, SECTIONS);
    if -negative > best.1 {
        best = (x, -negative);
    }
    best
}
