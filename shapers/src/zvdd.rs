//! Zero vibration and two derivatives.

use crate::{GridTrain, ImpulseTrain, Mode, Shaper, ShaperError, Zv, Zvd};

/// ZVDD: [`Zv`] convolved with itself twice; a triple zero at the design mode.
///
/// Amplitudes `1, 3 K, 3 K^2, K^3` over `(1 + K)^3`; times multiples of `T_d / 2`.
///
/// Source: Singer and Seering 1990.
#[derive(Clone, Copy, Debug)]
pub struct Zvdd;

impl Shaper for Zvdd {
    fn name(&self) -> &'static str {
        "zvdd"
    }

    fn title(&self) -> &'static str {
        "ZVDD"
    }

    fn summary(&self) -> &'static str {
        "zero vibration and two derivatives: one and a half periods; below 5 % for +-24 %"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        Zvd.design(mode)?.convolve(&Zv.design(mode)?)
    }

    fn on_grid(&self, mode: Mode, sample_time: f64) -> Result<GridTrain, ShaperError> {
        Zvd.on_grid(mode, sample_time)?
            .convolve(&Zv.on_grid(mode, sample_time)?)
    }
}
