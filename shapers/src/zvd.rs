//! Zero vibration and derivative.

use crate::{GridTrain, ImpulseTrain, Mode, Shaper, ShaperError, Zv};

/// ZVD: [`Zv`] convolved with itself, so that the residual's slope over frequency vanishes too.
///
/// Amplitudes `1, 2 K, K^2` over `(1 + K)^2`; times `0, T_d / 2, T_d`.
///
/// Source: Singer and Seering 1990.
#[derive(Clone, Copy, Debug)]
pub struct Zvd;

impl Shaper for Zvd {
    fn name(&self) -> &'static str {
        "zvd"
    }

    fn title(&self) -> &'static str {
        "ZVD"
    }

    fn summary(&self) -> &'static str {
        "zero vibration and derivative: one period; stays below 5 % for +-14 % of frequency"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        let zv = Zv.design(mode)?;
        zv.convolve(&zv)
    }

    // Splitting each impulse of ZVD over two ticks keeps the zero but not its order.
    fn on_grid(&self, mode: Mode, sample_time: f64) -> Result<GridTrain, ShaperError> {
        let zv = Zv.on_grid(mode, sample_time)?;
        zv.convolve(&zv)
    }
}
