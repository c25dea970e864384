//! The inertia that a robot's description gives a joint, for the map of its lowest mode.

use std::fmt;
use std::sync::Arc;

/// From the position of the joint (rad), those of the others (rad), and the payload (kg) to an inertia, kg m^2.
type Function = dyn Fn(f64, &[f64], f64) -> f64 + Send + Sync;

/// Inertia of everything that a joint carries, about its axis, over pose and payload.
///
/// A rigid body on a spring has `w^2 = k / J`: with a constant spring the frequency of the lowest mode follows
/// `J`. The map of that mode then only holds the rest, `c = J / J_described`, which is constant if the
/// description is right.
#[derive(Clone)]
pub struct Inertia(Arc<Function>);

impl Inertia {
    /// An inertia from a function of the joint's position (rad), the positions of the others (rad) and the
    /// payload (kg). Values that are not finite and above 0 count as unknown.
    pub fn new(function: impl Fn(f64, &[f64], f64) -> f64 + Send + Sync + 'static) -> Self {
        Self(Arc::new(function))
    }

    /// `ln J`; 0 where it is not known.
    pub(super) fn log(&self, position: f64, others: &[f64], payload: f64) -> f64 {
        let log = (self.0)(position, others, payload).ln();
        if log.is_finite() { log } else { 0.0 }
    }
}

impl fmt::Debug for Inertia {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Inertia")
    }
}
