//! The one score of an explanation: its log marginal likelihood.
//!
//! With whitened residuals `r` of the fitted rows, their derivatives `J`, and prior widths `W` (a diagonal), Laplace's
//! approximation about the fit is
//!
//! ```text
//! ln p(y) = -|r|^2 / 2T - c / 2 - ln det(I + W J'J W / T) / 2 + ln p(structure)
//! ```
//!
//! where `c` is twice the negative logarithm of the prior density at the fit, which does not depend on the
//! temperature. The fit is that of `T = 1`. Let `p` be half the gradient of `c`, and `g = W J'r` the gradient
//! by what is not fitted yet, both at the fit. Then the optimum at another temperature is better by
//!
//! ```text
//! h' (I + W J'J W / T)^-1 h ,   h = g / T + (1 - 1 / T) p
//! ```
//!
//! Held-out rows count by their predictive density, with the errors of the fit propagated: with residuals `q`,
//! their derivatives `H` and the covariance `S = (J'J + W^-2)^-1` of the unknowns,
//!
//! ```text
//! ln p(y_held | y) = -q' (I + H S H')^-1 q / 2T - ln det(I + H S H') / 2
//! ```
//!
//! The sum of both is the marginal likelihood of the whole recording. The temperature `T` is the chi-squared
//! per row of the best explanation's residual, times the number of its samples that are worth one independent
//! sample. If the residual is more than noise, it is thus known no better than its own size and correlation
//! allow.
//!
//! Source: MacKay, Neural Computation 4 (1992); Kass and Raftery, J. American Statistical Association 90 (1995).

use super::curves;
use super::fit::Fitted;
use super::marginal::{Marginal, inverse};
use super::point::{Global, Point};
use super::problem::Problem;
use super::shape::Corrections;
use super::views::{Views, joined};
use nalgebra::{DMatrix, DVector};

/// Temperature of the evidence where only noise is left.
///
/// The likelihood takes the noise for Gaussian, of known level and colour, and the input for exact. Neither
/// holds: the level is known within a tenth, and an encoder's rounding is coherent with the motion. On
/// recordings without a hidden effect the best effect lowered the criterion by up to 29. On recordings with one
/// the true effect lowered it by 88 or more. At this temperature the former is less than the cost of one more
/// effect, the latter is more.
pub const CALIBRATED: f64 = 4.0;

/// Log of the prior probability that a law has exactly the shape of the catalogue; the opposite has the same.
const EXACT_OR_NOT: f64 = -std::f64::consts::LN_2;

/// The parts of the marginal likelihood of a fitted structure.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// With laws of exactly the shape of the catalogue.
    exact: Marginal,
    /// With an uncertain shape; `None` where no law has one.
    shaped: Option<Marginal>,
    /// Root `W W'` of the prior covariance of what was fitted.
    scale: DMatrix<f64>,
    /// `|q|^2` of the held-out rows.
    held_out: f64,
    /// Log of the prior probability of the structure.
    prior: f64,
    /// Whether held-out rows count. They do not where each window has its own start, which absorbs most of an
    /// error.
    foresees: bool,
}

impl Evidence {
    /// The evidence of a fitted structure; its laws have an uncertain shape where `shaped`.
    pub fn new(problem: &Problem, views: &Views, fitted: &Fitted, shaped: bool) -> Self {
        let point = &fitted.point;
        let here = views.see(point);
        let (scale, curves) = scale(problem, point);
        let slopes = views.slopes(point, &here).map(|slopes| slopes * &scale);
        let pull = scale.tr_mul(&pull(problem, fitted, scale.nrows()));
        let believed = problem.disbelief(point);
        let exact = Marginal::new(believed, &here, &here, &slopes, pull);
        let shaped = shaped.then(|| Corrections::new(problem, views, point, &here));
        let shaped = shaped.filter(|corrections| !corrections.columns.is_empty());
        let shaped = shaped.map(|corrections| {
            let shapes = joined(&corrections.columns, &here);
            let both = [0, 1].map(|k| beside(&slopes[k], &shapes[k]));
            let unfitted = both[0]
                .tr_mul(&here[0])
                .rows_range(scale.ncols()..)
                .into_owned();
            let step = asked_for(&both[0], &unfitted);
            let sizes = -step.rows_range(scale.ncols()..);
            let own = &scale * step.rows(0, scale.ncols());
            // The part that the corrections really explain, beyond first order.
            let moved = problem.stepped(point, &fitted.globals, &own);
            let there = views.see(&corrections.applied(&moved, &sizes));
            let mut marginal =
                Marginal::new(believed, &here, &there, &both, exact.pulls[1].clone());
            let promised = -unfitted.dot(&sizes);
            let fell = marginal.cost[0] - marginal.left - sizes.norm_squared();
            marginal.kept = (fell / promised).clamp(0.0, 1.0);
            marginal.pulls[0]
                .rows_range_mut(scale.ncols()..)
                .copy_from(&unfitted);
            marginal
        });
        Self {
            exact,
            shaped,
            scale,
            held_out: here[1].norm_squared(),
            prior: problem.log_prior(point) + curves,
            foresees: problem.experiments.iter().all(|e| e.windows.is_empty()),
        }
    }

