//! Fit of a structure: damped Gauss-Newton steps on the weighted residuals, within bounds.
//!
//! Unknowns are the shared ones (keys and effects) and, for each experiment, its own (clock offsets,
//! departure of the start, linear nuisances). The linear ones are solved for exactly at every point.
//! Source: Marquardt, SIAM J. Applied Mathematics 11 (1963); Golub and Pereyra, Inverse Problems 19
//! (2003) on separable least squares.

use super::point::{Global, Point};
use super::problem::Problem;
use super::projector::Projector;
use super::run_of::Run;
use nalgebra::{DMatrix, DVector};
use quell_model::StartComponent;
use quell_model::effects::ParameterRole;

/// Step of a derivative in typical sizes of a change.
const FINE: f64 = 1e-3;
/// The same for an effect whose misfit has many minima: wider than the ripples that contacts make as they come
/// and go.
const COARSE: f64 = 3e-2;

/// A fitted structure.
#[derive(Clone)]
pub struct Fitted {
    /// Where the fit ended.
    pub point: Point,
    /// Sum of squares of the weighted residuals, witness' rows and beliefs included.
    pub cost: f64,
    /// The shared unknowns.
    pub globals: Vec<Global>,
}

/// The residuals at a point.
pub struct Evaluated {
    /// The experiments.
    pub runs: Vec<Run>,
    /// Weighted residuals of each experiment.
    whole: Vec<DVector<f64>>,
    /// The same with the linear nuisances projected out.
    pub residuals: Vec<DVector<f64>>,
    /// Cost at the point.
    pub cost: f64,
}

/// The normal equations at a point, for all unknowns but the linear ones.
pub struct Linearised {
    /// The experiments.
    pub runs: Vec<Run>,
    /// Weighted residuals of each experiment, linear nuisances projected out.
    pub residuals: Vec<DVector<f64>>,
    /// Their derivatives: shared unknowns first, then the experiment's own.
    pub jacobians: Vec<DMatrix<f64>>,
    /// The shared unknowns.
    pub globals: Vec<Global>,
    /// Free components of the starts; their unknowns follow the shared ones.
    pub departures: Vec<StartComponent>,
    /// Cost at the point.
    pub cost: f64,
}

