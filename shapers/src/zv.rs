//! Zero vibration.

use crate::{Impulse, ImpulseTrain, Mode, Shaper, ShaperError};
use core::f64::consts::PI;
use num_traits::Float;

/// ZV: two impulses half a damped period apart.
///
/// `K = exp(-xi pi / sqrt(1 - xi^2))`; amplitudes `1, K` over `1 + K`; times `0, T_d / 2`.
///
/// # Example
/// ```
/// use quell_shapers::{Mode, Shaper, Zv};
/// let train = Zv.design(Mode::from_hertz(1.0, 0.0).unwrap()).unwrap();
/// assert_eq!(train.to_string(), "0.50000 at 0.000000 s, 0.50000 at 0.500000 s");
/// ```
/// Source: Singer and Seering 1990.
#[derive(Clone, Copy, Debug)]
pub struct Zv;

impl Shaper for Zv {
    fn name(&self) -> &'static str {
        "zv"
    }

    fn title(&self) -> &'static str {
        "ZV"
    }

    fn summary(&self) -> &'static str {
        "zero vibration: the shortest with positive impulses, half a period; no room for error"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        let decay = half_period_decay(mode);
        ImpulseTrain::new(&[
            Impulse {
                time: 0.0,
                amplitude: 1.0,
            },
            Impulse {
                time: 0.5 * mode.damped_period(),
                amplitude: decay,
            },
        ])
    }
}

/// `K = exp(-xi pi / sqrt(1 - xi^2))`: what is left of an amplitude after half a damped period.
pub(crate) fn half_period_decay(mode: Mode) -> f64 {
    Float::exp(-PI * mode.decay_rate() / mode.damped_frequency())
}
