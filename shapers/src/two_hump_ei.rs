//! Two-hump extra insensitive.

use crate::equal_ripple::EqualRipple;
use crate::{ImpulseTrain, Mode, Shaper, ShaperError};

/// Two-hump EI: four impulses, a zero at the design mode between two humps of exactly 5 %, and a
/// zero beyond each; solved for the actual damping ratio.
///
/// Without damping, `X = (V^2 (sqrt(1 - V^2) + 1))^(1/3)`, `A_1 = (3 X^2 + 2 X + 3 V^2) / 16 X`,
/// `A_2 = 1/2 - A_1`, symmetric; times multiples of `T/2`. Solved for `xi <= 0.52`; above 0.42
/// the humps are 2 % instead, because humps of 5 % do not exist above 0.446.
///
/// Source: Singhose, Porter, Tuttle and Singer 1997 for the conditions.
#[derive(Clone, Copy, Debug)]
pub struct TwoHumpEi;

impl Shaper for TwoHumpEi {
    fn name(&self) -> &'static str {
        "ei2"
    }

    fn title(&self) -> &'static str {
        "two-hump EI"
    }

    fn summary(&self) -> &'static str {
        "two-hump extra insensitive: one and a half periods; below 5 % for +-36 % of frequency"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        EqualRipple {
            name: self.name(),
            humps: 2,
            ranges: &[(0.42, 0.05), (0.52, 0.02)],
        }
        .design(mode)
    }
}
