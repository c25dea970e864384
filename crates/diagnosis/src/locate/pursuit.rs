//! Orthogonal matching pursuit of forces periodic in position: the orders whose responses explain the residual.
//!
//! Source: Pati, Rezaiifar, Krishnaprasad, "Orthogonal matching pursuit", Asilomar Conference (1993).

use super::basis::{Basis, dot};
use super::responses::{PARAMETERS, to_order};
use super::smoother::Smoother;
use super::{MOST, Residual};

/// An order, and what its responses add to those that were chosen.
struct Candidate {
    order: f64,
    responses: [Vec<f64>; 2],
}

/// The orders that explain the residual, each beside those before it, the one that explains most first. Each
/// gains more than half the logarithm of the length for each of its parameters (Schwarz, 1978).
pub(super) fn pursued(
    residual: &Residual,
    (smoother, refit): (&Smoother, &Basis),
    orders: Vec<f64>,
) -> Vec<f64> {
    let n = residual.time.len() as f64;
    let cost = 0.5 * PARAMETERS * n.ln();
    let mut left = refit.without(residual.residual);
    let candidate = |order| Candidate {
        order,
        responses: to_order(residual, smoother, order).map(|own| refit.without(&own)),
    };
    let mut candidates: Vec<Candidate> = orders.into_iter().map(candidate).collect();
    let mut found = Vec::new();
    while found.len() < MOST {
        let rests = candidates.iter().map(|own| {
            let rest = own.directions().without(&left);
            dot(&rest, &rest)
        });
        let best = rests.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
        let gain = |rest: f64| 0.5 * n * (dot(&left, &left) / rest.max(f64::MIN_POSITIVE)).ln();
        let Some((best, _)) = best.filter(|&(_, rest)| gain(rest) > cost) else {
            break;
        };
        let chosen = candidates.swap_remove(best);
        let directions = chosen.directions();
        directions.remove(&mut left);
        for response in candidates.iter_mut().flat_map(|own| &mut own.responses) {
            directions.remove(response);
        }
        found.push(chosen.order);
    }
    found
}

impl Candidate {
    fn directions(&self) -> Basis {
        let mut basis = Basis::default();
        for response in &self.responses {
            basis.add(response);
        }
        basis
    }
}
