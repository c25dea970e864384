//! Whether a clock is even.

/// Largest deviation of stamps from even ones, as a share of the period, that is ignored: a sine of a tenth of
/// the rate changes by 6 % of its amplitude in it.
const BESIDE: f64 = 0.1;

/// Whether stamps are those of an even clock of this start and period, s, as nearly as it matters.
///
/// # Example
/// ```
/// use quell_recording::are_even;
/// assert!(are_even([5.0, 5.01, 5.0205].into_iter(), [5.0, 0.01]));
/// assert!(!are_even([5.0, 5.01, 5.03].into_iter(), [5.0, 0.01]));
/// ```
pub fn are_even(stamps: impl Iterator<Item = f64>, [start, period]: [f64; 2]) -> bool {
    let off = |(k, stamp): (usize, f64)| (stamp - start - k as f64 * period).abs() / period;
    stamps.enumerate().map(off).fold(0.0, f64::max) <= BESIDE
}
