//! Whether a channel carries information: possible values that vary.

use super::Channel;

/// Largest possible magnitude of a value in SI units: the universe has a diameter of 9e26 m.
pub const LARGEST: f64 = 1e27;
/// Smallest possible variation: no length is smaller than Planck's, 1.6e-35 m.
const SMALLEST: f64 = 1e-35;
/// A variation below this share of the largest value is the rounding of numbers written with nine digits.
const ROUNDING: f64 = 1e-9;
/// Most characters of a number before it is written with its power of ten.
const LONGEST: usize = 22;

impl Channel {
    /// Whether a column shows more than one value, beyond the rounding of its numbers.
    ///
    /// # Example
    /// ```
    /// use quell_recording::{Channel, Role};
    /// let (role, unit) = (Role::Torque, "N.m".into());
    /// let mut channel = Channel { role, unit, time: vec![0.0, 0.1], columns: vec![vec![5.0, 5.0]] };
    /// assert!(!channel.varies());
    /// channel.columns[0][1] = 5.1;
    /// assert!(channel.varies());
    /// ```
    pub fn varies(&self) -> bool {
        let largest = |column: &Vec<f64>| column.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let moves = |column: &Vec<f64>| range(column) > SMALLEST.max(ROUNDING * largest(column));
        self.columns.iter().any(moves)
    }

    /// The largest difference of two values of one column, in the channel's unit.
    pub fn travel(&self) -> f64 {
        self.columns.iter().map(|c| range(c)).fold(0.0, f64::max)
    }

    /// The first value or stamp that is impossible: not finite, or above 1e27 in SI units.
    pub fn impossible(&self) -> Option<f64> {
        let values = self.columns.iter().flatten().chain(&self.time);
        // NaN is in no range either.
        let possible = |value: f64| value.abs() <= LARGEST;
        values.copied().find(|value| !possible(*value))
    }
}

/// Greatest minus least value; 0 without any.
pub fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low).max(0.0)
}

/// A number with all its digits, or with its power of ten where these would be too long.
///
/// # Example
/// ```
/// use quell_recording::plain;
/// assert_eq!([plain(0.3), plain(-5.0), plain(1e300)], ["0.3", "-5", "1e300"]);
/// ```
pub fn plain(value: f64) -> String {
    let digits = value.to_string();
    match digits.len() <= LONGEST {
        true => digits,
        false => format!("{value:e}"),
    }
}
