//! Designing trains.

use crate::data::{PlainMode, PlainTrain};
use crate::memory::{slice, write};
use crate::status::{Status, code};
use core::ffi::{CStr, c_char};
use quell_shapers::{GridTrain, Shaper, shaper_by_name};

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
        // SAFETY: as the caller promises.
        let found = unsafe { named(shaper)? };
        let found = found.on_grid(mode.checked()?, sample_time)?;
        // SAFETY: as the caller promises.
        unsafe { write(train, PlainTrain::from(&found)) }
    };
    code(design())
}

/// `quell_design_modes` of the header.
///
/// # Safety
/// `shaper` is null or a string that ends; `modes` is null or to `count` modes; `train` is null or a place for a train.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_design_modes(
    shaper: *const c_char,
    modes: *const PlainMode,
    count: usize,
    sample_time: f64,
    train: *mut PlainTrain,
) -> i32 {
    let design = || {
        // SAFETY: as the caller promises.
        let (found, modes) = unsafe { (named(shaper)?, slice(modes, count)?) };
        let mut all = GridTrain::identity(sample_time)?;
        for mode in modes {
            all = all.convolve(&found.on_grid(mode.checked()?, sample_time)?)?;
        }
        // SAFETY: as the caller promises.
        unsafe { write(train, PlainTrain::from(&all)) }
    };
    code(design())
}

/// The shaper of a name.
///
/// # Safety
/// `shaper` is null or a string that ends.
unsafe fn named(shaper: *const c_char) -> Result<&'static dyn Shaper, Status> {
    if shaper.is_null() {
        return Err(Status::Null);
    }
    // SAFETY: not null, and a string by the contract.
    let name = unsafe { CStr::from_ptr(shaper) };
    let found = name.to_str().ok().and_then(shaper_by_name);
    found.ok_or(Status::UnknownShaper)
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
