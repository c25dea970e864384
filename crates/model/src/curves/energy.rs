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
            let points = &curve.points;
            let range = points[count - 1] - points[0];
            let mut weights = DVector::zeros(count);
            for k in (1..count).filter(|k| *k != count / 2) {
                let half = 0.5 * (points[k] - points[k - 1]) / range;
                weights[k - 1] += half * points[k - 1].signum();
                weights[k] += half * points[k].signum();
            }
            weights
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
