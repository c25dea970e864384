//! A number with its uncertainty.

use super::BAND;

/// An estimate with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
}

impl Estimate {
    /// The estimate, if 0 is outside of its 95 % interval.
    pub fn significant(self) -> Option<Self> {
        (self.value.abs() > BAND * self.std).then_some(self)
    }

    /// Half width of its 95 % interval.
    pub fn band(self) -> f64 {
        BAND * self.std
    }
}
