//! The one score of an explanation: its log marginal likelihood.
//!
//! With whitened residuals `r` of the fitted rows, their derivatives `J`, and prior widths `W` (a diagonal), Laplace's
//! approximation about the fit is
//!
//! ```text
//! ln p(y) = -|r|^2 / 2T - ln det(I + W J'J W / T) / 2 + ln p(structure)
//! ```
//!
//! What was held out counts by its predictive density, the errors of the fit carried over: with residuals `q`, their
//! derivatives `H` and the covariance `S = (J'J + W^-2)^-1` of the unknowns,
//!
//! ```text
//! ln p(y_held | y) = -q' (I + H S H')^-1 q / 2T - ln det(I + H S H') / 2
//! ```
//!
//! Both together are the marginal likelihood of the whole recording. The temperature `T`, at least 1, is the
//! chi-squared a row of the best explanation: where that leaves more than noise, what is left is no better known
//! than by its own size.
//!
//! Source: MacKay, Neural Computation 4 (1992); Kass and Raftery, J. American Statistical Association 90 (1995).

use super::explanation::Judge;
use super::fit::{Fitted, Projector, orthonormal};
use super::point::{Global, Point};
use super::problem::Problem;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Step of a derivative in what the residual bends over.
const STEP: f64 = 1e-3;
/// Width of the prior of what a recording alone has (a clock's offset, how it starts), in typical sizes.
const LOCAL: f64 = 10.0;

/// What the marginal likelihood of a fitted structure is made of.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// Sum of squares of the fitted rows, departures from beliefs included.
    cost: f64,
    /// Prior widths `W`.
    widths: DVector<f64>,
    /// `W J'J W`.
    information: DMatrix<f64>,
    /// `|q|^2` and, in units of the errors of the fit, `H' q` and `H'H`.
    held_out: (f64, DVector<f64>, DMatrix<f64>),
    /// Log of the prior probability of the structure.
    prior: f64,
}

impl Evidence {
    /// Of a fitted structure.
    pub fn new(judge: &Judge, problem: &Problem, projector: &Projector, fitted: &Fitted) -> Self {
        let point = &fitted.point;
        let rows = match judge.data.apart.is_empty() {
            true => Rows::within(judge, problem, projector, point),
            false => Rows::apart(judge, problem, projector, point),
        };
        let widths = widths(problem, point);
        let size = widths.len();
        let product = rows.slopes.tr_mul(&rows.slopes);
        let scaled = |i: usize, j: usize| product[(i, j)] * widths[i] * widths[j];
        let information = DMatrix::from_fn(size, size, scaled);
        let held = rows.held_slopes * DMatrix::from_diagonal(&widths) * root_of_covariance(&information);
        let held_out = (
            rows.held.norm_squared(),
            held.tr_mul(&rows.held),
            held.tr_mul(&held),
        );
        Self {
            cost: fitted.cost,
            widths,
            information,
            held_out,
            prior: problem.log_prior(point),
        }
    }

    /// Log marginal likelihood of what was fitted and of what was held out, up to what all structures share.
    pub fn log(&self, temperature: f64) -> f64 {
        self.of_fitted(temperature) + self.of_held_out(temperature)
    }

    /// Log marginal likelihood of what was fitted, and of the structure.
    pub fn of_fitted(&self, temperature: f64) -> f64 {
        let n = self.information.nrows();
        let whole = DMatrix::identity(n, n) + &self.information / temperature;
        -0.5 * self.cost / temperature - 0.5 * log_determinant(whole) + self.prior
    }

    /// Log predictive density of what was held out.
    pub fn of_held_out(&self, temperature: f64) -> f64 {
        let (square, product, spread) = &self.held_out;
        let n = product.len();
        let Some(root) = Cholesky::new(DMatrix::identity(n, n) + spread) else {
            return f64::NEG_INFINITY;
        };
        let foreseen = product.dot(&root.solve(product));
        -0.5 * (square - foreseen) / temperature - 0.5 * determinant(&root)
    }

