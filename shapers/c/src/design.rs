//! Designing trains.

use crate::data::{PlainMode, PlainTrain};
use crate::memory::{slice, write};
use crate::status::{Status, code};
use core::ffi::{CStr, c_char};
use quell_shapers::shaper_by_name;

/// `quell_design` of the header.
///
/// # Safety
/// `shaper` is null or a string that ends; `train` is null or a place for a train.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_design(
    shaper: *const c_char,
    mode: PlainMode,
    sample_time: f64,
    train: *mut PlainTrain,
) -> i32 {
    let design = || {
        if shaper.is_null() {
            return Err(Status::Null);
        }
        // SAFETY: not null, and a string by the contract.
        let name = unsafe { CStr::from_ptr(shaper) };
        let shaper = name.to_str().ok().and_then(shaper_by_name);
        let found = shaper.ok_or(Status::UnknownShaper)?;
        let found = found.on_grid(mode.checked()?, sample_time)?;
        // SAFETY: as the caller promises.
        unsafe { write(train, PlainTrain::from(&found)) }
    };
    code(design())
}

/// `quell_convolve` of the header.
///
/// # Safety
/// Each pointer is null or to a train.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_convolve(
    first: *const PlainTrain,
    second: *const PlainTrain,
    both: *mut PlainTrain,
) -> i32 {
    let convolve = || {
        // SAFETY: as the caller promises; what is read is copied before anything is written.
        let (first, second) = unsafe {
            (
                slice(first, 1)?[0].checked()?,
                slice(second, 1)?[0].checked()?,
            )
        };
        let found = first.convolve(&second)?;
        // SAFETY: as the caller promises.
        unsafe { write(both, PlainTrain::from(&found)) }
    };
    code(convolve())
}
