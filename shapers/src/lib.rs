//! Input shapers: impulse trains that leave a vibratory mode at rest, and the filter that runs them.
//!
//! Pure mathematics: no I/O, no allocation, no `std`, no `unsafe`.
#![no_std]

#[cfg(test)]
extern crate std;

mod mode;

pub use mode::{Mode, ModeError};
