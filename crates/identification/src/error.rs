//! Why a recording cannot be identified.

use super::images::images;
use quell_model::NO_RESONANCE;
use quell_recording::{Role, plain};
use quell_signal::SignalError;

/// Why a recording cannot be identified.
#[derive(Debug, thiserror::Error)]
pub enum IdentificationError {
    /// A channel is missing or invalid, or the sensor's frame cannot be determined.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// Too few samples.
    #[error("{found} aligned samples, at least {needed} are needed")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A number that no sensor gives.
    #[error("{channel} holds {value:e} {unit}, which nothing measures: check unit and scale")]
    NoMeasurement {
        /// Which channel.
        channel: Role,
        /// The value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// A sensor that shows one value while the motor side moves.
    #[error(
        "{channel} is {} {unit} throughout, while motor_position changes by {} rad: a dead sensor, a wrong column, or \
         a resolution that is too coarse",
        plain(*.value),
        plain(*.by)
    )]
    Dead {
        /// Which channel.
        channel: Role,
        /// At what, in `unit`.
        value: f64,
        /// Its unit.
        unit: String,
        /// How far the motor side moves, rad.
        by: f64,
    },
    /// A link that does not go as far as its motor side, or goes the other way, or is exchanged with it.
    #[error("{0}")]
    Contradiction(String),
    /// A recording whose evidence for a mode is that of noise.
    #[error(
        "no mode was found: the tip rests or follows the motor side, with noise or drift; the best fit of a mode has a \
         chi-squared of {found:.0}, and strong evidence in {samples} samples needs {needed:.0}; record a move that makes the \
         link ring, and the rest after it{}",
        looked_for(*.searched)
    )]
    NotExcited {
        /// By how much the best fit lowers the criterion, as a chi-squared.
        found: f64,
        /// The least value for a mode.
        needed: f64,
        /// Number of samples.
        samples: usize,
        /// Lowest and highest frequency that were searched, Hz, where a rate or a length limits them.
        searched: Option<[f64; 2]>,
    },
    /// No evidence for a mode about the believed one.
    #[error(
        "no mode was found from {:.3} to {:.3} Hz, about the model's {belief:.3} Hz: there the tip rests or follows the motor \
         side, with noise or drift; {}",
        .searched[0],
        .searched[1],
        match *.belief_damping >= NO_RESONANCE {
            true => format!(
                "the model's damping ratio of {belief_damping:.3} is that of no resonance, and from it no mode that rings is \
                 found; write a damping ratio of some hundredths, or identify without the model"
            ),
            false => "identify without the model if its frequency may be wrong, else record a move that makes the link ring, \
                      and the rest after it"
                .into(),
        }
    )]
    NotNear {
        /// The believed frequency, Hz.
        belief: f64,
        /// The believed damping ratio.
        belief_damping: f64,
        /// Lowest and highest frequency that were searched, Hz.
        searched: [f64; 2],
    },
    /// A deformation that is no more than the rounding of its sensors.
    #[error(
        "no mode was found: the deformation spans {range:.2e} beside the motor side's motion, and the rounding of the sensors \
         makes up to {rounding:.2e} of a rigid joint; any mode is below what their steps show; record a faster move that makes \
         the link ring, or with a finer sensor of the link"
    )]
    Rounded {
        /// What the deformation spans, in its unit.
        range: f64,
        /// What rounding makes.
        rounding: f64,
    },
    /// A lag of first order explains the recording as well as a mode.
    #[error(
        "no mode was found: the link follows the motor side with a lag of first order, its time constant is \
         {:.3} s, and nothing rings: that is {}",
        .time_constant,
        match .of_servo {
            true => "how the servo follows its command, and no shaper is of use for it; record motor_position, too",
            false => "the filter of a sensor, or a damper, and no shaper is of use for it; if the machine does vibrate, record \
                      without the filter, or with an accelerometer at the tip",
        }
    )]
    Lags {
        /// Time constant, s.
        time_constant: f64,
        /// Whether a servo is part of the response.
        of_servo: bool,
    },
    /// A response that does not ring.
    #[error(
        "no mode was found that rings: the best fit, at {hertz:.2} Hz, has a damping ratio of at least {least_damping:.3} (95 % \
         interval), and from {NO_RESONANCE:.3} on a response has no half-power bandwidth, so that it is no resonance: no shaper is \
         of use for it; {}",
        match .of_servo {
            true => "this is how the servo follows its command; record motor_position, too",
            false => "if the machine does vibrate, record a faster move and the rest after it, or an accelerometer at the tip",
        }
    )]
    NoResonance {
        /// Frequency of the fit, Hz.
        hertz: f64,
        /// Lower end of the 95 % interval of the damping ratio.
        least_damping: f64,
        /// Whether a servo is part of the response.
        of_servo: bool,
    },
    /// A mode outside of the frequencies that were searched.
    #[error(
        "no mode was found from {:.3} to {:.1} Hz, which this recording can show: the best fit ends at {hertz:.3} Hz; record for \
         longer for a slower mode, and with more samples a second for a faster one",
        .searched[0],
        .searched[1]
    )]
    OutOfRange {
        /// Frequency of the fit, Hz.
        hertz: f64,
        /// Lowest and highest frequency that were searched, Hz.
        searched: [f64; 2],
    },
    /// A mode in the rests of the motor side that the motion does not explain: above the frequencies that were searched, or the
    /// image of one above half the rate.
    #[error(
        "no mode was found from {:.3} to {:.1} Hz that explains the motion: where the motor side rests, the link rings at {hertz:.1} \
         Hz. At {rate:.0} samples a second {:.1} Hz looks the same, and so do {:.1} and {:.1} Hz and further ones, so that the mode \
         may lie above half the rate. The motion tells a mode with five samples in a period: record with {:.0} samples a second or \
         more, and once more at another rate: a mode stays, an image moves",
        .searched[0],
        .searched[1],
        images(*.hertz, *.rate)[0],
        images(*.hertz, *.rate)[1],
        images(*.hertz, *.rate)[2],
        (5.0 * (rate - hertz).max(*hertz)).ceil()
    )]
    Above {
        /// Its frequency, Hz.
        hertz: f64,
        /// Lowest and highest frequency that were searched, Hz.
        searched: [f64; 2],
        /// Samples a second, Hz.
        rate: f64,
    },
    /// The strongest line of the spectrum is no resonance.
    #[error(
        "no mode was found: the peaks of the spectrum do not have the width of a resonance; a turning motor makes such \
         peaks; record the decay after a tap, or record for longer"
    )]
    OnlyLines,
    /// It was stopped before its time.
    #[error("the identification was stopped before its time")]
    Stopped,
    /// What is measured of the link does not vary.
    #[error("nothing that is measured of the link varies: nothing vibrates in this recording")]
    Still,
}

