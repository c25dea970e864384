//! Ending an identification before its time.

use super::IdentificationError;

/// Says whether it shall end; asked between fits, and within those of what vibrates alone, on several threads.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Nobody ends it.
pub fn never() -> bool {
    false
}

/// Asks now.
///
/// # Errors
/// [`IdentificationError::Stopped`] where it shall end.
pub fn check(stop: Stop) -> Result<(), IdentificationError> {
    match stop() {
        true => Err(IdentificationError::Stopped),
        false => Ok(()),
    }
}
