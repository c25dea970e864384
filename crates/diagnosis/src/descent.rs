//! Descent to the least cost: damped Gauss-Newton steps whose Jacobian is updated on the way.
//!
//! A Jacobian costs a simulation for each unknown, a step costs one. So the Jacobian is computed once and then
//! corrected after every step (a rank-one update). It is computed again only where a step fails, or before the
//! fit ends. Sources: Marquardt, SIAM J. Applied Mathematics 11 (1963); Broyden,
//! Mathematics of Computation 19 (1965).

use super::fit::{Evaluated, Fitted, KnownSlopes, Linearised};
use super::normal::solve;
use super::point::Point;
use super::problem::Problem;
use super::projector::Projector;
use super::thresholds::LONG;
use nalgebra::{DMatrix, DVector};

/// Damping at the start, as a share of the normal matrix' diagonal.
const DAMPING: f64 = 1e-3;
/// Least damping: the relative error of the normal matrix' diagonal by rounding and finite differences.
const LEAST_DAMPING: f64 = 1e-6;
/// Dampings that are tried for one step; the last one makes it as short as a step of steepest descent.
const TRIES: usize = 8;
/// Share of the predicted fall of the cost below which the Jacobian is computed again (More, Numerical
/// Analysis, Lecture Notes in Mathematics 630 (1978): below a quarter the step was too long).
const POOR: f64 = 0.25;

/// Most unknowns of an experiment for which the Jacobian is updated: a step corrects only one of as many
/// directions as there are unknowns.
const LEARNED: usize = 80;

/// A fit in progress.
pub struct Descent<'a> {
    problem: &'a Problem<'a>,
    projector: &'a Projector,
    point: Point,
    linear: Linearised,
    damping: f64,
    /// Whether the Jacobian was computed at this point.
    exact: bool,
    /// Linearisation of a point without the last effect.
    near: Option<&'a Linearised>,
}

impl Problem<'_> {
    /// Fits all unknowns from a point on, in at most `iterations` steps.
    pub fn fit(&self, start: &Point, projector: &Projector, iterations: usize) -> Fitted {
        let mut descent = Descent::new(self, projector, start, None);
        descent.run(iterations);
        descent.end()
    }
}

impl<'a> Descent<'a> {
    /// A descent from a point; `near` is the linearisation of a point without the unknowns of the last effect.
    pub fn new(
        problem: &'a Problem<'a>,
        projector: &'a Projector,
        start: &Point,
        near: Option<&'a Linearised>,
    ) -> Self {
        let at = problem.evaluate(start, projector);
        let known = near.map_or(KnownSlopes::Nothing, KnownSlopes::All);
        Self {
            problem,
            projector,
            point: start.clone(),
            linear: problem.slopes(start, projector, at, known),
            damping: DAMPING,
            exact: near.is_none(),
            near,
        }
    }

    /// The least cost so far.
    pub fn cost(&self) -> f64 {
        self.linear.cost
    }

    /// One step, if the present Jacobian leads to one.
    pub fn glance(&mut self) {
        self.attempt(1);
    }

    /// Makes at most this many steps; fewer where nothing more is gained, or the search is to end.
    pub fn run(&mut self, iterations: usize) {
        for _ in 0..iterations {
            let before = self.linear.cost;
            if self.problem.is_cut() {
                return;
            }
            self.step();
            if self.is_little(before - self.linear.cost) {
                return;
            }
        }
    }

    /// As [`Self::run`], but stopped early where a rival is ahead and the gain of two steps in a row is so
    /// small that all remaining steps would not reach it.
    pub fn run_against(&mut self, iterations: usize, rival: f64) {
        let mut slow = 0;
        for left in (0..iterations).rev() {
            let before = self.linear.cost;
            if self.problem.is_cut() {
                return;
            }
            self.step();
            let fall = before - self.linear.cost;
            let behind = self.linear.cost - rival;
            slow = if fall * left as f64 <= behind {
                slow + 1
            } else {
                0
            };
            if self.is_little(fall) || slow == 2 {
                return;
            }
        }
    }

    /// Whether the search is to end.
    pub fn is_cut(&self) -> bool {
        self.problem.is_cut()
    }

    /// Whether the misfit has many minima over the size of the last effect.
    pub fn winds(&self) -> bool {
        let last = self.point.terms.last();
        last.is_some_and(|term| term.effect.has_many_minima())
    }

    /// The normal matrix at the present point.
    pub fn normal(&self) -> DMatrix<f64> {
        self.problem.normal(&self.point, &self.linear)
    }

    /// A descent from a point one step away. It uses this one's Jacobian until its own steps correct it.
    pub fn stepped(&self, step: &DVector<f64>) -> Self {
        let (own, problem) = (&self.linear, self.problem);
        let point = problem.stepped(&self.point, &own.globals, step);
        let there = problem.evaluate(&point, self.projector);
        Self {
            linear: Linearised {
                runs: there.runs,
                residuals: there.residuals,
                cost: there.cost,
                jacobians: own.jacobians.clone(),
                globals: own.globals.clone(),
                departures: own.departures.clone(),
            },
            point,
            damping: DAMPING,
            exact: false,
            ..*self
        }
    }

