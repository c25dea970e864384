//! A marginal likelihood by Laplace's approximation, at any temperature: see [`evidence`](super::evidence).

use super::autocorrelation::correlation;
use super::views::Both;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A marginal likelihood. The unknowns are in units of their prior standard deviations; corrections of the
/// laws' shapes come last.
#[derive(Clone, Debug)]
pub struct Marginal {
    /// Sum of squares of the fitted rows, and twice the negative logarithm of the prior density, at the fit.
    pub cost: [f64; 2],
    /// Half the gradients of the two: of the former by the unknowns that are not fitted, of the latter by all.
    pub pulls: [DVector<f64>; 2],
    /// Share of the gain predicted by the first gradient that is real, laws being curved.
    pub kept: f64,
    /// `W J'J W`.
    pub information: DMatrix<f64>,
    /// Sum of squares of the fitted rows beyond the corrections.
    pub left: f64,
    /// `q' (I + H S H')^-1 q` and `ln det(I + H S H')`.
    pub beyond: (f64, f64),
    /// Number of samples of the residual that are worth one independent sample.
    pub correlation: f64,
}

impl Marginal {
    /// The marginal from the prior's cost, the rows at the fit (`here`) and with corrections (`there`), the
    /// derivatives of fitted and held-out rows, and half the gradient of the prior's cost.
    pub fn new(
        believed: f64,
        here: &Both,
        there: &Both,
        slopes: &[DMatrix<f64>; 2],
        pull: DVector<f64>,
    ) -> Self {
        let information = slopes[0].tr_mul(&slopes[0]);
        let (_, root) = inverse(&information);
        let count = information.nrows();
        Self {
            cost: [here[0].norm_squared(), believed],
            pulls: [DVector::zeros(count), pull.resize_vertically(count, 0.0)],
            kept: 1.0,
            information,
            left: there[0].norm_squared(),
            beyond: beyond(&there[1], &(&slopes[1] * root)),
            correlation: correlation(&there[0]),
        }
    }

    pub fn log(&self, temperature: f64) -> f64 {
        self.of_fitted(temperature) + self.of_held_out(temperature)
    }

    pub fn of_fitted(&self, temperature: f64) -> f64 {
        let n = self.information.nrows();
        let whole = DMatrix::identity(n, n) + &self.information / temperature;
        let [rows, beliefs] = &self.pulls;
        let pull = rows / temperature + beliefs * (1.0 - 1.0 / temperature);
        let Some(root) = Cholesky::new(whole) else {
            return f64::NEG_INFINITY;
        };
        let gained = self.kept * pull.dot(&root.solve(&pull));
        let [left, believed] = self.cost;
        -0.5 * (left / temperature + believed - gained + log_determinant(&root))
    }

    pub fn of_held_out(&self, temperature: f64) -> f64 {
        -0.5 * (self.beyond.0 / temperature + self.beyond.1)
    }
}

/// Covariance `(I + information)^-1` of the unknowns, and a root `R R'` of it.
pub fn inverse(information: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = information.nrows();
    let eigen = (information + DMatrix::identity(n, n)).symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| 1.0 / value.max(1.0).sqrt());
    let root = &eigen.eigenvectors * DMatrix::from_diagonal(&roots);
    (&root * root.transpose(), root)
}

/// `q' (I + B B')^-1 q` and `ln det(I + B B')` for the residual `q` and the errors `B` of the fit.
fn beyond(left: &DVector<f64>, errors: &DMatrix<f64>) -> (f64, f64) {
    let n = errors.ncols();
    let product = errors.tr_mul(left);
    let Some(root) = Cholesky::new(DMatrix::identity(n, n) + errors.tr_mul(errors)) else {
        return (f64::INFINITY, 0.0);
    };
    let foreseen = product.dot(&root.solve(&product));
    (left.norm_squared() - foreseen, log_determinant(&root))
}

/// Log determinant of a matrix by its factor.
fn log_determinant(root: &Cholesky<f64, Dyn>) -> f64 {
    let diagonal = root.l_dirty().diagonal();
    2.0 * diagonal.iter().map(|value| value.ln()).sum::<f64>()
}
