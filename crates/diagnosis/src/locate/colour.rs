//! Noise as a rival explanation: white, or coloured by one pole.

use super::search::maximum;

/// Log-likelihood of a series as noise, the better of white and exponentially correlated. The variance is
/// concentrated out, and constants are left out as in the filter's. Colour costs half the logarithm of the
/// length for its parameter (Schwarz, 1978).
///
/// A residual that noise of one pole explains as well as a missing force does is no evidence for the
/// force. Intervals may be irregular: the correlation over an interval `h` is `exp(-h / tau)`.
pub(super) fn likelihood(time: &[f64], series: &[f64]) -> f64 {
    let n = series.len() as f64;
    if series.len() < 4 {
        return white(series);
    }
    let span = time[time.len() - 1] - time[0];
    let interval = span / (n - 1.0);
    let coloured = maximum((0.2 * interval).ln(), (0.25 * span).ln(), 0.6, |log| {
        pole(time, series, log.exp())
    });
    white(series).max(coloured.1 - 0.5 * n.ln())
}

fn white(series: &[f64]) -> f64 {
    let n = series.len() as f64;
    let squares: f64 = series.iter().map(|x| x * x).sum();
    -0.5 * n * (squares / n).max(f64::MIN_POSITIVE).ln()
}

fn pole(time: &[f64], series: &[f64], constant: f64) -> f64 {
    let n = series.len() as f64;
    let (mut squares, mut logs) = (series[0] * series[0], 0.0);
    let (mut last, mut correlation, mut variance) = (f64::NAN, 0.0, 1.0);
    for k in 1..series.len() {
        let interval = time[k] - time[k - 1];
        if interval != last {
            last = interval;
            correlation = (-interval / constant).exp();
            variance = (1.0 - correlation * correlation).max(1e-12);
        }
        let innovation = series[k] - correlation * series[k - 1];
        squares += innovation * innovation / variance;
        logs += variance.ln();
    }
    -0.5 * n * (squares / n).max(f64::MIN_POSITIVE).ln() - 0.5 * logs
}
