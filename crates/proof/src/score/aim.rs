//! Aims of the rates, and whether they are met.

use super::Rate;
use std::fmt;

/// The aim of a rate, percent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// None: the rate is only told.
    None,
    /// At least so much.
    AtLeast(f64),
    /// At most so much.
    AtMost(f64),
    /// Between two bounds.
    Within([f64; 2]),
}

impl Aim {
    /// `met` or `missed` where the rate's whole 95 % interval says so, `too few` cases where it says neither;
    /// nothing without an aim.
    ///
    /// # Example
    /// ```
    /// use quell_proof::{Aim, Rate};
    /// let aim = Aim::AtMost(1.0);
    /// assert_eq!(aim.verdict(Rate { right: 0, of: 39 }), "too few");
    /// assert_eq!(aim.verdict(Rate { right: 0, of: 500 }), "met");
    /// assert_eq!(aim.verdict(Rate { right: 20, of: 500 }), "missed");
    /// ```
    pub fn verdict(self, rate: Rate) -> &'static str {
        let Some([least, most]) = self.bounds() else {
            return "";
        };
        let [low, high] = rate.interval();
        match rate.of {
            0 => "too few",
            _ if least <= low && high <= most => "met",
            _ if high < least || most < low => "missed",
            _ => "too few",
        }
    }

    fn bounds(self) -> Option<[f64; 2]> {
        match self {
            Self::None => None,
            Self::AtLeast(least) => Some([least, 100.0]),
            Self::AtMost(most) => Some([0.0, most]),
            Self::Within(bounds) => Some(bounds),
        }
    }
}

/// As `≥ 98 %`.
impl fmt::Display for Aim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => Ok(()),
            Self::AtLeast(least) => write!(f, "≥ {least} %"),
            Self::AtMost(most) => write!(f, "≤ {most} %"),
            Self::Within([low, high]) => write!(f, "{low}-{high} %"),
        }
    }
}
