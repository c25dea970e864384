//! The experiments of a diagnosis, and what is held out of them.

use super::problem::Rows;
use super::scales::scales;
use super::split::{self, HeldOut, Split};
use quell_model::{Experiment, Model};

/// Length of held-out stretches of time, in periods of the mode: long enough that the noise of one is
/// not the noise of its neighbours.
const STRETCH: f64 = 3.0;

/// The experiments of a diagnosis and what is held out of them.
pub struct Data {
    /// What is fitted.
    pub experiments: Vec<Experiment>,
    /// Its fitted rows.
    pub train: Vec<Vec<Rows>>,
    /// Its held-out rows; empty where whole recordings are held out.
    pub held_out: Vec<Vec<Rows>>,
    /// Recordings that are held out as a whole.
    pub apart: Vec<Experiment>,
    /// What is held out.
    pub judged_by: HeldOut,
}

impl Data {
    /// From experiments, and others that are held out; without these, stretches of them.
    pub fn new(model: &Model, experiments: Vec<Experiment>, apart: Vec<Experiment>) -> Self {
        let scales = scales(model.kind, &model.keys(), &experiments, model);
        let (mut train, mut held_out) = (Vec::new(), Vec::new());
        for experiment in &experiments {
            let parts = match apart.is_empty() {
                true => split::interleaved(experiment, STRETCH * scales.period()),
                false => Split {
                    train: split::whole(experiment),
                    held_out: vec![Vec::new(); experiment.outputs.len()],
                },
            };
            train.push(parts.train);
            held_out.push(parts.held_out);
        }
        let judged_by = match apart.is_empty() {
            true => HeldOut::Stretches,
            false => HeldOut::Recordings,
        };
        Self {
            experiments,
            train,
            held_out,
            apart,
            judged_by,
        }
    }

    /// The same in long steps of the integration, where that spares some.
    pub fn in_long_steps(&self, model: &Model) -> Option<Self> {
        let long = |all: &[Experiment]| -> Vec<Option<Experiment>> {
            all.iter().map(|own| own.in_long_steps(model)).collect()
        };
        let (experiments, apart) = (long(&self.experiments), long(&self.apart));
        experiments.iter().any(Option::is_some).then(|| {
            let or_own = |long: Vec<Option<Experiment>>, own: &[Experiment]| -> Vec<Experiment> {
                let pairs = long.into_iter().zip(own);
                pairs
                    .map(|(long, own)| long.unwrap_or_else(|| own.clone()))
                    .collect()
            };
            Self {
                experiments: or_own(experiments, &self.experiments),
                apart: or_own(apart, &self.apart),
                train: self.train.clone(),
                held_out: self.held_out.clone(),
                judged_by: self.judged_by,
            }
        })
    }
}
