//! The kinds of models, one file each.

use crate::kind::Kind;

/// All kinds. Those of one name differ in their required keys.
pub const KINDS: &[&Kind] = &[
    &crate::flexible_joint::FLEXIBLE_JOINT,
    &crate::rigid_axis::RIGID_AXIS,
    &crate::oscillator::OSCILLATOR,
    &crate::oscillator::SPRING_AND_DAMPER,
    &crate::two_mass::TWO_MASS,
    &crate::inverse_dynamics::INVERSE_DYNAMICS,
];

impl Kind {
    /// The first kind of this name.
    pub fn from_name(name: &str) -> Option<&'static Self> {
        KINDS.iter().copied().find(|kind| kind.name == name)
    }
}
