//! Numbers for display, in preferred units.

use quell_page::{digits, number};
use quell_recording::Preferred;

/// Display unit of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// The factor of the values.
    pub factor: f64,
    /// Their unit then; empty for a number.
    pub unit: String,
}

impl From<Preferred> for Shown {
    fn from(Preferred { factor, unit, .. }: Preferred) -> Self {
        Self { factor, unit }
    }
}

impl Shown {
    /// For values whose unit is in their name.
    pub fn plain() -> Self {
        Self {
            factor: 1.0,
            unit: String::new(),
        }
    }

    /// For values of this unit whose largest has this size.
    pub fn of(unit: &str, size: f64) -> Self {
        Preferred::of(unit, size).into()
    }

    /// Values as they are shown.
    pub fn values(&self, values: &[f64]) -> Vec<f64> {
        values.iter().map(|value| value * self.factor).collect()
    }

    /// One number to three digits, without its unit.
    pub fn number(&self, value: f64) -> String {
        number(digits(value * self.factor, 3))
    }

    /// A value rounded to the accuracy of its interval: two digits of half the interval's width.
    pub fn quoted(&self, value: f64, interval: [f64; 2]) -> String {
        let half = 0.5 * (interval[1] - interval[0]).abs() * self.factor;
        to_digits_of(value * self.factor, half)
    }

    /// `low to high`, rounded to its accuracy.
    pub fn interval(&self, interval: [f64; 2]) -> String {
        let [low, high] = interval.map(|edge| self.quoted(edge, interval));
        format!("{low} to {high}")
    }
}

/// `value` to two significant digits of `spread`, with trailing zeros.
fn to_digits_of(value: f64, spread: f64) -> String {
    if !(spread.is_finite() && spread > 0.0 && value.is_finite()) {
        return number(value);
    }
    let decimals = 1 - spread.log10().floor() as i32;
    let step = 10_f64.powi(-decimals);
    let rounded = (value / step).round() * step + 0.0;
    match (0..=6).contains(&decimals) && rounded.abs() < 1e6 {
        true => format!("{rounded:.*}", decimals as usize).replace('-', "\u{2212}"),
        false => number(rounded),
    }
}

/// The largest magnitude among the finite values.
pub fn peak(values: &[f64]) -> f64 {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    finite.fold(0.0, |peak, value| peak.max(value.abs()))
}

/// The root mean square of the finite values; NaN without any.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut count) = (0.0, 0_usize);
    for value in values.filter(|value| value.is_finite()) {
        sum += value * value;
        count += 1;
    }
    (sum / count as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_suit_the_size() {
        let shown = Shown::of("rad", 0.0021);
        assert_eq!(
            (shown.number(0.0021), shown.unit.as_str()),
            ("2.1".into(), "mrad")
        );
        assert_eq!(Preferred::of("rad", 0.0021).beside(1e-6).unit, "urad");
        assert_eq!(Shown::of("rad", 0.17).unit, "deg");
        assert_eq!(Shown::of("N.s/m", 0.17).unit, "N.s/m");
    }

    #[test]
    fn a_value_has_the_digits_of_its_interval() {
        let shown = Shown::of("N", 20.0);
        assert_eq!(shown.quoted(20.4172, [19.9, 20.9]), "20.42");
        assert_eq!(shown.interval([19.913, 20.921]), "19.91 to 20.92");
        assert_eq!(shown.interval([0.1148, 0.1170]), "0.1148 to 0.1170");
        assert_eq!(shown.quoted(1234.0, [1000.0, 1400.0]), "1230");
        assert_eq!(
            shown.quoted(-3.2e-9, [-3.3e-9, -3.1e-9]),
            "\u{2212}3.2e\u{2212}9"
        );
    }
}