    /// Standard deviations of all unknowns, the shared ones first, as the fit sees them.
    pub fn deviations(&self, temperature: f64) -> Vec<f64> {
        let n = self.information.nrows();
        let whole = DMatrix::identity(n, n) + &self.information / temperature;
        let eigen = whole.symmetric_eigen();
        let variance = |i: usize| -> f64 {
            let row = eigen.eigenvectors.row(i);
            let parts = row.iter().zip(eigen.eigenvalues.iter());
            parts.map(|(v, value)| v * v / value.max(1.0)).sum()
        };
        (0..n).map(|i| self.widths[i] * variance(i).sqrt()).collect()
    }

    /// Sum of squares of what was held out.
    pub fn held_out(&self) -> f64 {
        self.held_out.0
    }

    /// `q' (I + H S H')^-1 q`: chi-squared of what was held out beyond the errors of the fit.
    pub fn held_out_beyond_fit(&self) -> f64 {
        let (square, product, spread) = &self.held_out;
        let n = product.len();
        let root = Cholesky::new(DMatrix::identity(n, n) + spread);
        root.map_or(f64::INFINITY, |root| square - product.dot(&root.solve(product)))
    }
}

/// Fitted and held-out rows and their derivatives: shared unknowns first, then those of each recording.
struct Rows {
    slopes: DMatrix<f64>,
    held: DVector<f64>,
    held_slopes: DMatrix<f64>,
}

impl Rows {
    /// The held-out rows are parts of the recordings that were fitted.
    fn within(judge: &Judge, problem: &Problem, projector: &Projector, point: &Point) -> Self {
        let see = |point: &Point| seen(judge, problem, projector, point);
        let here = see(point);
        let (mut columns, mut held_columns) = (Vec::new(), Vec::new());
        let mut add = |moved: &Point, change: f64| {
            let there = (change != 0.0).then(|| see(moved));
            let there = there.unwrap_or_else(|| here.clone());
            columns.push(slope(&here.0, || there.0.clone(), change));
            held_columns.push(slope(&here.1, || there.1.clone(), change));
        };
        let globals = problem.globals(point);
        for &global in &globals {
            let (moved, change) = nudged(problem, point, global, STEP * problem.reach(point, global));
            add(&moved, change);
        }
        let mut way = DVector::zeros(problem.unknowns(point, &globals));
        for (k, size) in local_sizes(problem, point, &globals).into_iter().enumerate() {
            way.fill(0.0);
            way[globals.len() + k] = -STEP * size;
            add(&problem.stepped(point, &globals, &way), STEP * size);
        }
        Self {
            slopes: joined(&columns, here.0.len()),
            held_slopes: joined(&held_columns, here.1.len()),
            held: here.1,
        }
    }

    /// The held-out rows are recordings of their own.
    fn apart(judge: &Judge, problem: &Problem, projector: &Projector, point: &Point) -> Self {
        let linear = problem.linearise(point, projector);
        let slopes = linear.stacked();
        let (held, held_slopes) = judge.apart_slopes(problem, point, &linear.globals);
        Self {
            held_slopes: held_slopes.resize_horizontally(slopes.ncols(), 0.0),
            slopes,
            held,
        }
    }
}

/// Widths of the priors of all unknowns.
fn widths(problem: &Problem, point: &Point) -> DVector<f64> {
    let globals = problem.globals(point);
    let mut widths: Vec<f64> = globals.iter().map(|g| problem.prior_width(point, *g)).collect();
    // What a recording alone has is known to some typical sizes beforehand.
    let own = local_sizes(problem, point, &globals);
    widths.extend(own.into_iter().map(|size| LOCAL * size));
    DVector::from_vec(widths)
}

/// Typical sizes of the unknowns that each recording alone has.
fn local_sizes(problem: &Problem, point: &Point, globals: &[Global]) -> Vec<f64> {
    let of = |e: usize| problem.sizes(point, globals, e).iter().skip(globals.len()).copied().collect::<Vec<_>>();
    (0..problem.experiments.len()).flat_map(of).collect()
}

fn slope(from: &DVector<f64>, to: impl FnOnce() -> DVector<f64>, change: f64) -> DVector<f64> {
    match change != 0.0 {
        true => (to() - from) / change,
        false => DVector::zeros(from.len()),
    }
}

