//! Zero vibration and derivative.

use crate::zv::half_period_decay;
use crate::{GridTrain, Impulse, ImpulseTrain, Mode, Shaper, ShaperError, Zv};

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
        let (decay, half) = (half_period_decay(mode), 0.5 * mode.damped_period());
        let impulse = |time, amplitude| Impulse { time, amplitude };
        ImpulseTrain::new(&[
            impulse(0.0, 1.0),
            impulse(half, 2.0 * decay),
            impulse(2.0 * half, decay * decay),
        ])
    }

    // Splitting each impulse of ZVD over two ticks keeps the zero but not its order.
    fn on_grid(&self, mode: Mode, sample_time: f64) -> Result<GridTrain, ShaperError> {
        // By reference: a train has 4 KiB.
        let zv = Zv.on_grid(mode, sample_time);
        let zv = zv.as_ref().map_err(Clone::clone)?;
        zv.convolve(zv)
    }
}
