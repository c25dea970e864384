//! Displacements in the space of unknowns: the shared ones first, then those of each experiment.

use super::point::{Global, Point};
use super::problem::Problem;
use nalgebra::DVector;
use quell_model::Experiment;

/// Most typical sizes that a shared unknown may move in one step.
const FARTHEST: f64 = 3.0;

impl Problem<'_> {
    /// A point one step away; no shared unknown moves more than three typical sizes in one step.
    pub fn moved(&self, point: &Point, globals: &[Global], step: &DVector<f64>) -> Point {
        let mut limited = step.clone();
        for (change, &global) in limited.iter_mut().zip(globals) {
            let most = FARTHEST * self.size(point, global);
            *change = change.clamp(-most, most);
        }
        self.stepped(point, globals, &limited)
    }

    /// The point minus a step over the shared unknowns and every experiment's own, kept within the bounds.
    pub fn stepped(&self, point: &Point, globals: &[Global], step: &DVector<f64>) -> Point {
        let mut next = point.clone();
        for (&change, &global) in step.iter().zip(globals) {
            self.set(&mut next, global, self.get(point, global) - change);
        }
        let mut k = globals.len();
        for (e, data) in self.experiments.iter().enumerate() {
            for (window, component) in self.starts(point, e) {
                next.locals[e].departures[window][component] -= step[k];
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

    /// Number of unknowns of a step at a point.
    pub fn unknowns(&self, point: &Point, globals: &[Global]) -> usize {
        let own = |(e, data): (usize, &Experiment)| {
            let clocks = data.outputs.iter().filter(|output| output.own_clock);
            self.starts(point, e).len() + clocks.count()
        };
        globals.len() + self.experiments.iter().enumerate().map(own).sum::<usize>()
    }

    /// The displacement from one point to another as an experiment sees it, in the order of its Jacobian.
    pub fn way(&self, from: &Point, to: &Point, globals: &[Global], e: usize) -> DVector<f64> {
        let (old, new) = (&from.locals[e], &to.locals[e]);
        let shared = globals.iter().map(|&g| self.get(to, g) - self.get(from, g));
        let starts = self.starts(from, e).into_iter();
        let starts = starts.map(|(w, k)| new.departures[w][k] - old.departures[w][k]);
        let outputs = self.experiments[e].outputs.iter().enumerate();
        let clocks = outputs.filter(|(_, output)| output.own_clock);
        let clocks = clocks.map(|(k, _)| new.clocks[k] - old.clocks[k]);
        let all: Vec<f64> = shared.chain(starts).chain(clocks).collect();
        DVector::from_vec(all)
    }

    /// Typical sizes of the unknowns of an experiment, in the order of its Jacobian.
    pub fn sizes(&self, point: &Point, globals: &[Global], e: usize) -> DVector<f64> {
        let shared = globals.iter().map(|&global| self.size(point, global));
        let starts = self.starts(point, e).into_iter();
        let starts = starts.map(|(_, component)| self.departure_scale[component]);
        let outputs = self.experiments[e].outputs.iter();
        let clocks = outputs.filter(|output| output.own_clock);
        let clocks = clocks.map(|_| self.scales.sample_time);
        let all: Vec<f64> = shared.chain(starts).chain(clocks).collect();
        DVector::from_vec(all)
    }

    /// Typical size of a shared unknown, or a tenth of its value.
    fn size(&self, point: &Point, global: Global) -> f64 {
        let here = self.get(point, global).abs();
        self.typical(point, global).max(0.1 * here)
    }
}
