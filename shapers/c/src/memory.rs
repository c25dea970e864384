//! From pointers to references: what can be checked is checked here.

use crate::status::Status;
use core::alloc::{Layout, LayoutError};
use core::ffi::c_void;
use quell_shapers::{AdaptiveFilter, Buffers, Entry, Setpoint};

type Lent<T> = &'static mut [T];

/// `quell_filter`: what lies at the start of the memory that a caller gives; its buffers follow.
pub struct Filter {
    mark: u64,
    pub(crate) filter: AdaptiveFilter<Lent<Setpoint>, Lent<Entry>>,
}

/// Tells a filter from memory that has not been made one: a drawn number.
const MARK: u64 = 0x8d1c_f03b_5e92_a746;

/// Setpoints in the delay line of a filter, as [`Buffers`] asks for.
fn places(capacity: usize) -> usize {
    capacity.saturating_add(1).saturating_mul(2)
}

/// Where things lie in the memory of a filter.
struct Plan {
    whole: Layout,
    line: usize,
    history: usize,
    planned: usize,
    future: usize,
}

impl Plan {
    fn new(capacity: usize, horizon: usize) -> Result<Self, LayoutError> {
        let line = Layout::array::<Setpoint>(places(capacity))?;
        let ahead = Layout::array::<Setpoint>(horizon)?;
        let (whole, line) = Layout::new::<Filter>().extend(line)?;
        let (whole, history) = whole.extend(Layout::array::<Entry>(horizon)?)?;
        let (whole, planned) = whole.extend(ahead)?;
        let (whole, future) = whole.extend(ahead)?;
        Ok(Self {
            whole,
            line,
            history,
            planned,
            future,
        })
    }
}

/// `quell_filter_bytes` of the header.
#[unsafe(no_mangle)]
pub extern "C" fn quell_filter_bytes(capacity: usize, horizon: usize) -> usize {
    Plan::new(capacity, horizon).map_or(0, |plan| plan.whole.size())
}

/// Makes a filter in `memory`.
///
/// # Safety
/// `memory` is null, or `bytes` bytes that only the filter uses for as long as it is used.
pub(crate) unsafe fn make(
    memory: *mut c_void,
    bytes: usize,
    sample_time: f64,
    capacity: usize,
    horizon: usize,
) -> Result<*mut Filter, Status> {
    let plan = Plan::new(capacity, horizon).map_err(|_| Status::Memory)?;
    let memory = memory.cast::<u8>();
    check(memory, plan.whole.align())?;
    if bytes < plan.whole.size() {
        return Err(Status::Memory);
    }
    // SAFETY: the plan keeps the parts within `bytes`, aligned and apart, and nobody else uses them.
    let buffers = unsafe {
        Buffers {
            line: part(memory, plan.line, places(capacity)),
            history: part(memory, plan.history, horizon),
            planned: part(memory, plan.planned, horizon),
            future: part(memory, plan.future, horizon),
        }
    };
    let filter = AdaptiveFilter::in_buffers(sample_time, buffers)?;
    let place = memory.cast::<Filter>();
    // SAFETY: the plan begins with room for a filter, and the alignment has been checked.
    unsafe { place.write(Filter { mark: MARK, filter }) };
    Ok(place)
}

/// A part of the memory, filled.
///
/// # Safety
/// From `offset` on there are `length` places for a `T`, aligned, that only the result uses.
unsafe fn part<T: Copy + Default>(memory: *mut u8, offset: usize, length: usize) -> Lent<T> {
    // SAFETY: the offset lies within the memory; each place is written before the slice is made.
    unsafe {
        let first = memory.add(offset).cast::<T>();
        (0..length).for_each(|k| first.add(k).write(T::default()));
        core::slice::from_raw_parts_mut(first, length)
    }
}

fn check<T>(pointer: *const T, alignment: usize) -> Result<(), Status> {
    if pointer.is_null() {
        return Err(Status::Null);
    }
    if !pointer.addr().is_multiple_of(alignment) {
        return Err(Status::Alignment);
    }
    Ok(())
}

/// A filter behind a pointer.
///
/// # Safety
/// The pointer is null, or to memory of a filter's size that nobody else uses meanwhile.
pub(crate) unsafe fn filter<'a>(pointer: *mut Filter) -> Result<&'a mut Filter, Status> {
    // SAFETY: the contract is the same, and a filter has been found there.
    unsafe {
        look_at(pointer)?;
        Ok(&mut *pointer)
    }
}

/// A filter behind a pointer, to read.
///
/// # Safety
/// The pointer is null, or to memory of a filter's size that nobody writes meanwhile.
pub(crate) unsafe fn look_at<'a>(pointer: *const Filter) -> Result<&'a Filter, Status> {
    check(pointer, align_of::<Filter>())?;
    // SAFETY: not null, aligned; the mark is read before there is a reference to the rest.
    unsafe {
        if (&raw const (*pointer).mark).read() != MARK {
            return Err(Status::NotAFilter);
        }
        Ok(&*pointer)
    }
}

/// `length` objects behind a pointer, which may be null if there are none.
///
/// # Safety
/// The pointer is null, or to `length` objects that nobody writes meanwhile.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, length: usize) -> Result<&'a [T], Status> {
    if length == 0 {
        return Ok(&[]);
    }
    check(pointer, align_of::<T>())?;
    Layout::array::<T>(length).map_err(|_| Status::Range)?;
    // SAFETY: not null, aligned, of a size that an object can have, and readable by the contract.
    Ok(unsafe { core::slice::from_raw_parts(pointer, length) })
}

/// Writes a result where the caller wants it.
///
/// # Safety
/// The pointer is null, or to a place for a `T` that nobody else uses meanwhile.
pub(crate) unsafe fn write<T>(place: *mut T, value: T) -> Result<(), Status> {
    check(place, align_of::<T>())?;
    // SAFETY: not null, aligned, and writable by the contract.
    unsafe { place.write(value) };
    Ok(())
}
