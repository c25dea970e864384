//! Everything that this crate can refuse.

use crate::Mode;

/// Why a train, a grid or a filter was refused; carries the value.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ShaperError {
    /// A train without impulses.
    #[error("an impulse train needs at least one impulse")]
    Empty,
    /// An impulse with a time that is negative or not finite, or an amplitude that is not finite.
    #[error(
        "impulse {index}: time {time} s, amplitude {amplitude}: not a finite impulse at or after 0"
    )]
    Impulse {
        /// Position in the list handed over.
        index: usize,
        /// Its time, s.
        time: f64,
        /// Its amplitude.
        amplitude: f64,
    },
    /// The amplitudes do not add up to something above 0, so that they cannot be scaled to sum 1.
    #[error("the amplitudes add up to {0}; a sum above 0 is needed")]
    Sum(f64),
    /// More impulses than a train holds.
    #[error("{count} impulses; a train holds {capacity}")]
    TooManyImpulses {
        /// How many there would have been.
        count: usize,
        /// How many fit.
        capacity: usize,
    },
    /// The damping ratio is above what the rule is solved for.
    #[error("{shaper}: damping ratio {damping_ratio} is above {limit}, where the equations end")]
    DampingTooHigh {
        /// Name of the shaper.
        shaper: &'static str,
        /// The damping ratio asked for.
        damping_ratio: f64,
        /// The highest that is solved.
        limit: f64,
    },
    /// The equations were not solved within the bounded number of iterations.
    #[error("{shaper}: no solution found at damping ratio {damping_ratio}")]
    NotConverged {
        /// Name of the shaper.
        shaper: &'static str,
        /// The damping ratio asked for.
        damping_ratio: f64,
    },
    /// A sample time that is not a finite number above zero.
    #[error("sample time {0} s is not a finite number above 0")]
    SampleTime(f64),
    /// Two sample times that should be equal.
    #[error("sample time {found} s where {expected} s is in use")]
    SampleTimeMismatch {
        /// The one in use.
        expected: f64,
        /// The one handed over.
        found: f64,
    },
    /// The mode is too fast for the grid: half its damped period is below two ticks.
    #[error(
        "half a damped period, {half_period:.6} s, is shorter than two ticks of {sample_time:?} s: use a higher rate"
    )]
    TooFast {
        /// Half the damped period, s.
        half_period: f64,
        /// The tick, s.
        sample_time: f64,
    },
    /// The train is longer than the delay line.
    #[error("the train lasts {ticks} ticks; the delay line holds {capacity}")]
    TooLong {
        /// Delay of the last tap.
        ticks: usize,
        /// Longest delay that fits.
        capacity: usize,
    },
    /// Fewer than two numbers where a range was needed, or a number that is out of its range.
    #[error("{name} is {value}: out of range")]
    OutOfRange {
        /// The name of the number.
        name: &'static str,
        /// The number.
        value: f64,
    },
    /// No shaper of the table is within the delay.
    #[error("no shaper adds less than {longest_delay} s; the shortest adds {shortest:.6} s")]
    NoneFits {
        /// Longest delay allowed, s.
        longest_delay: f64,
        /// Delay of the shortest shaper, s.
        shortest: f64,
    },
}

impl ShaperError {
    /// The mode's damping ratio, where it is at most the highest for which a shaper is solved.
    pub(crate) fn solved_damping(
        shaper: &'static str,
        mode: Mode,
        limit: f64,
    ) -> Result<f64, Self> {
        let damping_ratio = mode.damping_ratio();
        match damping_ratio > limit {
            true => Err(Self::DampingTooHigh {
                shaper,
                damping_ratio,
                limit,
            }),
            false => Ok(damping_ratio),
        }
    }
}
