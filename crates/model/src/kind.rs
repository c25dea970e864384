//! Kinds of models: the structures that an engineer may believe in.

use super::chain::Linear;
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;

/// Damping ratio from which the response of second order has no half-power bandwidth, `sin(pi/8)`: its peak,
/// `1 / (2 xi sqrt(1 - xi^2))`, is then lower than `sqrt(2)` times the response at rest.
pub const NO_RESONANCE: f64 = 0.382_683_432_365_089_8;

/// A key of a model file.
#[derive(Clone, Copy)]
pub struct Key {
    /// Name in the file.
    pub name: &'static str,
    /// Its unit, if the name does not contain it.
    pub quantity: Quantity,
    /// Value if the file does not give it; `None` if it must. A default outside the range switches a term off:
    /// a file may contain it, too, and it is not fitted.
    pub default: Option<f64>,
    /// Least and greatest meaningful value.
    pub range: (f64, f64),
    /// Usual standard deviation of an engineer's belief, if the file gives none: relative (of the logarithm) if
    /// the range is above 0, absolute else. 0 for exactly known values, which are not fitted.
    pub belief: f64,
}

/// One kind.
pub struct Kind {
    /// Name in the file.
    pub name: &'static str,
    /// Its keys, in the order in which [`Kind::linear`] takes their values.
    pub keys: &'static [Key],
    /// Roles of channels that can drive it, the preferred one first.
    pub inputs: &'static [Role],
    /// Channels that it predicts.
    pub outputs: &'static [Role],
    /// Places of possible missing physics, when driven by this input.
    pub places: fn(Role) -> &'static [Place],
    /// Whether an input of this role can drive it, for these values of the keys.
    pub takes: fn(&[f64], Role) -> bool,
    /// The course of its input between samples unless the file says otherwise.
    pub hold: fn(Role) -> Hold,
    /// The chain for values of the keys.
    pub linear: fn(&[f64], Role) -> Linear,
    /// The chain's force for 1 N (1 N.m where the axis turns) on the link; `None` where the keys do not
    /// determine it.
    pub newton: fn(&[f64]) -> Option<f64>,
    /// Indices of the keys for natural frequency (Hz) and damping ratio, if it has them.
    pub mode: Option<(usize, usize)>,
    /// Whether forces are divided by the stiffness, so that they are in the unit of positions.
    pub normalised: bool,
    /// Whether the second derivative of a recorded position is taken, which noise needs a smoother for.
    pub differentiates: bool,
}

impl Kind {
    /// Values of the keys with the link's inertia (the mass of a rigid axis) multiplied by a factor. With
    /// constant stiffness and damper, natural frequency and damping ratio fall with its root.
    pub fn loaded(&self, keys: &[f64], inertia: f64) -> Vec<f64> {
        let mut loaded = keys.to_vec();
        if let Some((frequency, damping)) = self.mode {
            loaded[frequency] /= inertia.sqrt();
            loaded[damping] /= inertia.sqrt();
        }
        if let Some(key) = self.key("link_inertia").or(self.key("mass")) {
            loaded[key] *= inertia;
        }
        loaded
    }

    /// Index of a key.
    pub fn key(&self, name: &str) -> Option<usize> {
        self.keys.iter().position(|key| key.name == name)
    }
}
