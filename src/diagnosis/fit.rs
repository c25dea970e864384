//! Fit of a structure: damped Gauss-Newton steps on the weighted residuals, within bounds.
//!
//! Unknowns are the shared ones (keys and effects) and, for each experiment, its own (clock offsets,
//! departure of the start, linear nuisances). The linear ones are solved for exactly at every point.
//! Source: Marquardt, SIAM J. Applied Mathematics 11 (1963); Golub and Pereyra, Inverse Problems 19
//! (2003) on separable least squares.

use super::problem::{Given, Global, Point, Problem};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::TAU;

/// A fitted structure.
#[derive(Clone)]
pub struct Fitted {
    /// Where the fit ended.
    pub point: Point,
    /// Sum of squares of the weighted residuals, witness' rows and beliefs included.
    pub cost: f64,
    /// The shared unknowns.
    pub globals: Vec<Global>,
    /// Inverse of the normal matrix for the shared unknowns, the others projected out.
    pub covariance: DMatrix<f64>,
}

/// Projects the linear nuisances of every experiment out of residuals.
pub struct Projector {
    /// Orthonormal basis of the columns, an experiment each.
    bases: Vec<DMatrix<f64>>,
}

impl Projector {
    /// For the rows of a problem.
    pub fn new(problem: &Problem) -> Self {
        let basis = |experiment| orthonormal(problem.linear(experiment));
        Self {
            bases: (0..problem.experiments.len()).map(basis).collect(),
        }
    }

    /// The part of the rows that no linear nuisance explains.
    pub fn remove(&self, experiment: usize, rows: &DVector<f64>) -> DVector<f64> {
        let basis = &self.bases[experiment];
        if basis.ncols() == 0 {
            return rows.clone();
        }
        rows - basis * basis.tr_mul(rows)
    }
}

/// An orthonormal basis of the columns; those that depend on others are left out.
pub fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let mut basis: Vec<DVector<f64>> = Vec::with_capacity(columns.ncols());
    for column in columns.column_iter() {
        let (mut rest, size) = (column.into_owned(), column.norm());
        // Twice is enough (Kahan, Parlett).
        for _ in 0..2 {
            for q in &basis {
                let share = q.dot(&rest);
                rest.axpy(-share, q, 1.0);
            }
        }
        let left = rest.norm();
        if left > 1e-9 * size && left > 0.0 {
            basis.push(rest / left);
        }
    }
    match basis.is_empty() {
        true => DMatrix::zeros(columns.nrows(), 0),
        false => DMatrix::from_columns(&basis),
    }
}

/// A departure from what is believed, in standard deviations, and its derivatives to the unknowns.
struct Belief {
    departure: f64,
    slopes: Vec<(Global, f64)>,
}

/// The normal equations at a point, all unknowns but the linear ones.
pub struct Linearised {
    /// Weighted residuals of each experiment, linear nuisances projected out.
    pub residuals: Vec<DVector<f64>>,
    /// Their derivatives: shared unknowns first, then the experiment's own.
    pub jacobians: Vec<DMatrix<f64>>,
    /// The shared unknowns.
    pub globals: Vec<Global>,
    /// Cost at the point.
    pub cost: f64,
}

