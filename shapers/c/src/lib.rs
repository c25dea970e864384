//! The shapers for a robot controller in C; `include/quell_shapers.h` is the documentation.
//!
//! A thin layer: it turns pointers into references (`memory`, the only place that needs more than a
//! word of caution), numbers into what `quell-shapers` takes, and errors into codes. No std, no heap.
#![no_std]

#[cfg(not(feature = "bare"))]
extern crate std;

mod data;
mod design;
mod filter;
mod memory;
mod status;

pub use data::{Correction, PlainMode, PlainResidual, PlainSetpoint, PlainTrain};
pub use design::{quell_convolve, quell_design};
pub use filter::{
    quell_filter_init, quell_filter_install, quell_filter_is_settled, quell_filter_reset,
    quell_filter_residual, quell_filter_retune, quell_filter_step,
};
pub use memory::{Filter, quell_filter_bytes};
pub use status::quell_text;

/// A controller cannot unwind: it stops here, and its watchdog sees that.
#[cfg(feature = "bare")]
#[panic_handler]
fn stop(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
