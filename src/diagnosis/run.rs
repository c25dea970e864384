//! From a model and recordings to a diagnosis.

use super::baseline::{Data, DiagnosisError, measure_noise, problem, refit};
use super::explanation::{Explanation, Judge};
use super::fit::Projector;
use super::search::{Found, Search};
use crate::model::{Experiment, Model};
use crate::recording::Recording;

/// What the caller may choose.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Seed of the bootstrap.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { seed: 1 }
    }
}

/// The raw result, before words are made of it.
pub fn investigate(
    model: &Model,
    train: &[Recording],
    held_out: &[Recording],
    progress: &(dyn Fn(f64, &str) + Sync),
) -> Result<(Data, Found), DiagnosisError> {
    progress(0.0, "reading the recordings");
    let experiments = experiments(model, train)?;
    let apart = experiments_of(model, held_out)?;
    let data = Data::new(experiments, apart);
    let found = search(model, &data, progress)?;
    Ok((data, found))
}

fn experiments(model: &Model, recordings: &[Recording]) -> Result<Vec<Experiment>, DiagnosisError> {
    if recordings.is_empty() {
        return Err(DiagnosisError::NoRecording);
    }
    experiments_of(model, recordings)
}

fn experiments_of(
    model: &Model,
    recordings: &[Recording],
) -> Result<Vec<Experiment>, DiagnosisError> {
    let mut all = Vec::new();
    for recording in recordings {
        all.push(Experiment::new(model, recording)?);
    }
    Ok(all)
}

fn search(
    model: &Model,
    data: &Data,
    progress: &(dyn Fn(f64, &str) + Sync),
) -> Result<Found, DiagnosisError> {
    progress(0.05, "refitting the model");
    let mut problem = problem(model, &data.experiments, data.train.clone());
    let mut projector = Projector::new(&problem);
    let start = problem.start(model);
    let first = refit(&mut problem, &start, &projector);
    measure_noise(&mut problem, &first.point);
    projector = Projector::new(&problem);
    let mut fitted = problem.fit(&first.point, &projector, 20);
    if problem.departures.is_empty() {
        // Two more unknowns an experiment; the arm may already ring when the recording starts.
        problem.departures = vec![2, 3];
        let ringing = problem.fit(&fitted.point, &projector, 20);
        let rows = data
            .experiments
            .iter()
            .map(Experiment::samples)
            .sum::<usize>() as f64;
        let unit = (ringing.cost / rows).max(1.0);
        let price = 2.0 * data.experiments.len() as f64 * rows.ln() + 10.0;
        if (fitted.cost - ringing.cost) / unit > price {
            fitted = ringing;
        } else {
            problem.departures.clear();
        }
    }
    let judge = Judge::new(model, data, &problem);
    let baseline: Explanation = judge.judge(&problem, &projector, fitted);
    progress(0.1, "screening the catalogue");
    let search = Search {
        problem: &problem,
        projector: &projector,
        judge: &judge,
        progress,
    };
    Ok(search.run(baseline))
}
