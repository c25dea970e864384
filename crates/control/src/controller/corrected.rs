//! The modes that a correction under way is for.

use quell_shapers::{CORRECTED_MODES, Mode, UncertainMode};

/// One to three modes, kept without an allocation.
#[derive(Clone, Copy, Debug)]
pub struct Corrected {
    modes: [UncertainMode; CORRECTED_MODES],
    count: usize,
}

impl Corrected {
    /// The first of these modes; there must be at least one.
    pub fn of(modes: &[UncertainMode]) -> Self {
        let count = modes.len().clamp(1, CORRECTED_MODES);
        Self {
            modes: core::array::from_fn(|k| modes[k.min(count - 1)]),
            count,
        }
    }

    /// The modes.
    pub fn modes(&self) -> &[UncertainMode] {
        &self.modes[..self.count]
    }

    /// Whether the correction was for this mode, within the uncertainty of the correction's modes.
    pub fn is_near(&self, mode: Mode) -> bool {
        self.modes().iter().any(|known| known.is_near(mode))
    }
}
