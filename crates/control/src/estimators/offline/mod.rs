//! Off-line references: what a whole record says, to compare the on-line estimators with.

mod batch_fit;
mod fourier;
mod log_decrement;
mod output_error;
mod point;
mod search;
mod triangle;

pub use batch_fit::batch_fit_near;
pub use batch_fit::{BatchFit, batch_fit};
pub use fourier::{amplitude_spectrum, fourier};
pub use log_decrement::{Extremum, extrema, log_decrement, mode_of_extrema};
pub use search::telling;
