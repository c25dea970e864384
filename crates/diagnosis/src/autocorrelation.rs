//! The autocorrelation of a residual, as a number of samples.

use nalgebra::DVector;

/// Most lags over which a correlation is summed.
const LAGS: usize = 1000;

/// `sum rho_k^2` over all lags of a series' autocorrelation, less its expectation by chance, at least 1. It is
/// the factor by which the variance of the mean square exceeds that of as many independent samples.
///
/// Source: Bartlett, J. Royal Statistical Society B 8 (1946).
pub fn correlation(series: &DVector<f64>) -> f64 {
    let values = series.as_slice();
    let (n, square) = (values.len(), series.norm_squared());
    let at = |lag: usize| {
        let product: f64 = values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum();
        (product / square).powi(2) - 1.0 / n as f64
    };
    let sum: f64 = (1..LAGS.min(n / 4)).map(at).sum();
    let whole = 1.0 + 2.0 * sum;
    if whole.is_finite() {
        whole.max(1.0)
    } else {
        1.0
    }
}
