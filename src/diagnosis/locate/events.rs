//! Whether a few events explain the whole residual.

use super::basis::{Basis, dot};
use super::smoother::Smoother;
use super::suspects::{Kind, Suspect};
use super::{Residual, colour};

/// Parameters of an event: its time, its size, and the shift of its time between stamps.
const PARAMETERS: f64 = 3.0;

/// What events explain of a residual.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Events {
    /// Log-likelihood gain over noise, less half the logarithm of the length for each parameter.
    pub evidence: f64,
    /// How many there are.
    pub count: usize,
}

/// Takes the response to each suspected jump from the residual as long as it earns its parameters.
pub(super) fn events(
    residual: &Residual,
    suspects: &[Suspect],
    smoother: &Smoother,
    refit: &Basis,
) -> Events {
    let n = residual.time.len() as f64;
    let cost = 0.5 * PARAMETERS * n.ln();
    let mut basis = refit.clone();
    let mut left = basis.without(residual.residual);
    let mut found = Events::default();
    for suspect in suspects {
        let columns = match suspect.kind {
            Kind::Knock => [1, 0],
            Kind::Onset => [2, 1],
            Kind::Change => continue,
        };
        let mut tried = basis.clone();
        for component in columns {
            tried.add(&smoother.after_jump(suspect.at, component));
        }
        let rest = tried.without(&left);
        let gain = 0.5 * n * (dot(&left, &left) / dot(&rest, &rest).max(f64::MIN_POSITIVE)).ln();
        if gain > cost {
            (basis, left) = (tried, rest);
            found.count += 1;
        }
    }
    if found.count > 0 {
        let gain = colour::likelihood(residual.time, &left)
            - colour::likelihood(residual.time, residual.residual);
        found.evidence = gain - cost * found.count as f64;
    }
    found
}
