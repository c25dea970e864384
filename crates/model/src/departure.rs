//! Differences between the start of a motion and its measured start.

use super::further_modes::RESONANCES;
use std::ops::{Index, IndexMut};

/// A component of the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StartComponent {
    /// Position of the motor side.
    MotorPosition,
    /// Velocity of the motor side.
    MotorVelocity,
    /// Deformation, positive where the link is ahead.
    Deformation,
    /// Its rate.
    DeformationRate,
    /// Coordinate of a further mode, from 0.
    Mode(usize),
    /// Its rate.
    ModeRate(usize),
}

impl StartComponent {
    /// Those of a number of further modes, at most [`RESONANCES`].
    pub fn of_modes(count: usize) -> impl Iterator<Item = Self> {
        (0..count.min(RESONANCES)).flat_map(|mode| [Self::Mode(mode), Self::ModeRate(mode)])
    }

    /// Whether it belongs to a further mode.
    pub fn is_of_mode(self) -> bool {
        matches!(self, Self::Mode(_) | Self::ModeRate(_))
    }

    fn index(self) -> usize {
        match self {
            Self::MotorPosition => 0,
            Self::MotorVelocity => 1,
            Self::Deformation => 2,
            Self::DeformationRate => 3,
            Self::Mode(mode) => 4 + 2 * mode,
            Self::ModeRate(mode) => 5 + 2 * mode,
        }
    }
}

/// A difference for each component of the start, in the units of the chain's state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Departure([f64; 4 + 2 * RESONANCES]);

impl Index<StartComponent> for Departure {
    type Output = f64;

    /// # Panics
    /// Of a mode beyond [`RESONANCES`].
    fn index(&self, component: StartComponent) -> &f64 {
        &self.0[component.index()]
    }
}

impl IndexMut<StartComponent> for Departure {
    fn index_mut(&mut self, component: StartComponent) -> &mut f64 {
        &mut self.0[component.index()]
    }
}
