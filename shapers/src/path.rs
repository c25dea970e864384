//! Several axes that move together.
//!
//! A move of several axes follows a path in space because every axis is a function of one common
//! path parameter. Where the SAME train, the convolution of what each axis needs, runs on every axis
//! ([`common_train`]), a straight line in joint space stays the same straight line to rounding; the
//! price is the sum of all delays.

use crate::{GridTrain, ShaperError};

/// The one train that, run on every axis, leaves nothing of any axis' mode and keeps the path.
///
/// # Errors
/// [`ShaperError::Empty`] without trains; [`ShaperError::SampleTimeMismatch`];
/// [`ShaperError::TooManyImpulses`] where the taps do not fit: then run the trains as filters in
/// series, which is the same.
///
/// # Example
/// ```
/// use quell_shapers::{Mode, Shaper, Zv, common_train};
/// let zv = |hertz| Zv.on_grid(Mode::from_hertz(hertz, 0.0).unwrap(), 0.001).unwrap();
/// let train = common_train(&[zv(10.0), zv(25.0)]).unwrap();
/// assert!((train.duration() - (0.050 + 0.020)).abs() < 1e-12);
/// ```
pub fn common_train(trains: &[GridTrain]) -> Result<GridTrain, ShaperError> {
    let (first, others) = trains.split_first().ok_or(ShaperError::Empty)?;
    others
        .iter()
        .try_fold(first.clone(), |all, train| all.convolve(train))
}
