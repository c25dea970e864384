//! Information of data about the shared unknowns of an explanation, as a quadratic form. Forms add.

use crate::normal::{scales, solve};
use crate::point::Point;
use crate::problem::Problem;
use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Add;

/// `c + 2 g^T d + d^T N d`: the least sum of squares where the shared unknowns are `d` away from the point of
/// linearisation, and the others (clocks, starts, offsets, frames) are at their optimum.
#[derive(Clone)]
pub struct Information {
    constant: f64,
    gradient: DVector<f64>,
    normal: DMatrix<f64>,
}

impl Information {
    /// The form for a problem's experiments about a point: the Schur complement of its normal equations.
    pub fn new(problem: &Problem, point: &Point) -> Self {
        let projector = crate::projector::Projector::new(problem);
        let linear = problem.linearise(point, &projector);
        let normal = problem.normal(point, &linear);
        let gradient = problem.gradient(point, &linear, &linear.residuals);
        let shared = linear.globals.len();
        let own = normal.nrows() - shared;
        let mut reduced = Self {
            constant: linear.cost,
            normal: normal.view((0, 0), (shared, shared)).into_owned(),
            gradient: gradient.rows(0, shared).into_owned(),
        };
        let block = normal.view((shared, shared), (own, own)).into_owned();
        let scale = scales(&block);
        let scaled = DMatrix::from_fn(own, own, |i, j| {
            // A direction without any effect is left out; the addition keeps the matrix positive in spite of
            // rounding.
            block[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-13 } else { 0.0 }
        });
        let Some(root) = Cholesky::new(scaled) else {
            return reduced;
        };
        let mixed = DMatrix::from_fn(own, shared, |i, j| normal[(shared + i, j)] / scale[i]);
        let right = gradient.rows(shared, own).component_div(&scale);
        let solved = root.solve(&right);
        reduced.constant -= right.dot(&solved);
        reduced.gradient -= mixed.tr_mul(&solved);
        reduced.normal -= mixed.tr_mul(&root.solve(&mixed));
        reduced
    }

    /// The largest value of the quadratic part if each unknown is off by no more than its step, with the steps
    /// as half axes of an ellipsoid: the largest eigenvalue of `S N S`. 0 where that is NaN.
    pub fn largest(&self, steps: &DVector<f64>) -> f64 {
        let n = steps.len();
        let scaled = DMatrix::from_fn(n, n, |i, j| self.normal[(i, j)] * steps[i] * steps[j]);
        if scaled.iter().any(|value| !value.is_finite()) {
            return 0.0;
        }
        let values = scaled.symmetric_eigenvalues();
        values.iter().copied().fold(0.0, f64::max)
    }

    /// The square part of one unknown, the other shared ones known.
    pub fn alone(&self, unknown: usize) -> f64 {
        let value = self.normal[(unknown, unknown)];
        if value.is_finite() { value } else { 0.0 }
    }

    /// The least value of the form.
    pub fn least(&self) -> f64 {
        let step = solve(&self.normal, &self.gradient, 0.0);
        self.constant - step.map_or(0.0, |step| step.dot(&self.gradient))
    }
}

impl Add for &Information {
    type Output = Information;

    fn add(self, other: Self) -> Information {
        Information {
            constant: self.constant + other.constant,
            gradient: &self.gradient + &other.gradient,
            normal: &self.normal + &other.normal,
        }
    }
}
