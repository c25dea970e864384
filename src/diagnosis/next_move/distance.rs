//! How far an explanation stays from the predictions of another one, whatever its unknowns are.
//!
//! `T = min |y_A - y_B(theta)|^2` over keys, effects, clocks, starts, offsets and frames, whitened by the
//! noise, on the recordings and the proposed experiment together. What the recordings alone keep them
//! apart is subtracted: it has been seen, and did not decide.
//!
//! Source: Box and Hill, Technometrics 9 (1967), and Atkinson and Fedorov, Biometrika 62 (1975): the
//! T-optimal design between two models. With `A` right, `T` is by how much the chi-squared of `B` will
//! exceed that of `A` in the mean.

use super::imagined;
use super::payload::Payload;
use crate::diagnosis::fit::{Fitted, Projector, solve};
use crate::diagnosis::prior::Prior;
use crate::diagnosis::problem::{Local, Point, Problem};
use crate::diagnosis::split;
use crate::model::Experiment;
use std::slice::from_ref;

/// Steps of a fit that starts near its end.
const SETTLING: usize = 6;
/// Steps of a fit to one proposed experiment.
const STEPS: usize = 4;

/// An explanation that is held against the best one's predictions.
pub struct Rival<'a> {
    /// The recordings as the best explanation would have them.
    problem: &'a Problem<'a>,
    /// The explanation fitted to these, and what is left.
    settled: Fitted,
    /// What the recordings say about the shared unknowns.
    prior: Prior,
}

/// Recordings as an explanation would have them, all of their rows to be fitted.
pub fn as_explained<'a>(problem: &Problem<'a>, explained: &'a [Experiment]) -> Problem<'a> {
    Problem {
        experiments: explained,
        rows: explained.iter().map(split::whole).collect(),
        ..problem.clone()
    }
}

impl<'a> Rival<'a> {
    /// An explanation at a point, held against the recordings as the best one would have them.
    pub fn new(problem: &'a Problem<'a>, point: &Point) -> Self {
        let projector = Projector::new(problem);
        let settled = problem.fit(point, &projector, SETTLING);
        let linear = problem.linearise(&settled.point, &projector);
        let (normal, gradient) = problem.normal(&settled.point, &linear);
        let centre = problem.shared(&settled.point);
        Self {
            problem,
            prior: Prior::new(centre, &normal, &gradient),
            settled,
        }
    }

    /// `T` of a proposed experiment, linear in the unknowns: one simulation for each of them.
    pub fn estimate(&self, experiment: &Experiment, best: &Point, payload: Payload) -> f64 {
        let (problem, point) = self.alone(experiment, best, payload);
        let projector = Projector::new(&problem);
        let linear = problem.linearise(&point, &projector);
        let (normal, gradient) = problem.normal(&point, &linear);
        let gain = solve(&normal, &gradient, 0.0).map_or(f64::INFINITY, |step| step.dot(&gradient));
        (linear.cost - gain).max(0.0)
    }

    /// `T` of a proposed experiment; the recordings are a quadratic form about where their fit ended.
    pub fn apart(&self, experiment: &Experiment, best: &Point, payload: Payload) -> f64 {
        let (problem, point) = self.alone(experiment, best, payload);
        let fitted = problem.fit(&point, &Projector::new(&problem), STEPS);
        fitted.cost.max(0.0)
    }

    /// `T` of a proposed experiment, recordings and experiment fitted together.
    pub fn together(&self, experiment: &Experiment, best: &Point) -> f64 {
        let mut all = self.problem.experiments.to_vec();
        all.push(experiment.clone());
        let mut problem = as_explained(self.problem, &all);
        problem.whitening.push(problem.whitening[0].clone());
        let mut point = self.settled.point.clone();
        point.locals.push(self.local(best));
        let fitted = problem.fit(&point, &Projector::new(&problem), SETTLING);
        (fitted.cost - self.settled.cost).max(0.0)
    }

    /// The proposed experiment as a problem of its own, and where its fit starts.
    fn alone<'b>(
        &self,
        experiment: &'b Experiment,
        best: &Point,
        payload: Payload,
    ) -> (Problem<'b>, Point)
    where
        'a: 'b,
    {
        let mut problem = Problem {
            experiments: from_ref(experiment),
            rows: vec![split::whole(experiment)],
            whitening: vec![self.problem.whitening[0].clone()],
            prior: Some(self.prior.clone()),
            ..self.problem.clone()
        };
        // Beliefs are in what the recordings say.
        for belief in &mut problem.beliefs {
            belief.1 = f64::INFINITY;
        }
        let mut point = self.settled.point.clone();
        point.locals = vec![self.local(best)];
        payload.load(&mut problem, &mut point);
        (problem, point)
    }

    /// Clocks that differ from the best explanation's, which is on time, as they do in the recordings.
    fn local(&self, best: &Point) -> Local {
        let (own, theirs) = (&self.settled.point.locals[0].clocks, &best.locals[0].clocks);
        Local {
            clocks: own.iter().zip(theirs).map(|(a, b)| a - b).collect(),
            departure: [0.0; 8],
        }
    }
}

/// What the best explanation says of an experiment, with a payload.
pub fn predicted(
    experiment: &Experiment,
    problem: &Problem,
    best: &Point,
    payload: Payload,
) -> Experiment {
    let mut point = best.clone();
    let mut loaded = problem.clone();
    payload.load(&mut loaded, &mut point);
    let local = Local {
        clocks: vec![0.0; experiment.outputs.len()],
        departure: [0.0; 8],
    };
    imagined::explained(problem.kind, &point, experiment, &local)
}
