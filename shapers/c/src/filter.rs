//! Making, running and retuning filters.

use crate::data::{Correction, PlainMode, PlainResidual, PlainSetpoint, PlainTrain};
use crate::memory::{Filter, filter, look_at, make, slice, write};
use crate::status::{Status, code};
use core::ffi::c_void;
use quell_shapers::{CORRECTED_MODES, Retune, Setpoint, UncertainMode};

/// `quell_filter_init` of the header.
///
/// # Safety
/// `memory` is null, or `bytes` bytes that only the filter uses from now on; `place` is null or a place for a
/// pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_init(
    memory: *mut c_void,
    bytes: usize,
    sample_time: f64,
    capacity: usize,
    horizon: usize,
    place: *mut *mut Filter,
) -> i32 {
    let init = || {
        if !(sample_time.is_finite() && sample_time > 0.0) {
            return Err(Status::SampleTime);
        }
        // SAFETY: as the caller promises.
        unsafe { write(place, make(memory, bytes, sample_time, capacity, horizon)?) }
    };
    code(init())
}

/// `quell_filter_reset` of the header.
///
/// # Safety
/// `pointer` is null or to a filter that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_reset(pointer: *mut Filter, position: f64) -> i32 {
    // SAFETY: as the caller promises.
    let found = unsafe { filter(pointer) };
    code(found.map(|found| found.filter.reset(position)))
}

/// `quell_filter_install` of the header.
///
/// # Safety
/// `pointer` is null or to a filter that nobody else uses, `train` null or to a train.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_install(
    pointer: *mut Filter,
    train: *const PlainTrain,
) -> i32 {
    let install = || {
        // SAFETY: as the caller promises.
        let (found, train) = unsafe { (filter(pointer)?, slice(train, 1)?[0].checked()?) };
        Ok(found.filter.install(&train)?)
    };
    code(install())
}

/// `quell_filter_step` of the header.
///
/// # Safety
/// `pointer` is null or to a filter that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_step(
    pointer: *mut Filter,
    planned: PlainSetpoint,
) -> PlainSetpoint {
    // SAFETY: as the caller promises.
    let found = unsafe { filter(pointer) };
    found.map_or(planned, |found| found.filter.step(planned.into()).into())
}

/// `quell_filter_is_settled` of the header.
///
/// # Safety
/// `pointer` is null or to a filter that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_is_settled(pointer: *const Filter) -> i32 {
    // SAFETY: as the caller promises.
    let found = unsafe { look_at(pointer) };
    found.is_ok_and(|found| found.filter.is_settled()).into()
}

/// `quell_filter_retune` of the header.
///
/// # Safety
/// Each pointer is null, or to as many objects as the header says that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_retune(
    pointer: *mut Filter,
    train: *const PlainTrain,
    modes: *const PlainMode,
    count: usize,
    spread: f64,
    limits: PlainSetpoint,
    planned: *const PlainSetpoint,
    remaining: usize,
    correction: *mut Correction,
) -> i32 {
    let retune = || {
        // SAFETY: as the caller promises.
        let (found, train) = unsafe { (filter(pointer)?, slice(train, 1)?[0].checked()?) };
        // SAFETY: as the caller promises.
        let (given, planned) = unsafe { (slice(modes, count)?, slice(planned, remaining)?) };
        let (first, others) = given.split_first().ok_or(Status::Range)?;
        let mut modes = [first.checked()?; CORRECTED_MODES];
        for (mode, plain) in modes
            .get_mut(1..count)
            .ok_or(Status::Range)?
            .iter_mut()
            .zip(others)
        {
            *mode = plain.checked()?;
        }
        if !(spread >= 0.0 && spread.is_finite()) {
            return Err(Status::Range);
        }
        let known = modes.map(|mode| UncertainMode {
            mode,
            natural_frequency_std: spread * mode.natural_frequency(),
            damping_ratio_std: spread,
        });
        let outcome = retuned(found, &train, &known[..count], limits, planned);
        let done = Correction::of(outcome)?;
        if !correction.is_null() {
            // SAFETY: as the caller promises.
            unsafe { write(correction, done)? };
        }
        Ok(())
    };
    code(retune())
}

fn retuned(
    found: &mut Filter,
    train: &quell_shapers::GridTrain,
    modes: &[UncertainMode],
    limits: PlainSetpoint,
    planned: &[PlainSetpoint],
) -> quell_shapers::RetuneOutcome {
    let request = Retune {
        train,
        modes,
        limits: limits.into(),
        dead_band: 0.0,
        resolution: 0.0,
    };
    let input = |k: usize| {
        planned
            .get(k - 1)
            .map_or_else(Setpoint::default, |&plain| plain.into())
    };
    found.filter.retune(&request, planned.len(), input)
}

/// `quell_filter_residual` of the header.
///
/// # Safety
/// `pointer` is null or to a filter that nobody else uses, `residual` null or a place for a residual.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn quell_filter_residual(
    pointer: *const Filter,
    mode: PlainMode,
    residual: *mut PlainResidual,
) -> i32 {
    let ask = || {
        // SAFETY: as the caller promises.
        let found = unsafe { look_at(pointer)? };
        let left = found
            .filter
            .residual(mode.checked()?)
            .ok_or(Status::History)?;
        // SAFETY: as the caller promises.
        unsafe { write(residual, left.into()) }
    };
    code(ask())
}
