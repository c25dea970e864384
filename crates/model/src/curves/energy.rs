//! The energy that a law dissipates.

use super::{Curve, Estimate};
use crate::effects::Slot;
use nalgebra::DVector;

/// Dissipation of a law: for friction the mean over the speeds of the force against motion (energy per
/// distance) or the mean level over the positions, for damping the mean coefficient over its coordinate, for a hysteresis the energy of a loop between the largest
/// deformations in both directions. `None` for laws that dissipate nothing.
pub(super) fn dissipated(curve: &Curve) -> Option<Estimate> {
    let count = curve.points.len();
    let weights = match curve.slot {
        Slot::Friction => {
            // Each direction has its own points, which may be dense about rest.
            let at = |k: usize| curve.points[k.min(count - 1)];
            let same = |k: usize| (k < count / 2) == (k + 1 < count / 2);
            let way = |k: usize| if same(k) { at(k + 1) - at(k) } else { 0.0 };
            let width = |k: usize| 0.5 * (way(k) + if k > 0 { way(k - 1) } else { 0.0 });
            let all = curve.points[count - 1] - curve.points[0];
            DVector::from_fn(count, |k, _| at(k).signum() * width(k) / all)
        }
        Slot::Damping | Slot::PositionDamping | Slot::DampingDrift | Slot::PositionFriction => {
            DVector::from_element(count, 1.0 / count as f64)
        }
        Slot::Hysteresis => {
            // By Masing's rule the loop consists of two branches, the first one enlarged twice: 8 int F dx - 4
            // A F(A).
            let step = curve.points[count - 1] / (count - 1) as f64;
            let mut weights = DVector::from_element(count, 8.0 * step);
            weights[0] *= 0.5;
            weights[count - 1] *= 0.5;
            weights[count - 1] -= 4.0 * curve.points[count - 1];
            weights
        }
        _ => return None,
    };
    Some(curve.estimate(&weights))
}
