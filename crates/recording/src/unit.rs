//! Units of files, and their conversion to SI.

use std::f64::consts::{PI, TAU};

/// The kind of quantity that a unit measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Dimension {
    /// rad
    Angle,
    /// m
    Length,
    /// rad/s
    AngularVelocity,
    /// m/s
    Velocity,
    /// rad/s^2
    AngularAcceleration,
    /// m/s^2
    Acceleration,
    /// N
    Force,
    /// N.m
    Torque,
    /// A
    Current,
    /// V
    Voltage,
    /// kg
    Mass,
    /// kg.m^2
    MomentOfInertia,
    /// A number without a unit, kept as it is.
    Number,
}

/// A unit of a manifest: `SI value = value * times / per`.
///
/// `times` and `per` are the two exact sides of the definition, so that a value in mm is divided
/// by 1000 and rounded once, not multiplied by a rounded 0.001.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// The spellings; the first is the usual one.
    pub names: &'static [&'static str],
    /// The SI unit of its quantity.
    pub si: &'static str,
    /// The quantity that it measures.
    pub dimension: Dimension,
    /// Numerator of the conversion.
    pub times: f64,
    /// Denominator of the conversion.
    pub per: f64,
}

/// Standard acceleration of free fall, m/s^2, exact by definition (3rd CGPM, 1901).
const G_N: f64 = 9.80665;
/// Pound-force, N, exact: 0.45359237 kg times the standard acceleration.
const LBF: f64 = 4.4482216152605;
/// Inch, m, exact as 127 / 5000 (1959).
const INCH: (f64, f64) = (127.0, 5000.0);

/// All units that a manifest may name.
pub const UNITS: &[Unit] = &[
    unit(&["rad"], "rad", Dimension::Angle, 1.0, 1.0),
    unit(&["mrad"], "rad", Dimension::Angle, 1.0, 1e3),
    unit(
        &["urad", "\u{b5}rad", "\u{3bc}rad"],
        "rad",
        Dimension::Angle,
        1.0,
        1e6,
    ),
    unit(&["deg", "\u{b0}"], "rad", Dimension::Angle, PI, 180.0),
    unit(&["arcmin"], "rad", Dimension::Angle, PI, 10_800.0),
    unit(&["arcsec"], "rad", Dimension::Angle, PI, 648_000.0),
    unit(&["rev"], "rad", Dimension::Angle, TAU, 1.0),
    unit(&["m"], "m", Dimension::Length, 1.0, 1.0),
    unit(&["cm"], "m", Dimension::Length, 1.0, 1e2),
    unit(&["mm"], "m", Dimension::Length, 1.0, 1e3),
    unit(
        &["um", "\u{b5}m", "\u{3bc}m"],
        "m",
        Dimension::Length,
        1.0,
        1e6,
    ),
    unit(&["nm"], "m", Dimension::Length, 1.0, 1e9),
    unit(&["in"], "m", Dimension::Length, INCH.0, INCH.1),
    unit(&["rad/s"], "rad/s", Dimension::AngularVelocity, 1.0, 1.0),
    unit(&["mrad/s"], "rad/s", Dimension::AngularVelocity, 1.0, 1e3),
    unit(
        &["deg/s", "\u{b0}/s"],
        "rad/s",
        Dimension::AngularVelocity,
        PI,
        180.0,
    ),
    unit(&["rpm"], "rad/s", Dimension::AngularVelocity, TAU, 60.0),
    unit(&["rev/s"], "rad/s", Dimension::AngularVelocity, TAU, 1.0),
    unit(&["m/s"], "m/s", Dimension::Velocity, 1.0, 1.0),
    unit(&["mm/s"], "m/s", Dimension::Velocity, 1.0, 1e3),
    unit(&["um/s"], "m/s", Dimension::Velocity, 1.0, 1e6),
    unit(&["in/s"], "m/s", Dimension::Velocity, INCH.0, INCH.1),
    unit(
        &["rad/s^2", "rad/s2"],
        "rad/s^2",
        Dimension::AngularAcceleration,
        1.0,
        1.0,
    ),
    unit(
        &["deg/s^2", "deg/s2"],
        "rad/s^2",
        Dimension::AngularAcceleration,
        PI,
        180.0,
    ),
    unit(
        &["m/s^2", "m/s2", "m/s\u{b2}"],
        "m/s^2",
        Dimension::Acceleration,
        1.0,
        1.0,
    ),
    unit(
        &["mm/s^2", "mm/s2"],
        "m/s^2",
        Dimension::Acceleration,
        1.0,
        1e3,
    ),
    unit(&["g"], "m/s^2", Dimension::Acceleration, G_N, 1.0),
    unit(&["mg"], "m/s^2", Dimension::Acceleration, G_N, 1e3),
    unit(&["N"], "N", Dimension::Force, 1.0, 1.0),
    unit(&["mN"], "N", Dimension::Force, 1.0, 1e3),
    unit(&["kN"], "N", Dimension::Force, 1e3, 1.0),
    unit(&["lbf"], "N", Dimension::Force, LBF, 1.0),
    unit(&["kip"], "N", Dimension::Force, LBF * 1e3, 1.0),
    unit(
        &["N.m", "Nm", "N*m", "N\u{b7}m"],
        "N.m",
        Dimension::Torque,
        1.0,
        1.0,
    ),
    unit(&["mN.m", "mNm"], "N.m", Dimension::Torque, 1.0, 1e3),
    unit(&["kN.m", "kNm"], "N.m", Dimension::Torque, 1e3, 1.0),
    unit(&["A"], "A", Dimension::Current, 1.0, 1.0),
    unit(&["mA"], "A", Dimension::Current, 1.0, 1e3),
    unit(&["V"], "V", Dimension::Voltage, 1.0, 1.0),
    unit(&["mV"], "V", Dimension::Voltage, 1.0, 1e3),
    unit(&["kg"], "kg", Dimension::Mass, 1.0, 1.0),
    unit(
        &["kg.m^2", "kg.m2", "kgm2", "kg*m^2", "kg\u{b7}m\u{b2}"],
        "kg.m^2",
        Dimension::MomentOfInertia,
        1.0,
        1.0,
    ),
    unit(
        &["kg.cm^2", "kg.cm2", "kgcm2"],
        "kg.m^2",
        Dimension::MomentOfInertia,
        1.0,
        1e4,
    ),
    unit(
        &["g.cm^2", "g.cm2", "gcm2"],
        "kg.m^2",
        Dimension::MomentOfInertia,
        1.0,
        1e7,
    ),
    unit(&["1"], "1", Dimension::Number, 1.0, 1.0),
    unit(&["count"], "count", Dimension::Number, 1.0, 1.0),
    unit(&["count/s"], "count/s", Dimension::Number, 1.0, 1.0),
    unit(&["raw"], "raw", Dimension::Number, 1.0, 1.0),
];

