//! The experiments of a diagnosis, and what is held out of them.

use super::extrapolation::least_beyond;
use super::problem::Rows;
use super::scales::scales;
use super::split::{self, HeldOut};
use quell_model::{Experiment, Model};

/// Length of held-out stretches, in periods of the mode: long enough that the noise of neighbouring stretches
/// is independent.
const STRETCH: f64 = 3.0;

/// The experiments of a diagnosis and what is held out of them.
pub struct Data {
    /// The experiments that are fitted.
    pub experiments: Vec<Experiment>,
    /// Their fitted rows.
    pub train: Vec<Vec<Rows>>,
    /// Their held-out rows; empty where whole recordings are held out.
    pub held_out: Vec<Vec<Rows>>,
    /// Recordings that are held out as a whole.
    pub apart: Vec<Experiment>,
    /// What is held out.
    pub judged_by: HeldOut,
}

impl Data {
    /// The data from experiments and others that are held out. Without the latter, stretches are held out.
    pub fn new(model: &Model, experiments: Vec<Experiment>, apart: Vec<Experiment>) -> Self {
        let scales = scales(model.kind, &model.keys(), &experiments, model);
        let stretch = STRETCH * scales.period();
        let from = apart
            .is_empty()
            .then(|| least_beyond(&experiments, stretch));
        let (mut train, mut held_out) = (Vec::new(), Vec::new());
        for experiment in &experiments {
            let parts = match from {
                Some(from) => split::interleaved(experiment, stretch, from),
                None => split::nothing_held_out(experiment),
            };
            train.push(parts.train);
            held_out.push(parts.held_out);
        }
        let is_fitted = |own: &Experiment| experiments.iter().any(|e| e.recording == own.recording);
        let judged_by = match apart.first() {
            None => HeldOut::Stretches,
            Some(own) if is_fitted(own) => HeldOut::Windows,
            Some(_) => HeldOut::Recordings,
        };
        Self {
            experiments,
            train,
            held_out,
            apart,
            judged_by,
        }
    }

    /// The experiments that are fitted, with all their rows.
    pub fn with_all_rows(&self) -> Self {
        let splits = self.experiments.iter().map(split::nothing_held_out);
        let (train, held_out) = splits.map(|own| (own.train, own.held_out)).unzip();
        Self {
            experiments: self.experiments.clone(),
            train,
            held_out,
            apart: Vec::new(),
            judged_by: self.judged_by,
        }
    }

    /// The same data in long steps of the integration, halved so many times; `None` where that saves none.
    pub fn in_long_steps(&self, model: &Model, halved: i32) -> Option<Self> {
        let long = |all: &[Experiment]| -> Vec<Option<Experiment>> {
            all.iter()
                .map(|own| own.in_long_steps(model, halved))
                .collect()
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
