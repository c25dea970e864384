//! Several axes that move together.
//!
//! A move of several axes follows a path in space because every axis is a function of one common
//! path parameter. Two ways to shape it:
//!
//! * the strict way, [`common_train`]: the SAME train, the convolution of what each axis needs, runs
//!   on every axis. In joint space a straight line then stays the same straight line to rounding;
//!   the price is the sum of all delays.
//! * the light way, [`align_delays`]: each axis keeps its own train, and those that are shorter are
//!   delayed as a whole until the mean delays agree. The axes lag alike to first order; the path
//!   departs by the acceleration times half the difference of the trains' variances.

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

/// Delays the shorter trains by whole ticks until all mean delays agree to half a tick.
///
/// # Errors
/// [`ShaperError::SampleTimeMismatch`].
pub fn align_delays(trains: &mut [GridTrain]) -> Result<(), ShaperError> {
    let Some(first) = trains.first().cloned() else {
        return Ok(());
    };
    for train in trains.iter() {
        first.check_same_grid(train.sample_time())?;
    }
    let longest = trains.iter().map(GridTrain::mean_delay).fold(0.0, f64::max);
    for train in trains {
        let ticks = (longest - train.mean_delay()) / train.sample_time();
        *train = train.delayed((ticks + 0.5) as u32);
    }
    Ok(())
}
