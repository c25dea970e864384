//! Units for display: millimetres rather than metres, degrees or milliradians.

/// Least size, factor, and unit.
type Row = (f64, f64, &'static str);

/// For values of at least the size, the factor and the unit to show them in; the last one holds for
/// all that is smaller.
const PREFERRED: &[(&str, &[Row])] = &[
    (
        "rad",
        &[
            (0.02, 180.0 / core::f64::consts::PI, "deg"),
            (2e-5, 1e3, "mrad"),
            (0.0, 1e6, "urad"),
        ],
    ),
    ("m", &[(0.5, 1.0, "m"), (2e-5, 1e3, "mm"), (0.0, 1e6, "um")]),
    (
        "rad/s",
        &[
            (0.02, 180.0 / core::f64::consts::PI, "deg/s"),
            (0.0, 1e3, "mrad/s"),
        ],
    ),
    ("m/s", &[(0.1, 1.0, "m/s"), (0.0, 1e3, "mm/s")]),
    ("V", &[(0.1, 1.0, "V"), (0.0, 1e3, "mV")]),
    ("s", &[(0.2, 1.0, "s"), (0.0, 1e3, "ms")]),
];

/// Share of a unit below which a smaller one is used.
const TOO_SMALL: f64 = 0.02;

/// The unit of displayed values.
#[derive(Clone, Debug, PartialEq)]
pub struct Preferred {
    /// The factor of the values.
    pub factor: f64,
    /// Their unit then; empty for a number.
    pub unit: String,
    from: String,
}

impl Preferred {
    /// For values of this unit whose largest has this size.
    pub fn of(unit: &str, size: f64) -> Self {
        let entry = PREFERRED.iter().find(|entry| entry.0 == unit);
        let fit = entry.and_then(|entry| entry.1.iter().find(|row| size.abs() >= row.0));
        let (factor, shown) = match fit {
            Some(&(_, factor, shown)) => (factor, shown),
            None if unit == "1" => (1.0, ""),
            None => (1.0, unit),
        };
        Self {
            factor,
            unit: shown.into(),
            from: unit.into(),
        }
    }

    /// For misfits of this size beside a motion: the motion's unit, or a smaller one.
    pub fn of_misfit(unit: &str, motion: f64, misfit: f64) -> Self {
        Self::of(unit, motion.max(misfit)).beside(misfit)
    }

    /// The same unit for smaller values, unless they would be too small in it.
    #[must_use]
    pub fn beside(&self, size: f64) -> Self {
        match (size * self.factor).abs() >= TOO_SMALL {
            true => self.clone(),
            false => Self::of(&self.from, size),
        }
    }
}
