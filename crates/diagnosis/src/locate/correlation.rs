//! Correlation time of a series.

/// Autocorrelation of a series, approximated by an exponential.
#[derive(Clone, Copy, Debug)]
pub(super) struct Memory {
    /// Time constant, s; 0 for white noise.
    pub constant: f64,
    /// Number of samples per independent value, at least 1: the sum of the correlation over all lags.
    pub samples: f64,
}

/// The time at which the autocorrelation falls below `1 / e`, found over lags in geometric steps.
pub(super) fn length(time: &[f64], series: &[f64]) -> Memory {
    let n = series.len();
    let none = Memory {
        constant: 0.0,
        samples: 1.0,
    };
    if n < 4 {
        return none;
    }
    let interval = (time[n - 1] - time[0]) / (n - 1) as f64;
    let mean = series.iter().sum::<f64>() / n as f64;
    let at = |lag: usize| -> f64 {
        let products = series[lag..]
            .iter()
            .zip(series)
            .map(|(a, b)| (a - mean) * (b - mean));
        products.sum::<f64>() / (n - lag) as f64
    };
    let variance = at(0);
    if variance <= 0.0 {
        return none;
    }
    let target = (-1f64).exp();
    let (mut lag, mut before) = (1, (0.0, 1.0));
    while lag <= n / 3 {
        let value = at(lag) / variance;
        if value < target {
            let share = (before.1 - target) / (before.1 - value);
            let steps = before.0 + share * (lag as f64 - before.0);
            // Between lags 0 and 1 a straight line would give white noise a length of 0.63.
            let steps = if lag == 1 {
                -1.0 / value.max(1e-3).ln()
            } else {
                steps
            };
            return Memory {
                constant: steps * interval,
                samples: sum(steps),
            };
        }
        before = (lag as f64, value);
        lag = (lag + 1).max(lag * 5 / 4);
    }
    let steps = n as f64 / 3.0;
    Memory {
        constant: steps * interval,
        samples: sum(steps),
    }
}

/// `sum over all k of exp(-|k| / c) = coth(1 / 2c)`.
fn sum(steps: f64) -> f64 {
    1.0 / (0.5 / steps.max(1e-3)).tanh()
}
