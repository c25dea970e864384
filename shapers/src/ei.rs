//! Extra insensitive.

use crate::equal_ripple::EqualRipple;
use crate::{ImpulseTrain, Mode, Shaper, ShaperError};

/// EI: three impulses that leave exactly 5 % at the design mode, with zero slope, and nothing at
/// one frequency on either side of it; solved for the actual damping ratio.
///
/// Without damping: amplitudes `(1 + V)/4, (1 - V)/2, (1 + V)/4`, times `0, T/2, T`, `V = 0.05`.
/// Solved for `xi <= 0.6`.
///
/// Source: Singhose, Seering and Singer 1994 for the conditions; the undamped amplitudes times
/// `K^i` meet them only approximately.
#[derive(Clone, Copy, Debug)]
pub struct Ei;

impl Shaper for Ei {
    fn name(&self) -> &'static str {
        "ei"
    }

    fn title(&self) -> &'static str {
        "EI"
    }

    fn summary(&self) -> &'static str {
        "extra insensitive: one period; 5 % at the design mode, below 5 % for +-20 % of frequency"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        EqualRipple {
            name: self.name(),
            humps: 1,
            ranges: &[(0.6, 0.05)],
        }
        .design(mode)
    }
}
