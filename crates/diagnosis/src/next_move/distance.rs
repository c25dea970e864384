//! Distance of an explanation from the predictions of another one, minimised over its unknowns.
//!
//! `T = min |y_A - y_B(theta)|^2` over keys, effects, clocks, starts, offsets and frames of `B`, whitened by
//! the noise, on the recordings and the proposed experiment together. Their distance on the recordings alone is
//! subtracted: it is known already, and did not decide.
//!
//! Source: Atkinson and Fedorov, Biometrika 62 (1975): the T-optimal design between two models. With `A`
//! right, `T` is the mean by which the chi-squared of `B` will exceed that of `A`.

use super::imagined::explained;
use super::information::Information;
use super::payload::Payload;
use crate::point::{Local, Point};
use crate::problem::Problem;
use crate::projector::Projector;
use crate::split;
use quell_model::{Departure, Experiment};
use std::slice::from_ref;
use std::sync::Arc;

/// Steps of a fit that starts near its end.
const STEPS: usize = 6;

/// An explanation that is compared with the predictions of another one.
pub struct Rival<'a> {
    /// The problem that both explain.
    problem: &'a Problem<'a>,
    /// The other explanation.
    right: &'a Point,
    /// The recordings as predicted by the other explanation.
    recordings: Vec<Experiment>,
    /// Where the fit to these ended.
    point: Point,
    /// Its cost.
    left: f64,
    /// Information of the recordings about the shared unknowns.
    known: Information,
}

impl<'a> Rival<'a> {
    /// `wrong` against the recordings as `right` predicts them.
    pub fn new(problem: &'a Problem<'a>, right: &'a Point, wrong: &Point) -> Self {
        let pairs = problem.experiments.iter().zip(&right.locals);
        let recordings: Vec<Experiment> = pairs
            .map(|(experiment, local)| explained(problem.kind, right, experiment, local))
            .collect();
        let imagined = with(problem, &recordings);
        let settled = imagined.fit(wrong, &Projector::new(&imagined), STEPS);
        Self {
            known: Information::new(&imagined, &settled.point),
            point: settled.point,
            left: settled.cost,
            problem,
            right,
            recordings,
        }
    }

    /// Information of an experiment about the unknowns.
    pub fn information(&self, experiment: &Experiment, payload: Payload) -> Information {
        let mut point = self.point.clone();
        point.locals = vec![self.local()];
        let experiment = self.predicted(experiment, payload);
        let mut problem = with(self.problem, from_ref(&experiment));
        problem.whitening.truncate(1);
        // The beliefs are already in the information of the recordings.
        for belief in &mut problem.beliefs {
            belief.1 = f64::INFINITY;
        }
        payload.load(&mut problem, &mut point);
        Information::new(&problem, &point)
    }

    /// `T` of experiments with this information, linear in the unknowns.
    pub fn estimate(&self, said: &Information) -> f64 {
        (&self.known + said).least() - self.known.least()
    }

    /// `T` of an experiment, recordings and experiment fitted together.
    pub fn together(&self, experiment: &Experiment) -> f64 {
        let mut all = self.recordings.clone();
        all.push(self.predicted(experiment, Payload::NONE));
        let mut problem = with(self.problem, &all);
        problem.whitening.push(problem.whitening[0].clone());
        let mut point = self.point.clone();
        point.locals.push(self.local());
        let fitted = problem.fit(&point, &Projector::new(&problem), STEPS);
        (fitted.cost - self.left).max(0.0)
    }

    /// Prediction of an experiment by the other explanation, with a payload.
    fn predicted(&self, experiment: &Experiment, payload: Payload) -> Experiment {
        let (mut problem, mut point) = (self.problem.clone(), self.right.clone());
        payload.load(&mut problem, &mut point);
        let local = Local {
            clocks: vec![0.0; experiment.outputs.len()],
            departures: vec![Departure::default()],
        };
        explained(problem.kind, &point, experiment, &local)
    }

    /// Clocks that differ from the other explanation's as they do in the recordings; its own clocks have no
    /// offset.
    fn local(&self) -> Local {
        let (own, theirs) = (&self.point.locals[0].clocks, &self.right.locals[0].clocks);
        Local {
            clocks: own.iter().zip(theirs).map(|(a, b)| a - b).collect(),
            departures: vec![Departure::default()],
        }
    }
}

/// The problem over other experiments, all of their rows to be fitted.
fn with<'b>(problem: &Problem<'b>, experiments: &'b [Experiment]) -> Problem<'b> {
    Problem {
        experiments,
        rows: experiments.iter().map(split::whole).collect(),
        // Predicted inputs are not rounded.
        rounding_at_rest: Arc::default(),
        ..problem.clone()
    }
}
