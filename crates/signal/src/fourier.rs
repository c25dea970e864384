//! The discrete Fourier transform of real values.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// `X_k = sum_j x_j e^(-2 pi i j k / n)` for `k` from 0 to `n / 2`, of `n` values, which need not be a power of
/// two; empty for no values.
///
/// All crates share this function: a plan is generic, and each crate with a plan of its own would compile every
/// transform again.
///
/// Source: Cooley and Tukey, Mathematics of Computation 19 (1965).
///
/// # Example
/// ```
/// let lines = quell_signal::fourier(vec![1.0, 0.0, -1.0, 0.0]);
/// assert_eq!(lines.iter().map(|line| line.re).collect::<Vec<_>>(), [0.0, 2.0, 0.0]);
/// ```
pub fn fourier(mut values: Vec<f64>) -> Vec<Complex<f64>> {
    if values.is_empty() {
        return Vec::new();
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(values.len());
    let mut lines = transform.make_output_vec();
    // The lengths come from the plan, so that the transform cannot refuse them.
    match transform.process(&mut values, &mut lines) {
        Ok(()) => lines,
        Err(_) => Vec::new(),
    }
}
