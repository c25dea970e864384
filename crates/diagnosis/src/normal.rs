//! The normal equations of a fit: their matrix, their right-hand side, their solution.

use super::belief::Belief;
use super::fit::Linearised;
use super::point::{Global, Point};
use super::problem::Problem;
use nalgebra::{Cholesky, DMatrix, DVector};

impl Problem<'_> {
    /// `J^T J` over shared unknowns and every experiment's own, the beliefs included.
    pub fn normal(&self, point: &Point, linear: &Linearised) -> DMatrix<f64> {
        let size = linear.unknowns();
        let mut normal = DMatrix::zeros(size, size);
        for (jacobian, place) in linear.jacobians.iter().zip(linear.places()) {
            let product = squared(jacobian);
            for (i, &row) in place.iter().enumerate() {
                for (j, &column) in place.iter().enumerate() {
                    normal[(row, column)] += product[(i, j)];
                }
            }
        }
        for belief in self.beliefs_at(point) {
            let slopes = linear.placed(&belief);
            for &(i, slope) in &slopes {
                for &(j, other) in &slopes {
                    normal[(i, j)] += slope * other;
                }
            }
        }
        normal
    }

    /// `J^T r` for residuals of every experiment, the beliefs included.
    pub fn gradient(
        &self,
        point: &Point,
        linear: &Linearised,
        residuals: &[DVector<f64>],
    ) -> DVector<f64> {
        let mut gradient = DVector::zeros(linear.unknowns());
        let parts = linear.jacobians.iter().zip(residuals);
        for ((jacobian, residual), place) in parts.zip(linear.places()) {
            let right = jacobian.tr_mul(residual);
            for (&row, value) in place.iter().zip(right.iter()) {
                gradient[row] += value;
            }
        }
        for belief in self.beliefs_at(point) {
            for (i, slope) in linear.placed(&belief) {
                gradient[i] += slope * belief.departure;
            }
        }
        gradient
    }
}

/// `J^T J`, over blocks of rows that stay in the cache. A product of two matrices is several times faster than
/// one scalar product for each pair of columns.
fn squared(jacobian: &DMatrix<f64>) -> DMatrix<f64> {
    let (rows, columns) = jacobian.shape();
    let mut product = DMatrix::zeros(columns, columns);
    for first in (0..rows).step_by(BLOCK) {
        let block = jacobian.rows(first, BLOCK.min(rows - first));
        product.gemm(1.0, &block.transpose(), &block, 1.0);
    }
    product
}

/// Rows of a block: a hundred columns of it are 200 kB.
const BLOCK: usize = 256;

impl Linearised {
    /// Number of unknowns: the shared ones and every experiment's own.
    fn unknowns(&self) -> usize {
        let shared = self.globals.len();
        let own = self.jacobians.iter().map(|j| j.ncols() - shared);
        shared + own.sum::<usize>()
    }

    /// Derivatives of a belief, each with the index of its unknown.
    fn placed(&self, belief: &Belief) -> Vec<(usize, f64)> {
        let place = |&(global, slope): &(Global, f64)| {
            let index = self.globals.iter().position(|g| *g == global)?;
            Some((index, slope))
        };
        belief.slopes.iter().filter_map(place).collect()
    }

    /// For each experiment the unknowns that its columns belong to.
    fn places(&self) -> Vec<Vec<usize>> {
        let shared = self.globals.len();
        let mut next = shared;
        let mut places = Vec::with_capacity(self.jacobians.len());
        for jacobian in &self.jacobians {
            let own = jacobian.ncols() - shared;
            places.push((0..shared).chain(next..next + own).collect());
            next += own;
        }
        places
    }
}

/// `(N + damping diag N) x = g`.
pub fn solve(normal: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let scale = scales(normal);
    let mut scaled = normal.clone();
    for i in 0..scaled.nrows() {
        for j in 0..scaled.ncols() {
            scaled[(i, j)] /= scale[i] * scale[j];
        }
        // A direction without any effect does not move. The addition keeps the matrix positive in spite of
        // rounding.
        scaled[(i, i)] += damping + 1e-13;
    }
    let right = gradient.component_div(&scale);
    let solution = Cholesky::new(scaled)?.solve(&right).component_div(&scale);
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

/// Square roots of the diagonal; 1 where it is 0.
pub fn scales(normal: &DMatrix<f64>) -> DVector<f64> {
    let root = |x: f64| if x > 0.0 { x.sqrt() } else { 1.0 };
    normal.diagonal().map(root)
}

/// The inverse of the normal matrix, its unknowns divided by [`scales`]. In a direction without any effect the
/// added term gives a standard deviation of a million units.
pub fn covariance(normal: &DMatrix<f64>, scale: &DVector<f64>) -> Option<DMatrix<f64>> {
    let n = normal.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        normal[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-12 } else { 0.0 }
    });
    Cholesky::new(scaled).map(|root| root.inverse())
}

/// Standard deviations of the first unknowns from the inverse of the normal matrix, with the others free. They
/// are large where the data contain no information.
pub fn deviations(normal: &DMatrix<f64>, first: usize) -> Vec<f64> {
    let scale = scales(normal);
    let whole = covariance(normal, &scale);
    let deviation = |i: usize| {
        let variance = whole.as_ref().map_or(f64::INFINITY, |m| m[(i, i)]);
        let unknown = normal[(i, i)] <= 0.0;
        if unknown {
            f64::INFINITY
        } else {
            variance.max(0.0).sqrt() / scale[i]
        }
    };
    (0..first).map(deviation).collect()
}
