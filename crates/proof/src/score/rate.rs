//! Rates with their uncertainty, and spreads.

use serde::Serialize;
use serde_json::{Value, json};

/// So many of so many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Rate {
    /// How many were so.
    pub right: usize,
    /// How many there were.
    pub of: usize,
}

impl Rate {
    /// With one more.
    pub fn and(self, right: bool) -> Self {
        Self {
            right: self.right + usize::from(right),
            of: self.of + 1,
        }
    }

    /// With all of another one.
    pub fn with(self, other: Self) -> Self {
        Self {
            right: self.right + other.right,
            of: self.of + other.of,
        }
    }

    /// Whether all were so, and there was one.
    pub fn is_all(self) -> bool {
        self.right == self.of && self.of > 0
    }

    /// The share, percent; not a number where there were none.
    pub fn percent(self) -> f64 {
        100.0 * self.right as f64 / self.of as f64
    }

    /// Wilson's 95 % interval of the share, percent.
    ///
    /// # Example
    /// ```
    /// // None of 39: up to 9 %.
    /// let none = quell_proof::Rate { right: 0, of: 39 };
    /// assert!((none.interval()[1] - 8.97).abs() < 0.01);
    /// ```
    /// Source: E. B. Wilson, J. American Statistical Association 22 (1927).
    pub fn interval(self) -> [f64; 2] {
        const Z: f64 = 1.959964;
        let (n, p) = (self.of as f64, self.right as f64 / self.of as f64);
        let centre = p + Z * Z / (2.0 * n);
        let half = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        // Rounding: a bound that is 0 is none below it.
        [centre - half, centre + half]
            .map(|edge| (100.0 * edge / (1.0 + Z * Z / n)).clamp(0.0, 100.0) + 0.0)
    }

    /// As `214 of 214`.
    pub fn count(self) -> String {
        format!("{} of {}", self.right, self.of)
    }

    /// As `91.2 %`; a dash where there were none.
    pub fn share(self) -> String {
        match self.of {
            0 => "-".into(),
            _ => format!("{:.1} %", self.percent()),
        }
    }

    pub(super) fn to_json(self) -> Value {
        json!({"right": self.right, "of": self.of, "percent": self.percent(), "ci95": self.interval()})
    }
}

/// Median and 90th percentile of finite values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// How many values there were.
    pub count: usize,
    /// Their mean.
    pub mean: f64,
    /// Their median.
    pub median: f64,
    /// Their 90th percentile.
    pub ninth_decile: f64,
}

impl Spread {
    /// Of values; those that are not finite are left out.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        Self {
            count: values.len(),
            mean: values.iter().sum::<f64>() / values.len() as f64,
            median: quantile(&values, 0.5),
            ninth_decile: quantile(&values, 0.9),
        }
    }

    pub(super) fn to_json(self) -> Value {
        json!({
            "count": self.count,
            "mean": self.mean,
            "median": self.median,
            "ninth_decile": self.ninth_decile,
        })
    }
}

/// Linear between neighbours of a sorted list.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else {
        return f64::NAN;
    };
    let place = share * last as f64;
    let (low, high) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    low + (high - low) * place.fract()
}