/// Known derivatives of a point without the last effect.
#[derive(Clone, Copy)]
pub enum KnownSlopes<'a> {
    /// None.
    Nothing,
    /// Those of all its unknowns.
    All(&'a Linearised),
    /// Those of the ordinates of its learned laws: the motion is nearly linear in them.
    Ordinates(&'a Linearised),
}

/// Whether an unknown is an ordinate of a learned law.
fn is_ordinate(point: &Point, global: Global) -> bool {
    let Global::Parameter(term, parameter) = global else {
        return false;
    };
    point.terms[term].effect.parameters[parameter].role == ParameterRole::Ordinate
}

impl Linearised {
    /// Derivatives over the rows of all experiments: shared unknowns first, then those of each experiment.
    pub fn stacked(&self) -> DMatrix<f64> {
        let shared = self.globals.len();
        let rows: usize = self.jacobians.iter().map(|j| j.nrows()).sum();
        let own: usize = self.jacobians.iter().map(|j| j.ncols() - shared).sum();
        let mut all = DMatrix::zeros(rows, shared + own);
        let (mut row, mut column) = (0, shared);
        for jacobian in &self.jacobians {
            let (n, m) = jacobian.shape();
            all.view_mut((row, 0), (n, shared))
                .copy_from(&jacobian.columns(0, shared));
            all.view_mut((row, column), (n, m - shared))
                .copy_from(&jacobian.columns(shared, m - shared));
            (row, column) = (row + n, column + m - shared);
        }
        all
    }
}

impl Problem<'_> {
    /// Residuals and cost at a point.
    pub fn evaluate(&self, point: &Point, projector: &Projector) -> Evaluated {
        let (mut runs, mut whole, mut residuals) = (Vec::new(), Vec::new(), Vec::new());
        let mut cost = self.disbelief(point);
        for experiment in 0..self.experiments.len() {
            let mut run = self.run(point, experiment);
            let rows = self.complete(experiment, &run.residuals);
            if self.frozen {
                run.residuals.clear();
            }
            let residual = projector.remove(experiment, &rows);
            cost += residual.norm_squared();
            runs.push(run);
            whole.push(rows);
            residuals.push(residual);
        }
        Evaluated {
            runs,
            whole,
            residuals,
            cost,
        }
    }

    /// Residuals and derivatives at a point.
    pub fn linearise(&self, point: &Point, projector: &Projector) -> Linearised {
        self.slopes(
            point,
            projector,
            self.evaluate(point, projector),
            KnownSlopes::Nothing,
        )
    }

    /// Residuals and derivatives at a point whose residuals are known; known derivatives are reused.
    pub fn slopes(
        &self,
        point: &Point,
        projector: &Projector,
        at: Evaluated,
        known: KnownSlopes,
    ) -> Linearised {
        let globals = self.globals(point);
        let near = match known {
            KnownSlopes::Nothing => None,
            KnownSlopes::All(near) | KnownSlopes::Ordinates(near) => Some(near),
        };
        let ordinates = matches!(known, KnownSlopes::Ordinates(_));
        let mut jacobians = Vec::new();
        for (e, run) in at.runs.iter().enumerate() {
            let whole = &at.whole[e];
            let taken = |index: Option<usize>| {
                let jacobian = near.map(|near| &near.jacobians[e]);
                Some(jacobian?.column(index?).into_owned())
            };
            let known = |global| {
                let near = near.filter(|_| !ordinates || is_ordinate(point, global));
                near.and_then(|near| near.globals.iter().position(|g| *g == global))
            };
            let mut columns = Vec::new();
            for &global in &globals {
                columns.push(taken(known(global)).unwrap_or_else(|| {
                    projector.remove(e, &self.slope(point, global, e, run, whole))
                }));
            }
            for component in self.departures(point) {
                let there = near.filter(|near| !ordinates && near.departures.contains(&component));
                match there {
                    // The starts are those of `near`, in the same order.
                    Some(near) => {
                        let first = columns.len() + near.globals.len() - globals.len();
                        let count = self.starts_of(point, e, component).len();
                        columns.extend((first..first + count).filter_map(|i| taken(Some(i))));
                    }
                    None => {
                        let slopes = self.start_slopes(point, component, e, whole);
                        columns.extend(slopes.iter().map(|slope| projector.remove(e, slope)));
                    }
                }
            }
            for (output, data) in self.experiments[e].outputs.iter().enumerate() {
                if data.own_clock {
                    columns.push(projector.remove(e, &self.clock_slope(e, output, &run.rates)));
                }
            }
            jacobians.push(match columns.is_empty() {
                true => DMatrix::zeros(whole.len(), 0),
                false => DMatrix::from_columns(&columns),
            });
        }
        Linearised {
            runs: at.runs,
            residuals: at.residuals,
            jacobians,
            globals,
            departures: self.departures(point),
            cost: at.cost,
        }
    }

    /// Derivative by a difference over a small share of [`reach`](Problem::reach), away from a bound.
    fn slope(
        &self,
        p: &Point,
        global: Global,
        e: usize,
        run: &Run,
        at: &DVector<f64>,
    ) -> DVector<f64> {
        let mut moved = p.clone();
        let here = self.get(p, global);
        let typical = self.typical(p, global);
        let step = match global {
            Global::Parameter(term, parameter) if p.terms[term].effect.has_many_minima() => {
                // Its size may be far from typical.
                match parameter == p.terms[term].effect.size() {
                    true => COARSE * here.abs().max(FINE * typical),
                    false => COARSE * typical,
                }
            }
            _ => FINE * self.reach(p, global),
        };
        self.set(&mut moved, global, here + step);
        let mut change = self.get(&moved, global) - here;
        if change.abs() < 0.5 * step {
            self.set(&mut moved, global, here - step);
            change = self.get(&moved, global) - here;
        }
        if change == 0.0 {
            return DVector::zeros(at.len());
        }
        let moved = match global {
            Global::Parameter(term, _) => self.run_again(&moved, e, term, run),
            _ => self.run(&moved, e),
        };
        (self.complete(e, &moved.residuals) - at) / change
    }

    /// Derivatives by a component of the start of each window. A start affects its own window and, through the
    /// memory of a sensor, the next one. So every second window is moved at once.
    fn start_slopes(
        &self,
        p: &Point,
        component: StartComponent,
        e: usize,
        at: &DVector<f64>,
    ) -> Vec<DVector<f64>> {
        let windows = self.starts_of(p, e, component);
        let step = 1e-3 * self.departure_scale[component];
        let moved = |turn: usize| {
            let mut moved = p.clone();
            for &window in windows.iter().filter(|window| *window % 2 == turn) {
                moved.locals[e].departures[window][component] += step;
            }
            (self.complete(e, &self.run(&moved, e).residuals) - at) / step
        };
        let changes = [0, 1].map(|turn| (turn < windows.len()).then(|| moved(turn)));
        let places = self.windows(e, at.len());
        let slope = |&window: &usize| {
            let mut column = changes[window % 2].clone().unwrap_or_default();
            for (value, place) in column.iter_mut().zip(&places) {
                if windows.len() > 2 && !(window..window + 2).contains(place) {
                    *value = 0.0;
                }
            }
            column
        };
        windows.iter().map(slope).collect()
    }

    /// The prediction at `stamp - offset` changes by minus its rate, the residual by its rate.
    fn clock_slope(&self, e: usize, output: usize, rates: &[Vec<f64>]) -> DVector<f64> {
        let outputs = &self.experiments[e].outputs;
        let series: Vec<Vec<f64>> = (0..outputs.len())
            .map(|k| match k == output {
                true => rates[k].clone(),
                false => vec![0.0; outputs[k].values.len()],
            })
            .collect();
        let mut rows = self.weigh(e, &series);
        let witnesses: usize = outputs.iter().map(|output| output.witness.len()).sum();
        rows.extend(vec![0.0; witnesses]);
        DVector::from_vec(rows)
    }
}
