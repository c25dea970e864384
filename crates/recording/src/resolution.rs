//! The resolution of numbers in files. Finer digits say nothing of a machine: they are the rounding of the
//! arithmetic that made the number.

use super::Recording;

/// Resolution of stamps, parts of a second.
const STAMPS: f64 = 1e9;
/// Resolution of values, parts of an SI unit: below that of any sensor.
const VALUES: f64 = 1e12;
/// Digits of the largest value of a column.
const DIGITS: f64 = 12.0;
/// Steps of the resolution from which on a number stays as it is: 2^50. A float has 53 bits, so that below it the
/// nearest step is certain.
const MOST_STEPS: f64 = 1_125_899_906_842_624.0;

/// A stamp to 1e-9 s.
///
/// # Example
/// ```
/// assert_eq!(quell_recording::to_nanosecond(10.131999999999328), 10.132);
/// ```
pub fn to_nanosecond(stamp: f64) -> f64 {
    rounded(stamp, STAMPS)
}

/// A value in SI to 1e-12 of its unit. Zero has no sign.
///
/// # Example
/// ```
/// use quell_recording::to_resolution;
/// assert_eq!([-3.04e-226, 0.10000000000000009].map(to_resolution), [0.0, 0.1]);
/// ```
pub fn to_resolution(value: f64) -> f64 {
    rounded(value, VALUES)
}

/// A value of an unknown unit to 1e-12 of `scale`, the largest value of its column. The power of ten above
/// `scale` counts, so that the last digit is a decimal one.
///
/// # Example
/// ```
/// use quell_recording::to_scale;
/// assert_eq!(to_scale(0.09561698657751677, 0.5), 0.095616986578);
/// assert_eq!(to_scale(95.61698657751677e-12, 0.5e-9), 95.616986578e-12);
/// ```
pub fn to_scale(value: f64, scale: f64) -> f64 {
    match scale.abs().log10().ceil() {
        above if above.is_finite() => rounded(value, 10_f64.powf(DIGITS - above)),
        _ => value,
    }
}

impl Recording {
    /// The recording without digits that are finer than the resolution. It is for what a program computed or
    /// measured; a recording that is only copied keeps every digit.
    #[must_use]
    pub fn to_resolution(mut self) -> Self {
        for channel in &mut self.channels {
            let stamps = channel.time.iter_mut();
            stamps.for_each(|stamp| *stamp = to_nanosecond(*stamp));
            let values = channel.columns.iter_mut().flatten();
            values.for_each(|value| *value = to_resolution(*value));
        }
        self
    }
}

/// Rounded to a number of parts of one. A number that has no finer digits stays as it is.
fn rounded(value: f64, parts: f64) -> f64 {
    match (value * parts).abs() < MOST_STEPS {
        true => (value * parts).round() / parts + 0.0,
        false => value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn no_value_changes_by_more_than_half_the_resolution(value: f64) {
            prop_assume!(value.is_finite());
            let near = |rounded: f64, step: f64| {
                (rounded - value).abs() <= 0.5 * step + f64::EPSILON * value.abs()
            };
            prop_assert!(near(to_nanosecond(value), 1e-9));
            prop_assert!(near(to_resolution(value), 1e-12));
            prop_assert_eq!(to_resolution(to_resolution(value)), to_resolution(value));
        }

        #[test]
        fn numbers_of_a_person_stay_as_they_are(whole in -1_000_000_000..1_000_000_000_i64, digits in 0..9_i32) {
            let value = whole as f64 / 10_f64.powi(digits);
            prop_assert_eq!(to_resolution(value), value);
            prop_assert_eq!(to_nanosecond(value), value);
            prop_assert_eq!(to_scale(value, value), value);
        }
    }
}