impl Problem<'_> {
    /// Cost of the beliefs on the keys.
    pub fn disbelief(&self, point: &Point) -> f64 {
        self.beliefs_at(point)
            .iter()
            .map(|b| b.departure * b.departure)
            .sum()
    }

    fn beliefs_at(&self, point: &Point) -> Vec<Belief> {
        let keys = self.free.iter().filter_map(|&key| self.belief(point, key));
        let own = |given: &Given| {
            let global = Global::Parameter(given.term, given.parameter);
            let std = given.value.std?;
            Some(Belief {
                departure: (self.get(point, global) - given.value.value) / std,
                slopes: vec![(global, 1.0 / std)],
            })
        };
        keys.chain(self.given.iter().filter_map(own)).collect()
    }

    /// What is believed of a key; of a damping ratio, that of the damper across the joint and one to
    /// ground together.
    fn belief(&self, point: &Point, key: usize) -> Option<Belief> {
        let (value, std) = self.beliefs[key];
        if !std.is_finite() {
            return None;
        }
        let global = Global::Key(key);
        if self.kind.keys[key].range.0 <= 0.0 {
            let departure = (point.keys[key] - value) / std;
            return Some(Belief {
                departure,
                slopes: vec![(global, 1.0 / std)],
            });
        }
        let ground = match self.kind.mode {
            Some((_, damping)) if damping == key => self.damper_to_ground(point),
            _ => None,
        };
        let own = point.keys[key];
        let (term, share) = ground.unwrap_or((usize::MAX, 0.0));
        let total = own + share;
        let mut slopes = vec![(global, own / total / std)];
        if let Some((frequency, _)) = self.kind.mode.filter(|_| ground.is_some()) {
            let half = 0.5 * TAU * point.keys[frequency];
            slopes.push((Global::Parameter(term, 0), half / total / std));
        }
        Some(Belief {
            departure: (total / value).ln() / std,
            slopes,
        })
    }

    /// Cost at a point.
    pub fn cost(&self, point: &Point, projector: &Projector) -> f64 {
        let of = |e| {
            projector
                .remove(e, &self.residuals(point, e))
                .norm_squared()
        };
        (0..self.experiments.len()).map(of).sum::<f64>() + self.disbelief(point)
    }

    /// Residuals and derivatives at a point.
    pub fn linearise(&self, point: &Point, projector: &Projector) -> Linearised {
        let globals = self.globals(point);
        let (mut residuals, mut jacobians) = (Vec::new(), Vec::new());
        let mut cost = self.disbelief(point);
        for experiment in 0..self.experiments.len() {
            let (raw, rates) = self.raw(point, experiment);
            let whole = self.complete(experiment, &raw);
            let mut columns = Vec::new();
            for &global in &globals {
                columns.push(self.slope(point, global, experiment, &whole));
            }
            for component in self.departures(point) {
                columns.push(self.start_slope(point, component, experiment, &whole));
            }
            for (output, data) in self.experiments[experiment].outputs.iter().enumerate() {
                if data.own_clock {
                    columns.push(self.clock_slope(experiment, output, &rates));
                }
            }
            let project = |column: DVector<f64>| projector.remove(experiment, &column);
            let columns: Vec<_> = columns.into_iter().map(project).collect();
            let residual = projector.remove(experiment, &whole);
            cost += residual.norm_squared();
            jacobians.push(match columns.is_empty() {
                true => DMatrix::zeros(residual.len(), 0),
                false => DMatrix::from_columns(&columns),
            });
            residuals.push(residual);
        }
        Linearised {
            residuals,
            jacobians,
            globals,
            cost,
        }
    }

    /// Derivative by a difference of a thousandth of the typical size, away from a bound.
    fn slope(&self, p: &Point, global: Global, e: usize, at: &DVector<f64>) -> DVector<f64> {
        let mut moved = p.clone();
        let here = self.get(p, global);
        let step = 1e-3 * self.typical(p, global).max(0.1 * here.abs().min(1e3));
        self.set(&mut moved, global, here + step);
        let mut change = self.get(&moved, global) - here;
        if change.abs() < 0.5 * step {
            self.set(&mut moved, global, here - step);
            change = self.get(&moved, global) - here;
        }
        if change == 0.0 {
            return DVector::zeros(at.len());
        }
        (self.residuals(&moved, e) - at) / change
    }

    fn start_slope(
        &self,
        p: &Point,
        component: usize,
        e: usize,
        at: &DVector<f64>,
    ) -> DVector<f64> {
        let mut moved = p.clone();
        let step = 1e-3 * self.departure_scale[component];
        moved.locals[e].departure[component] += step;
        (self.residuals(&moved, e) - at) / step
    }

    /// The prediction at `stamp - offset` changes by minus its rate, the residual by its rate.
    fn clock_slope(&self, e: usize, output: usize, rates: &[Vec<f64>]) -> DVector<f64> {
        let outputs = &self.experiments[e].outputs;
        let series: Vec<Vec<f64>> = (0..outputs.len())
            .map(|k| match k == output {
                true => rates[k].clone(),
                false => vec![0.0; rates[k].len()],
            })
            .collect();
        let mut rows = self.weigh(e, &series);
        let witnesses: usize = outputs.iter().map(|output| output.witness.len()).sum();
        rows.extend(vec![0.0; witnesses]);
        DVector::from_vec(rows)
    }

    /// Fits all unknowns from a point on, in at most `iterations` steps.
    pub fn fit(&self, start: &Point, projector: &Projector, iterations: usize) -> Fitted {
        let mut point = start.clone();
        let mut damping = 1e-3;
        let mut linear = self.linearise(&point, projector);
        for _ in 0..iterations {
            let (normal, gradient) = self.normal(&point, &linear);
            let mut improved = None;
            for _ in 0..6 {
                let Some(step) = solve(&normal, &gradient, damping) else {
                    damping *= 10.0;
                    continue;
                };
                let next = self.moved(&point, &linear.globals, &step);
                let cost = self.cost(&next, projector);
                if cost < linear.cost {
                    improved = Some((next, cost));
                    damping = (damping * 0.1).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            let Some((next, cost)) = improved else { break };
            // A hundredth of a unit of chi-squared decides nothing.
            let settled = linear.cost - cost < 0.01 + 1e-6 * cost;
            point = next;
            linear = self.linearise(&point, projector);
            if settled {
                break;
            }
        }
        let (normal, _) = self.normal(&point, &linear);
        let shared = linear.globals.len();
        Fitted {
            cost: linear.cost,
            covariance: inverse(&normal, shared),
            globals: linear.globals,
            point,
        }
    }

    /// `J^T J` and `J^T r` over shared unknowns and every experiment's own.
    fn normal(&self, point: &Point, linear: &Linearised) -> (DMatrix<f64>, DVector<f64>) {
        let shared = linear.globals.len();
        let own: usize = linear.jacobians.iter().map(|j| j.ncols() - shared).sum();
        let mut normal = DMatrix::zeros(shared + own, shared + own);
        let mut gradient = DVector::zeros(shared + own);
        let mut offset = shared;
        for (jacobian, residual) in linear.jacobians.iter().zip(&linear.residuals) {
            let product = jacobian.tr_mul(jacobian);
            let right = jacobian.tr_mul(residual);
            let place = |i: usize| if i < shared { i } else { offset + i - shared };
            for i in 0..jacobian.ncols() {
                gradient[place(i)] += right[i];
                for j in 0..jacobian.ncols() {
                    normal[(place(i), place(j))] += product[(i, j)];
                }
            }
            offset += jacobian.ncols() - shared;
        }
        for belief in self.beliefs_at(point) {
            let place = |&(global, slope): &(Global, f64)| {
                let index = linear.globals.iter().position(|g| *g == global);
                index.map(|index| (index, slope))
            };
            let slopes: Vec<(usize, f64)> = belief.slopes.iter().filter_map(place).collect();
            for &(i, slope) in &slopes {
                gradient[i] += slope * belief.departure;
                for &(j, other) in &slopes {
                    normal[(i, j)] += slope * other;
                }
            }
        }
        (normal, gradient)
    }

    /// The point moved against a step over shared unknowns and every experiment's own; none where the
    /// point has other unknowns than the step.
    pub fn stepped(&self, point: &Point, globals: &[Global], step: &DVector<f64>) -> Option<Point> {
        let clocks = self.experiments.iter().flat_map(|e| &e.outputs);
        let clocks = clocks.filter(|output| output.own_clock).count();
        let own = self.departures(point).len() * self.experiments.len() + clocks;
        let known = step.len() == globals.len() + own && step.iter().all(|x| x.is_finite());
        known.then(|| self.moved(point, globals, step))
    }

    fn moved(&self, point: &Point, globals: &[Global], step: &DVector<f64>) -> Point {
        let mut next = point.clone();
        for (i, &global) in globals.iter().enumerate() {
            // Never further than three typical sizes at once.
            let most = 3.0
                * self
                    .typical(point, global)
                    .max(0.1 * self.get(point, global).abs());
            let change = (-step[i]).clamp(-most, most);
            self.set(&mut next, global, self.get(point, global) + change);
        }
        let mut k = globals.len();
        for (e, data) in self.experiments.iter().enumerate() {
            for component in self.departures(point) {
                next.locals[e].departure[component] -= step[k];
                k += 1;
            }
            for (output, own) in data.outputs.iter().enumerate() {
                if own.own_clock {
                    next.locals[e].clocks[output] -= step[k];
                    k += 1;
                }
            }
        }
        next
    }
}

/// `(N + damping diag N) x = g`.
fn solve(normal: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let scale = scales(normal);
    let mut scaled = normal.clone();
    for i in 0..scaled.nrows() {
        for j in 0..scaled.ncols() {
            scaled[(i, j)] /= scale[i] * scale[j];
        }
        // A direction without any effect does not move; the rounding of the sums keeps it positive.
        scaled[(i, i)] += damping + 1e-13;
    }
    let right = gradient.component_div(&scale);
    let solution = Cholesky::new(scaled)?.solve(&right).component_div(&scale);
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}

/// Square roots of the diagonal; 1 where it is 0.
fn scales(normal: &DMatrix<f64>) -> DVector<f64> {
    let root = |x: f64| if x > 0.0 { x.sqrt() } else { 1.0 };
    normal.diagonal().map(root)
}

/// The block of the shared unknowns of the inverse; large where the data say nothing.
fn inverse(normal: &DMatrix<f64>, shared: usize) -> DMatrix<f64> {
    let scale = scales(normal);
    let n = normal.nrows();
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        normal[(i, j)] / (scale[i] * scale[j]) + if i == j { 1e-12 } else { 0.0 }
    });
    let whole = Cholesky::new(scaled).map(|root| root.inverse());
    DMatrix::from_fn(shared, shared, |i, j| {
        let entry = whole.as_ref().map_or(f64::INFINITY, |m| m[(i, j)]);
        entry / (scale[i] * scale[j])
    })
}