    /// Log marginal likelihood of fitted and held-out rows, up to a constant that all structures share.
    pub fn log(&self, temperature: f64) -> f64 {
        self.of_fitted(temperature) + self.of_held_out(temperature)
    }

    /// Log marginal likelihood of the fitted rows, plus the log prior of the structure.
    pub fn of_fitted(&self, temperature: f64) -> f64 {
        let (marginal, prior) = self.likelier(temperature);
        marginal.of_fitted(temperature) + prior + self.prior
    }

    /// Log predictive density of the held-out rows.
    pub fn of_held_out(&self, temperature: f64) -> f64 {
        match self.foresees {
            true => self.likelier(temperature).0.of_held_out(temperature),
            false => 0.0,
        }
    }

    /// The likelier of exact and uncertain shapes, with its log prior.
    fn likelier(&self, temperature: f64) -> (&Marginal, f64) {
        let Some(shaped) = &self.shaped else {
            return (&self.exact, 0.0);
        };
        match shaped.log(temperature) > self.exact.log(temperature) {
            true => (shaped, EXACT_OR_NOT),
            false => (&self.exact, EXACT_OR_NOT),
        }
    }

    /// Covariance of all unknowns, the shared ones first, as the fit sees them.
    pub fn covariance(&self, temperature: f64) -> DMatrix<f64> {
        let information = &self.likelier(temperature).0.information;
        let covariance = inverse(&(information / temperature)).0;
        let own = self.scale.nrows();
        &self.scale * covariance.view((0, 0), (own, own)) * self.scale.transpose()
    }

    /// Standard deviations of all unknowns.
    pub fn deviations(&self, temperature: f64) -> Vec<f64> {
        let variances = self.covariance(temperature).diagonal();
        variances.iter().map(|variance| variance.sqrt()).collect()
    }

    /// Sum of squares of the fitted rows beyond a possible error of the laws' shapes.
    pub fn left(&self) -> f64 {
        self.likelier(1.0).0.left
    }

    /// Number of samples of the residual that are worth one independent sample.
    pub fn correlation(&self) -> f64 {
        self.likelier(1.0).0.correlation
    }

    /// Sum of squares of the held-out rows.
    pub fn held_out(&self) -> f64 {
        self.held_out
    }

    /// `q' (I + H S H')^-1 q`: chi-squared of the held-out rows beyond the errors of the fit.
    pub fn held_out_beyond_fit(&self) -> f64 {
        self.likelier(1.0).0.beyond.0
    }
}

/// The columns of two matrices side by side.
fn beside(first: &DMatrix<f64>, second: &DMatrix<f64>) -> DMatrix<f64> {
    let (left, right) = (first.ncols(), second.ncols());
    let mut all = first.clone().resize_horizontally(left + right, 0.0);
    all.columns_mut(left, right).copy_from(second);
    all
}

/// Newton step of all unknowns. `unfitted` is half the gradient by the last ones; at the end of a fit that by
/// the first ones is 0.
fn asked_for(slopes: &DMatrix<f64>, unfitted: &DVector<f64>) -> DVector<f64> {
    let (all, last) = (slopes.ncols(), unfitted.len());
    let mut gradient = DVector::zeros(all);
    gradient.rows_mut(all - last, last).copy_from(unfitted);
    inverse(&slopes.tr_mul(slopes)).0 * gradient
}

/// Half the gradient of the prior's cost by all `count` unknowns. Keys are left out: they are fitted with their
/// beliefs at any temperature.
fn pull(problem: &Problem, fitted: &Fitted, count: usize) -> DVector<f64> {
    let mut pull = DVector::zeros(count);
    for belief in problem.beliefs_at(&fitted.point) {
        for (global, slope) in belief.slopes {
            let index = fitted.globals.iter().position(|own| *own == global);
            if let Some(index) = index.filter(|_| !matches!(global, Global::Key(_))) {
                pull[index] += belief.departure * slope;
            }
        }
    }
    pull
}

/// Root of the prior covariance of all unknowns, and the log of the ratio of the prior density of learned
/// curves to that of the Gaussian ones in the covariance.
fn scale(problem: &Problem, point: &Point) -> (DMatrix<f64>, f64) {
    let globals = problem.globals(point);
    let shared = globals.iter().map(|g| problem.prior_width(point, *g));
    let all = shared.chain(problem.own_widths(point, &globals));
    let mut scale = DMatrix::from_diagonal(&DVector::from_vec(all.collect()));
    let mut whole = 0.0;
    for (index, term) in point
        .terms
        .iter()
        .enumerate()
        .filter(|own| own.1.effect.is_learned())
    {
        let (root, density) = curves::effective(&problem.scales, term);
        let first = Global::Parameter(index, curves::ordinates(term.effect)[0]);
        if let Some(first) = globals.iter().position(|global| *global == first) {
            let count = root.nrows();
            scale
                .view_mut((first, first), (count, count))
                .copy_from(&root);
            whole += density;
        }
    }
    (scale, whole)
}
