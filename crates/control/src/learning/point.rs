//! A mode in a move: the nonlinear unknowns, and their prior.

use nalgebra::{SMatrix, SVector};

use super::map::Predicted;
use super::path::NODES;

/// Unknowns of a mode that do not enter linearly: `ln w` at the nodes, and `xi`.
pub const OF_A_MODE: usize = NODES + 1;

/// A mode in a move, fitted or believed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// `ln w` at the nodes.
    pub log_w: [f64; NODES],
    /// Damping ratio.
    pub xi: f64,
}

impl Point {
    /// `ln w` at the nodes, and `xi`.
    pub fn vector(&self) -> SVector<f64, OF_A_MODE> {
        SVector::from_fn(|i, _| match i {
            NODES => self.xi,
            i => self.log_w[i],
        })
    }
}

/// The prior of a mode on the way of a move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prior {
    /// `ln w` at the nodes.
    pub log_w: Predicted,
    /// Mean and variance of `xi`.
    pub xi: (f64, f64),
}

impl Prior {
    /// Its mean.
    pub fn point(&self) -> Point {
        Point {
            log_w: self.log_w.mean.into(),
            xi: self.xi.0,
        }
    }

    /// The same as a vector.
    pub fn mean(&self) -> SVector<f64, OF_A_MODE> {
        self.point().vector()
    }

    /// Inverse covariance.
    pub fn precision(&self) -> SMatrix<f64, OF_A_MODE, OF_A_MODE> {
        let mut precision = SMatrix::<f64, OF_A_MODE, OF_A_MODE>::zeros();
        // An independent variance for each node keeps the matrix regular if all nodes are at one place.
        let jitter = SMatrix::from_diagonal_element(1e-8);
        let inverse = (self.log_w.covariance + jitter).try_inverse();
        let inverse = inverse.unwrap_or_else(|| SMatrix::from_diagonal_element(1e8));
        precision
            .fixed_view_mut::<NODES, NODES>(0, 0)
            .copy_from(&inverse);
        precision[(NODES, NODES)] = self.xi.1.recip();
        precision
    }
}
