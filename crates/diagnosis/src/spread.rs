//! Standard deviation of a series.

/// `sqrt(mean((v - mean(v))^2))`, in the unit of the values; not a number where there are none.
pub fn spread(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}
