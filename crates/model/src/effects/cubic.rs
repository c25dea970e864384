//! Interpolation between samples: a cubic through values and rates.

/// Values and rates: at each sample the slope of the parabola through it and its neighbours.
pub(super) fn with_slopes(time: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    let chord = |k: usize| (values[k + 1] - values[k]) / (time[k + 1] - time[k]);
    let last = values.len().saturating_sub(1);
    let slope = |k: usize| match k {
        _ if last == 0 => 0.0,
        0 => chord(0),
        k if k == last => chord(last - 1),
        k => {
            let (before, after) = (time[k] - time[k - 1], time[k + 1] - time[k]);
            (chord(k - 1) * after + chord(k) * before) / (before + after)
        }
    };
    (0..values.len()).map(|k| [values[k], slope(k)]).collect()
}

/// Coefficients of the cubic through values and rates at both ends of an interval of length `h`, in
/// rising powers of the time since its start.
pub(super) fn cubic_coefficients(before: [f64; 2], after: [f64; 2], h: f64) -> [f64; 4] {
    let slope = (after[0] - before[0]) / h;
    let c2 = (3.0 * slope - 2.0 * before[1] - after[1]) / h;
    let c3 = (before[1] + after[1] - 2.0 * slope) / (h * h);
    [before[0], before[1], c2, c3]
}
