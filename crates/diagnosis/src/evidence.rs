//! The one score of an explanation: its log marginal likelihood.
//!
//! With whitened residuals `r` of the fitted rows, their derivatives `J`, and prior widths `W` (a diagonal), Laplace's
//! approximation about the fit is
//!
//! ```text
//! ln p(y) = -|r|^2 / 2T - c / 2 - ln det(I + W J'J W / T) / 2 + ln p(structure)
//! ```
//!
//! where `c` is twice the negative logarithm of the prior density at the fit, which no temperature makes cheaper. The
//! fit is that of `T = 1`. With the halves `p` of the gradient of `c` and `g = W J'r` of what is yet to be fitted, both
//! about the fit, the optimum at another temperature is better by
//!
//! ```text
//! h' (I + W J'J W / T)^-1 h ,   h = g / T + (1 - 1 / T) p
//! ```
//!
//! What was held out counts by its predictive density, the errors of the fit carried over: with residuals `q`, their
//! derivatives `H` and the covariance `S = (J'J + W^-2)^-1` of the unknowns,
//!
//! ```text
//! ln p(y_held | y) = -q' (I + H S H')^-1 q / 2T - ln det(I + H S H') / 2
//! ```
//!
//! Both together are the marginal likelihood of the whole recording. The temperature `T` is the chi-squared a row of
//! what the best explanation leaves, times the samples of it that say as much as one independent one: where that is
//! more than noise, what is left is no better known than by its own size and correlation.
//!
//! Source: MacKay, Neural Computation 4 (1992); Kass and Raftery, J. American Statistical Association 90 (1995).

use super::curves;
use super::fit::Fitted;
use super::marginal::{Marginal, inverse};
use super::point::{Global, Point};
use super::problem::Problem;
use super::shape::Corrections;
use super::views::{Views, joined, local_sizes};
use nalgebra::{DMatrix, DVector};

/// Width of the prior of what a recording alone has (a clock's offset, how it starts), in typical sizes.
const LOCAL: f64 = 10.0;

/// Temperature of the evidence where only noise is left.
///
/// The likelihood takes the noise for Gaussian, of known level and colour, and the input for exact. Neither is so: the
/// level is known within a tenth, and an encoder's rounding is coherent with the motion. On recordings in which nothing
/// was hidden the best effect lowered the criterion by up to 29, on such with an effect the true one by 88 or more; at
/// this temperature the former pays less, the latter more, than what one more effect costs.
pub const CALIBRATED: f64 = 4.0;

/// Log of the prior probability that a law has exactly the shape of the catalogue, and that it has not.
const EXACT_OR_NOT: f64 = -std::f64::consts::LN_2;

/// What the marginal likelihood of a fitted structure is made of.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// With laws of exactly the shape of the catalogue.
    exact: Marginal,
    /// With an uncertain shape, where there is a law that has one.
    shaped: Option<Marginal>,
    /// Root `W W'` of the prior covariance of what was fitted.
    scale: DMatrix<f64>,
    /// `|q|^2` of what was held out.
    held_out: f64,
    /// Log of the prior probability of the structure.
    prior: f64,
    /// Whether what was held out counts: a window of its own has a start of its own, which takes most of an error.
    foresees: bool,
}

impl Evidence {
    /// Of a fitted structure, laws having a shape that is uncertain where `shaped`.
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
            // What the corrections explain in truth, and not only to first order.
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

    /// Log marginal likelihood of what was fitted and of what was held out, up to what all structures share.
    pub fn log(&self, temperature: f64) -> f64 {
        self.of_fitted(temperature) + self.of_held_out(temperature)
    }

    /// Log marginal likelihood of what was fitted, and of the structure.
    pub fn of_fitted(&self, temperature: f64) -> f64 {
        let (marginal, prior) = self.likelier(temperature);
        marginal.of_fitted(temperature) + prior + self.prior
    }

    /// Log predictive density of what was held out.
    pub fn of_held_out(&self, temperature: f64) -> f64 {
        match self.foresees {
            true => self.likelier(temperature).0.of_held_out(temperature),
            false => 0.0,
        }
    }

    /// Laws of exact or of uncertain shape, what is likelier, and its prior.
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

    /// Sum of squares of the fitted rows beyond what the laws' shapes could be wrong by.
    pub fn left(&self) -> f64 {
        self.likelier(1.0).0.left
    }

    /// Samples of what is left that say as much as one independent one.
    pub fn correlation(&self) -> f64 {
        self.likelier(1.0).0.correlation
    }

    /// Sum of squares of what was held out.
    pub fn held_out(&self) -> f64 {
        self.held_out
    }

    /// `q' (I + H S H')^-1 q`: chi-squared of what was held out beyond the errors of the fit.
    pub fn held_out_beyond_fit(&self) -> f64 {
        self.likelier(1.0).0.beyond.0
    }
}

/// Columns beside others.
fn beside(first: &DMatrix<f64>, second: &DMatrix<f64>) -> DMatrix<f64> {
    let (left, right) = (first.ncols(), second.ncols());
    let mut all = first.clone().resize_horizontally(left + right, 0.0);
    all.columns_mut(left, right).copy_from(second);
    all
}

/// Step of all unknowns, of which the last have this half of a gradient; a fit ended where the first have none.
fn asked_for(slopes: &DMatrix<f64>, unfitted: &DVector<f64>) -> DVector<f64> {
    let (all, last) = (slopes.ncols(), unfitted.len());
    let mut gradient = DVector::zeros(all);
    gradient.rows_mut(all - last, last).copy_from(unfitted);
    inverse(&slopes.tr_mul(slopes)).0 * gradient
}

/// Half the gradient of the prior's cost by all unknowns, of which there are so many; keys are fitted as they are
/// believed, whatever the temperature.
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

/// Root of the prior covariance of all unknowns, and the log of the prior density of learned curves over that of the
/// Gaussian ones in it.
fn scale(problem: &Problem, point: &Point) -> (DMatrix<f64>, f64) {
    let globals = problem.globals(point);
    let shared = globals.iter().map(|g| problem.prior_width(point, *g));
    let own = local_sizes(problem, point, &globals);
    let all = shared.chain(own.into_iter().map(|size| LOCAL * size));
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
