//! Stretches of time in which the residual is strong.

use super::correlation::length;
use super::{MOST, Residual};

/// Stretches in which the chi-squared over a moving window exceeds both the noise and a quarter of its greatest
/// excess. At most eight are returned, those of most excess, in order of time.
pub(super) fn strong(residual: &Residual, window: f64) -> Vec<[f64; 2]> {
    let (time, n) = (residual.time, residual.time.len());
    let variance = residual.noise_std * residual.noise_std;
    let correlated = length(time, residual.residual).samples;
    let mut sums = vec![0.0];
    for r in residual.residual {
        sums.push(sums[sums.len() - 1] + r * r / variance - 1.0);
    }
    let (mut low, mut high) = (0, 0);
    let density: Vec<(f64, f64)> = (0..n)
        .map(|k| {
            while time[low] < time[k] - 0.5 * window {
                low += 1;
            }
            while high < n && time[high] <= time[k] + 0.5 * window {
                high += 1;
            }
            let count = (high - low) as f64;
            // 3.72 standard deviations of a mean of squares: one in ten thousand.
            (
                (sums[high] - sums[low]) / count,
                3.72 * (2.0 * correlated / count).sqrt(),
            )
        })
        .collect();
    let quarter = 0.25 * density.iter().map(|d| d.0).fold(0.0, f64::max);
    let mut found: Vec<(usize, usize)> = Vec::new();
    for k in (0..n).filter(|&k| density[k].0 > density[k].1.max(quarter)) {
        match found.last_mut() {
            Some(open) if time[k] - time[open.1] <= window => open.1 = k,
            _ => found.push((k, k)),
        }
    }
    let excess = |s: &(usize, usize)| sums[s.1 + 1] - sums[s.0];
    found.sort_by(|a, b| excess(b).total_cmp(&excess(a)));
    found.truncate(MOST);
    found.sort_unstable();
    found.iter().map(|&(a, b)| [time[a], time[b]]).collect()
}
