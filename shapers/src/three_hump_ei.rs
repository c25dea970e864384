//! Three-hump extra insensitive.

use crate::equal_ripple::EqualRipple;
use crate::{ImpulseTrain, Mode, Shaper, ShaperError};

/// Three-hump EI: five impulses, three humps of exactly 5 %, the middle one at the design mode,
/// and the four zeros around them; solved for the actual damping ratio.
///
/// Without damping, `A_1 = (1 + 3 V + 2 sqrt(2 (V^2 + V))) / 16`, `A_2 = (1 - V) / 4`,
/// `A_3 = 1 - 2 (A_1 + A_2)`, symmetric; times multiples of `T/2`. Solved for `xi <= 0.4`; above
/// 0.27 the humps are 2 % instead, because humps of 5 % do not exist above 0.2756.
///
/// Source: Singhose, Porter, Tuttle and Singer 1997 for the conditions.
#[derive(Clone, Copy, Debug)]
pub struct ThreeHumpEi;

impl Shaper for ThreeHumpEi {
    fn name(&self) -> &'static str {
        "ei3"
    }

    fn title(&self) -> &'static str {
        "three-hump EI"
    }

    fn summary(&self) -> &'static str {
        "three-hump extra insensitive: two periods; below 5 % for +-48 % of frequency"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        EqualRipple {
            name: self.name(),
            humps: 3,
            ranges: &[(0.27, 0.05), (0.4, 0.02)],
        }
        .design(mode)
    }
}
