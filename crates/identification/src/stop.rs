//! Early end of an identification.

use super::IdentificationError;

/// Whether it is to end. It is called between fits, and within fits of output-only modes, on several threads.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Never ends it.
pub fn never() -> bool {
    false
}

/// Checks for a stop now.
///
/// # Errors
/// [`IdentificationError::Stopped`] if it is to end.
pub fn check(stop: Stop) -> Result<(), IdentificationError> {
    match stop() {
        true => Err(IdentificationError::Stopped),
        false => Ok(()),
    }
}
