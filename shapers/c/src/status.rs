//! The answer of a call: a code, and the code in words.

use core::ffi::{CStr, c_char};
use quell_shapers::{Refusal, ShaperError};

/// `quell_status` of the header, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub(crate) enum Status {
    Ok,
    Null,
    Alignment,
    Memory,
    NotAFilter,
    UnknownShaper,
    Mode,
    Damping,
    SampleTime,
    TooFast,
    TooLong,
    Train,
    Range,
    History,
    Limits,
    Busy,
    NotWorth,
}

const TEXTS: [&CStr; 17] = [
    c"ok",
    c"a pointer is null",
    c"a pointer is not aligned",
    c"the memory is smaller than quell_filter_bytes says",
    c"the memory holds no filter",
    c"no shaper of that name",
    c"the natural frequency is not finite and above 0, or the damping ratio is not in [0, 1)",
    c"the shaper is not solved for so high a damping ratio",
    c"the sample time is not finite and above 0, or not that of the filter",
    c"half a damped period of the mode is below two ticks",
    c"the train is longer than the filter's capacity",
    c"too many taps, not in order, or amplitudes that do not add up to 1",
    c"a number or a length is out of its range",
    c"the start of the move is older than the filter remembers",
    c"no correction that begins now keeps the limits",
    c"too many steps of earlier corrections are under way",
    c"no correction leaves less vibration than the present command",
];

/// `quell_text` of the header.
#[unsafe(no_mangle)]
pub extern "C" fn quell_text(status: i32) -> *const c_char {
    let text = usize::try_from(status).ok().and_then(|k| TEXTS.get(k));
    text.unwrap_or(&c"not a code of quell_status").as_ptr()
}

/// The code of a result.
pub(crate) fn code(result: Result<(), Status>) -> i32 {
    result.err().unwrap_or(Status::Ok) as i32
}

impl From<ShaperError> for Status {
    fn from(error: ShaperError) -> Self {
        match error {
            ShaperError::DampingTooHigh { .. } | ShaperError::NotConverged { .. } => Self::Damping,
            ShaperError::SampleTime(_) | ShaperError::SampleTimeMismatch { .. } => Self::SampleTime,
            ShaperError::TooFast { .. } => Self::TooFast,
            ShaperError::TooLong { .. } => Self::TooLong,
            ShaperError::Empty
            | ShaperError::Impulse { .. }
            | ShaperError::Sum(_)
            | ShaperError::TooManyImpulses { .. } => Self::Train,
            ShaperError::OutOfRange { .. } | ShaperError::NoneFits { .. } => Self::Range,
        }
    }
}

impl From<Refusal> for Status {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Invalid(error) => error.into(),
            Refusal::Modes(_) | Refusal::Horizon { .. } => Self::Range,
            Refusal::HistoryLost => Self::History,
            Refusal::Limits => Self::Limits,
            Refusal::Busy => Self::Busy,
            Refusal::NotWorth(_) => Self::NotWorth,
        }
    }
}
