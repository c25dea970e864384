//! The energy that a law takes away.

use super::{Curve, Estimate};
use crate::effects::Slot;
use nalgebra::DVector;

/// What a law takes away: of friction the mean over the speeds of the force against motion (energy for a unit of way),
/// of damping the mean coefficient, of a hysteresis the energy of a loop between the largest deformation in both
/// directions. A law that has no motion against it takes nothing.
pub(super) fn dissipated(curve: &Curve) -> Option<Estimate> {
    let count = curve.points.len();
    let weights = match curve.slot {
        Slot::Friction => {
            let sign = curve.points.iter().map(|x| x.signum() / count as f64);
            DVector::from_iterator(count, sign)
        }
        Slot::Damping => DVector::from_element(count, 1.0 / count as f64),
        Slot::Hysteresis => {
            // After Masing the loop is the first way F, twice as large: 8 int F dx - 4 A F(A).
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
