//! The maximum of a function of one variable.

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
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut low, mut high) = ((best.0 - step).max(from), (best.0 + step).min(to));
    let mut inner = [high - golden * (high - low), low + golden * (high - low)];
    let mut values = inner.map(&mut f);
    while high - low > 0.02 * step {
        if values[0] >= values[1] {
            high = inner[1];
            inner = [high - golden * (high - low), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + golden * (high - low)];
            values = [values[1], f(inner[1])];
        }
    }
    for k in 0..2 {
        if values[k] > best.1 {
            best = (inner[k], values[k]);
        }
    }
    best
}