impl IdentificationError {
    /// The error of a recording in which a servo is part of the response, or is not.
    #[must_use]
    pub fn of_servo(mut self, is_one: bool) -> Self {
        if let Self::Lags { of_servo, .. } | Self::NoResonance { of_servo, .. } = &mut self {
            *of_servo = is_one;
        }
        self
    }

    /// Whether it says that no mode stands out among those that were searched.
    pub(super) fn is_no_mode(&self) -> bool {
        matches!(
            self,
            Self::NotExcited { .. }
                | Self::OutOfRange { .. }
                | Self::NoResonance { .. }
                | Self::Lags { .. }
        )
    }

    /// Whether it says that the best fit lies outside of what was searched.
    pub(super) fn is_out_of_range(&self) -> bool {
        matches!(self, Self::OutOfRange { .. })
    }

    /// With the frequencies that were searched, Hz, where no mode was found among them.
    pub(super) fn among(mut self, range: [f64; 2]) -> Self {
        if let Self::NotExcited { searched, .. } = &mut self {
            *searched = Some(range);
        }
        self
    }
}

/// A clause on the frequencies that were searched.
fn looked_for(searched: Option<[f64; 2]>) -> String {
    searched.map_or(String::new(), |[low, high]| {
        format!("; a mode was looked for from {low:.3} to {high:.1} Hz, and a faster one needs a faster rate")
    })
}
