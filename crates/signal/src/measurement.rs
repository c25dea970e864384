//! A measurement, stamped on the sensor's own clock.

/// One measurement of one sensor.
///
/// `time` is the stamp of the sensor's own clock, s: two sensors' stamps differ by the offset of
/// their clocks, and only alignment makes them comparable. Values are SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measurement {
    /// Position `u` at the motor side: gearbox output seen by the encoder.
    MotorPosition {
        /// Stamp, s.
        time: f64,
        /// `u`, rad.
        position: f64,
    },
    /// Position `y` of the link, measured at the arm end of the joint.
    LinkPosition {
        /// Stamp, s.
        time: f64,
        /// `y`, rad.
        position: f64,
    },
    /// `delta = y - u`, measured as such (a strain gauge, say).
    Deformation {
        /// Stamp, s.
        time: f64,
        /// `delta`, rad.
        deformation: f64,
    },
    /// Tip of the arm in the sensor's own Cartesian frame.
    TipPosition {
        /// Stamp, s.
        time: f64,
        /// `[x, y, z]`, m.
        position: [f64; 3],
    },
}

impl Measurement {
    /// Stamp on the sensor's own clock, s.
    pub fn time(&self) -> f64 {
        match *self {
            Self::MotorPosition { time, .. }
            | Self::LinkPosition { time, .. }
            | Self::Deformation { time, .. }
            | Self::TipPosition { time, .. } => time,
        }
    }
}
