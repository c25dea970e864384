//! The modes that a correction under way is for.

use quell_shapers::{CORRECTED_MODES, Mode, UncertainMode};

/// One to three modes, kept without an allocation.
#[derive(Clone, Copy, Debug)]
pub struct Corrected {
    modes: [UncertainMode; CORRECTED_MODES],
    count: usize,
    /// Whether the plan has changed since.
    replanned: bool,
}

impl Corrected {
    /// The first of these modes; there must be at least one.
    pub fn of(modes: &[UncertainMode]) -> Self {
        let count = modes.len().clamp(1, CORRECTED_MODES);
        Self {
            modes: core::array::from_fn(|k| modes[k.min(count - 1)]),
            count,
            replanned: false,
        }
    }

    /// The same modes, after the correction was computed again for another plan.
    pub fn replanned(self) -> Self {
        Self {
            replanned: true,
            ..self
        }
    }

    /// The modes.
    pub fn modes(&self) -> &[UncertainMode] {
        &self.modes[..self.count]
    }

    /// Whether no other correction is needed for this mode: it is within the uncertainty of the correction's
    /// modes. After a change of the plan the limits may not have allowed to cancel all.
    pub fn suffices_for(&self, mode: Mode) -> bool {
        !self.replanned && self.modes().iter().any(|known| known.is_near(mode))
    }
}
