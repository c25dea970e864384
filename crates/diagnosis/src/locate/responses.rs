//! Whether a few causes of known shape explain the whole residual: events, forces periodic in position.

use super::basis::{Basis, dot};
use super::candidate_events::{CandidateEvent, Kind};
use super::smoother::Smoother;
use super::{Residual, colour};

/// Parameters of a cause: when or where, its size, and the shift of its time or its phase.
pub(super) const PARAMETERS: f64 = 3.0;

/// The error's response to an impact or a force that sets in; the second column shifts it in time. `None` for a
/// lasting change of how the force depends on the motion.
pub(super) fn to_event(smoother: &Smoother, event: &CandidateEvent) -> Option<[Vec<f64>; 2]> {
    let components = match event.kind {
        Kind::Impact => [1, 0],
        Kind::Onset => [2, 1],
        Kind::Change => return None,
    };
    Some(components.map(|component| smoother.after_jump(event.at, component)))
}

/// The error's response to a sine and a cosine over the motor side's position, of this many radians
/// for one unit of it.
pub(super) fn to_order(residual: &Residual, smoother: &Smoother, order: f64) -> [Vec<f64>; 2] {
    [f64::sin, f64::cos].map(|wave| {
        let force: Vec<f64> = residual.motor.iter().map(|m| wave(order * m[0])).collect();
        smoother.response(&force)
    })
}

/// Log-likelihood gain of these responses over noise. Each is included if it gains half the logarithm of the
/// length for each of its parameters (Schwarz, 1978), and that cost is subtracted.
pub(super) fn evidence(
    residual: &Residual,
    refit: &Basis,
    causes: impl Iterator<Item = [Vec<f64>; 2]>,
) -> f64 {
    let n = residual.time.len() as f64;
    let cost = 0.5 * PARAMETERS * n.ln();
    let mut basis = refit.clone();
    let mut left = basis.without(residual.residual);
    let mut count = 0;
    for columns in causes {
        let mut tried = basis.clone();
        for column in &columns {
            tried.add(column);
        }
        let rest = tried.without(&left);
        let gain = 0.5 * n * (dot(&left, &left) / dot(&rest, &rest).max(f64::MIN_POSITIVE)).ln();
        if gain > cost {
            (basis, left) = (tried, rest);
            count += 1;
        }
    }
    if count == 0 {
        return 0.0;
    }
    let without = colour::likelihood(residual.time, residual.residual);
    colour::likelihood(residual.time, &left) - without - cost * f64::from(count)
}
