//! A series without its linear trend.

/// The values without their mean and slope.
pub fn detrended(values: &[f64]) -> Vec<f64> {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let centre = (n - 1.0) / 2.0;
    let (mut product, mut square) = (0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let x = k as f64 - centre;
        product += x * (value - mean);
        square += x * x;
    }
    let slope = product / square.max(1.0);
    let rest = |(k, v): (usize, &f64)| v - mean - slope * (k as f64 - centre);
    values.iter().enumerate().map(rest).collect()
}