fn joined(columns: &[DVector<f64>], rows: usize) -> DMatrix<f64> {
    match columns.is_empty() {
        true => DMatrix::zeros(rows, 0),
        false => DMatrix::from_columns(columns),
    }
}

/// The point with a shared unknown moved, away from a bound, and by how much.
fn nudged(problem: &Problem, point: &Point, global: Global, step: f64) -> (Point, f64) {
    let here = problem.get(point, global);
    let moved = |step: f64| {
        let mut moved = point.clone();
        problem.set(&mut moved, global, here + step);
        let change = problem.get(&moved, global) - here;
        (moved, change)
    };
    let forward = moved(step);
    match forward.1.abs() >= 0.5 * step {
        true => forward,
        false => moved(-step),
    }
}

/// Fitted rows of all experiments, linear nuisances projected out, and held-out rows of the same recordings.
fn seen(judge: &Judge, problem: &Problem, projector: &Projector, point: &Point) -> (DVector<f64>, DVector<f64>) {
    let (mut fitted, mut held) = (Vec::new(), Vec::new());
    for e in 0..problem.experiments.len() {
        let raw = problem.run(point, e).residuals;
        let rows = projector.remove(e, &problem.complete(e, &raw));
        fitted.extend(rows.iter().copied());
        judge.push_held_out(problem, e, raw, &mut held);
    }
    let finite = |r: &mut f64| *r = if r.is_finite() { r.clamp(-1e12, 1e12) } else { 1e12 };
    held.iter_mut().for_each(finite);
    (DVector::from_vec(fitted), DVector::from_vec(held))
}

impl Judge<'_> {
    /// Rows of recordings kept apart, and their derivatives by shared unknowns; what these recordings alone have
    /// is free.
    fn apart_slopes(
        &self,
        problem: &Problem,
        point: &Point,
        globals: &[Global],
    ) -> (DVector<f64>, DMatrix<f64>) {
        let (apart, own) = self.apart(problem, point);
        let projector = Projector::new(&apart);
        let nuisances = apart.linearise(&own.point, &projector).jacobians;
        let nuisances: Vec<DMatrix<f64>> = nuisances.into_iter().map(orthonormal).collect();
        let rows = |point: &Point| {
            let at = apart.evaluate(point, &projector).residuals;
            let free = |(rows, own): (&DVector<f64>, &DMatrix<f64>)| rows - own * own.tr_mul(rows);
            let parts: Vec<DVector<f64>> = at.iter().zip(&nuisances).map(free).collect();
            DVector::from_vec(parts.iter().flat_map(|rows| rows.iter().copied()).collect())
        };
        let held = rows(&own.point);
        let column = |&global: &Global| {
            let (moved, change) = nudged(problem, point, global, STEP * problem.reach(point, global));
            let mut there = own.point.clone();
            there.keys.clone_from(&moved.keys);
            there.terms.clone_from(&moved.terms);
            there.inertias[..moved.inertias.len()].copy_from_slice(&moved.inertias);
            slope(&held, || rows(&there), change)
        };
        let columns: Vec<DVector<f64>> = globals.iter().map(column).collect();
        let slopes = joined(&columns, held.len());
        (held, slopes)
    }
}

/// A root `R R' = (I + information)^-1` of the covariance of the unknowns in units of their priors.
fn root_of_covariance(information: &DMatrix<f64>) -> DMatrix<f64> {
    let n = information.nrows();
    let eigen = (information + DMatrix::identity(n, n)).symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| 1.0 / value.max(1.0).sqrt());
    &eigen.eigenvectors * DMatrix::from_diagonal(&roots)
}

/// Log determinant of a positive definite matrix; that of rounding where it is not.
fn log_determinant(matrix: DMatrix<f64>) -> f64 {
    let values = matrix.symmetric_eigenvalues();
    values.iter().map(|value| value.max(1.0).ln()).sum()
}

fn determinant(root: &Cholesky<f64, nalgebra::Dyn>) -> f64 {
    2.0 * root.l_dirty().diagonal().iter().map(|value| value.ln()).sum::<f64>()
}