    /// The end of the fit. A law that is as good as the simpler one without a parameter is fitted as that.
    pub fn end(self) -> Fitted {
        if let Some(simpler) = self.problem.without_vanished(&self.point) {
            return self.problem.fit(&simpler, self.projector, LONG);
        }
        Fitted {
            cost: self.linear.cost,
            globals: self.linear.globals,
            point: self.point,
        }
    }

    /// Whether a fall of the cost is negligible: a hundredth of a unit of chi-squared.
    fn is_little(&self, fall: f64) -> bool {
        fall < 0.01 + 1e-6 * self.linear.cost
    }

    /// One step. If a step with an updated Jacobian fails or gains hardly anything, the Jacobian is computed
    /// and the step repeated.
    fn step(&mut self) {
        let before = self.linear.cost;
        self.attempt(if self.exact { TRIES } else { 1 });
        if !self.exact && self.is_little(before - self.linear.cost) {
            self.take_jacobian(self.problem.evaluate(&self.point, self.projector));
            self.attempt(TRIES);
        }
    }

    /// Tries one step with rising damping until the cost falls.
    fn attempt(&mut self, tries: usize) {
        let (point, linear) = (&self.point, &self.linear);
        let normal = self.problem.normal(point, linear);
        let gradient = self.problem.gradient(point, linear, &linear.residuals);
        for _ in 0..tries {
            if let Some((next, promised)) = self.proposed(&normal, gradient.clone()) {
                if self.is_little(promised) {
                    return;
                }
                let there = self.problem.evaluate(&next, self.projector);
                if there.cost < self.linear.cost {
                    self.accept(next, there);
                    self.damping = (self.damping * 0.1).max(LEAST_DAMPING);
                    return;
                }
            }
            self.damping *= 10.0;
        }
    }

    /// The damped step and its predicted fall of the cost. Unknowns that the step would push through a bound
    /// stay where they are.
    fn proposed(&self, normal: &DMatrix<f64>, mut gradient: DVector<f64>) -> Option<(Point, f64)> {
        let globals = &self.linear.globals;
        let mut free = normal.clone();
        loop {
            let step = solve(&free, &gradient, self.damping)?;
            let next = self.problem.moved(&self.point, globals, &step);
            let held = globals.iter().enumerate().filter(|&(i, &global)| {
                let stays =
                    self.problem.get(&next, global) == self.problem.get(&self.point, global);
                stays && gradient[i] != 0.0
            });
            let held: Vec<usize> = held.map(|(i, _)| i).collect();
            if held.is_empty() {
                let promised = 2.0 * gradient.dot(&step) - step.dot(&(&free * &step));
                return Some((next, promised));
            }
            for i in held {
                gradient[i] = 0.0;
                free.row_mut(i).fill(0.0);
                free.column_mut(i).fill(0.0);
            }
        }
    }

    /// Moves to a better point and corrects the Jacobian by the observed change.
    fn accept(&mut self, next: Point, there: Evaluated) {
        let globals = &self.linear.globals;
        let mut promised = self.problem.disbelief(&next);
        let (mut ways, mut corrections) = (Vec::new(), Vec::new());
        for (e, jacobian) in self.linear.jacobians.iter().enumerate() {
            let way = self.problem.way(&self.point, &next, globals, e);
            let expected = &self.linear.residuals[e] + jacobian * &way;
            promised += expected.norm_squared();
            corrections.push(&there.residuals[e] - expected);
            ways.push(way);
        }
        let fell = self.linear.cost - there.cost;
        let many = ways.iter().any(|way| way.len() > LEARNED);
        self.exact = many || fell < POOR * (self.linear.cost - promised);
        self.point = next;
        if self.exact {
            self.take_jacobian(there);
            return;
        }
        for (e, way) in ways.iter().enumerate() {
            self.correct(e, way, &corrections[e]);
        }
        let linear = &mut self.linear;
        (linear.runs, linear.residuals, linear.cost) = (there.runs, there.residuals, there.cost);
    }

    /// The smallest change of a Jacobian, its unknowns in units of their typical sizes, that reproduces a step.
    fn correct(&mut self, e: usize, way: &DVector<f64>, missed: &DVector<f64>) {
        let sizes = self.problem.sizes(&self.point, &self.linear.globals, e);
        let scaled = way.component_div(&sizes);
        let square = scaled.norm_squared();
        if square > 0.0 {
            let direction = scaled.component_div(&sizes) / square;
            self.linear.jacobians[e].ger(1.0, missed, &direction, 1.0);
        }
    }

    /// Computes the Jacobian at the present point.
    fn take_jacobian(&mut self, here: Evaluated) {
        let known = self
            .near
            .map_or(KnownSlopes::Nothing, KnownSlopes::Ordinates);
        self.linear = self
            .problem
            .slopes(&self.point, self.projector, here, known);
        self.exact = true;
    }
}
