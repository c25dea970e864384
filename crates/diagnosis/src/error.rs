//! Reasons why a diagnosis cannot be made.

use quell_model::ExperimentError;
use quell_recording::Role;

/// Why a diagnosis cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum DiagnosisError {
    /// No recording was given.
    #[error("no recording was given")]
    NoRecording,
    /// A recording does not suit the model.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// It was stopped before its time.
    #[error("the diagnosis was stopped before its time")]
    Stopped,
    /// Too few samples for the unknowns.
    #[error(
        "{channel} of \"{recording}\" has {found} samples; the unknowns of the model and its noise take at least \
         {needed}"
    )]
    TooFew {
        /// Name of the recording.
        recording: String,
        /// Which channel.
        channel: Role,
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// A number that no sensor gives.
    #[error(
        "{channel} of \"{recording}\" holds {value:e} {unit}, which nothing measures: check unit and scale"
    )]
    NoMeasurement {
        /// Name of the recording.
        recording: String,
        /// Which channel.
        channel: Role,
        /// The value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// A sensor that shows one value while the machine moves.
    #[error(
        "{channel} of \"{recording}\" is {value} throughout, while {moving} changes by {by}: a dead sensor, a wrong \
         column, or a resolution that is too coarse; leave the channel out of the recording, or repair it"
    )]
    Dead {
        /// Name of the recording.
        recording: String,
        /// The channel that stands still.
        channel: Role,
        /// At what, with its unit.
        value: String,
        /// The channel that moves.
        moving: Role,
        /// By how much, with its unit.
        by: String,
    },
    /// A link that does not go as far as its motor side, or goes the other way.
    #[error("\"{recording}\": {words}")]
    Contradiction {
        /// Name of the recording.
        recording: String,
        /// The ratio, and what explains it.
        words: String,
    },
    /// A sensor that shows nothing but noise while the model moves.
    #[error(
        "{channel} of \"{recording}\" shows nothing but noise of {noise}, while {moving} makes it move by {by} rms in \
         the model: a dead sensor, a wrong column or a wrong unit; leave the channel out of the recording, or repair it"
    )]
    Mute {
        /// Name of the recording.
        recording: String,
        /// The channel.
        channel: Role,
        /// Its noise, with its unit.
        noise: String,
        /// The channel that drives the model.
        moving: Role,
        /// What the model predicts, with its unit.
        by: String,
    },
    /// A channel with too few samples in a period of the mode.
    #[error(
        "{channel} of \"{recording}\" has {} samples a second, and shows a mode of {} Hz at {} Hz: record it at more than {} Hz, \
         or give a model without that mode (kind = \"rigid_axis\"), whose friction, delay or backlash slower samples tell",
        quell_recording::plain(round(*.rate_hz)),
        quell_recording::plain(round(*.mode_hz)),
        quell_recording::plain(round(alias(*.mode_hz, *.rate_hz))),
        quell_recording::plain(round(2.0 * .mode_hz)),
    )]
    TooSlow {
        /// Name of the recording.
        recording: String,
        /// Which channel.
        channel: Role,
        /// Its samples a second.
        rate_hz: f64,
        /// The mode's natural frequency, Hz.
        mode_hz: f64,
    },
    /// One recording of several in which nothing varies.
    #[error("nothing moves in \"{recording}\": {words} throughout; leave it out")]
    Still {
        /// Name of the recording.
        recording: String,
        /// Which channels stand still, and where.
        words: String,
    },
    /// A forecast from so many samples that none is left to judge by.
    #[error(
        "\"{recording}\" has {samples} samples of an output: after the first {first} none is left to judge by"
    )]
    NothingFollows {
        /// Name of the recording.
        recording: String,
        /// Samples that the start was to be fitted to.
        first: usize,
        /// How many there are.
        samples: usize,
    },
    /// A number of the diagnosis is not finite.
    #[error(
        "the diagnosis came to a number that is not finite ({0}): check units and scales of the recordings"
    )]
    NotFinite(String),
    /// The model runs away on its own recording.
    #[error(
        "the model's simulation of \"{recording}\" is not finite: check its parameters and units"
    )]
    RunsAway {
        /// Name of the recording.
        recording: String,
    },
}

/// Where a frequency shows in samples of a rate.
fn alias(hertz: f64, rate: f64) -> f64 {
    (hertz - rate * (hertz / rate).round()).abs()
}

/// Three digits of a frequency.
fn round(hertz: f64) -> f64 {
    format!("{hertz:.2e}").parse().unwrap_or(hertz)
}