const fn unit(
    names: &'static [&'static str],
    si: &'static str,
    dimension: Dimension,
    times: f64,
    per: f64,
) -> Unit {
    Unit {
        names,
        si,
        dimension,
        times,
        per,
    }
}

impl Unit {
    /// The unit of this name; letters' case matters (mN is not MN).
    pub fn from_name(name: &str) -> Option<&'static Self> {
        UNITS.iter().find(|unit| unit.names.contains(&name))
    }

    /// A value in this unit, in SI.
    ///
    /// # Example
    /// ```
    /// use quell_recording::Unit;
    /// assert_eq!(Unit::from_name("deg").unwrap().to_si(180.0), std::f64::consts::PI);
    /// assert_eq!(Unit::from_name("mm").unwrap().to_si(3.0), 0.003);
    /// ```
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.times / self.per
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_units_convert_by_their_definitions() {
        let si = |value, name| Unit::from_name(name).unwrap().to_si(value);
        assert_eq!(si(1.0, "in"), 0.0254);
        assert_eq!(si(1.0, "g"), 9.80665);
        assert_eq!(si(1.0, "rpm"), TAU / 60.0);
        assert_eq!(si(1.0, "kip"), 4448.2216152605);
        assert_eq!(si(0.7, "um"), 0.7e-6);
    }

    #[test]
    fn names_are_unique_and_si_units_convert_to_themselves() {
        let mut names: Vec<_> = UNITS.iter().flat_map(|unit| unit.names).collect();
        names.sort();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
        for unit in UNITS {
            let si = Unit::from_name(unit.si).unwrap();
            assert_eq!((si.times, si.per, si.dimension), (1.0, 1.0, unit.dimension));
        }
    }
}
