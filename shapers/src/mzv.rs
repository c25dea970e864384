//! Modified zero vibration.

use crate::{Impulse, ImpulseTrain, Mode, Shaper, ShaperError};
use core::f64::consts::{FRAC_1_SQRT_2, PI, SQRT_2};
use num_traits::Float;

/// MZV: three impulses, three eighths of a damped period apart.
///
/// `K = exp(-3 xi pi / (4 sqrt(1 - xi^2)))`; amplitudes `1 - 1/sqrt 2, (sqrt 2 - 1) K,
/// (1 - 1/sqrt 2) K^2`, scaled to sum 1; times `0, 3 T_d / 8, 3 T_d / 4`. Its zero at the design
/// mode is exact for every damping ratio.
#[derive(Clone, Copy, Debug)]
pub struct Mzv;

impl Shaper for Mzv {
    fn name(&self) -> &'static str {
        "mzv"
    }

    fn title(&self) -> &'static str {
        "MZV"
    }

    fn summary(&self) -> &'static str {
        "modified zero vibration: three quarters of a period; below 5 % for +-5 % of frequency"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        let spacing = 0.375 * mode.damped_period();
        let decay = Float::exp(-0.75 * PI * mode.decay_rate() / mode.damped_frequency());
        let outer = 1.0 - FRAC_1_SQRT_2;
        ImpulseTrain::new(&[
            Impulse {
                time: 0.0,
                amplitude: outer,
            },
            Impulse {
                time: spacing,
                amplitude: (SQRT_2 - 1.0) * decay,
            },
            Impulse {
                time: 2.0 * spacing,
                amplitude: outer * decay * decay,
            },
        ])
    }
}
