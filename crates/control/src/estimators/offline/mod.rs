//! Off-line estimators over a whole record, as a reference for the on-line ones.

mod batch_fit;
mod fourier;
mod log_decrement;
mod output_error;
mod point;
mod search;
mod triangle;
mod two_mode_residual;

pub use batch_fit::batch_fit_near;
pub use batch_fit::{BatchFit, batch_fit};
pub use fourier::{amplitude_spectrum, fourier};
pub use log_decrement::{Extremum, extrema, log_decrement, mode_of_extrema};
pub use search::telling;
pub use two_mode_residual::{TwoModeResidual, two_mode_residual};
