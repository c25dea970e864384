//! What a force does between its samples, as the recordings show it.

use super::baseline::{problem, refit};
use super::error::DiagnosisError;
use super::experiments::{coupled, experiments};
use super::projector::Projector;
use super::split;
use super::stretches::Stretches;
use super::thresholds::STRONG;
use super::weights::measure_noise;
use super::whitening::Whitening;
use quell_model::{Experiment, Hold, Model};

/// A model that says what its input does between its samples, which the given one does not.
pub struct Held {
    /// The model.
    pub model: Model,
    /// The recordings as it sees them.
    pub experiments: Vec<Experiment>,
    /// What the input does.
    pub words: &'static str,
}

/// The model with the other course of its input between its samples, where that explains the recordings clearly better
/// than the usual one; none where it does not, or where the model says what its input does.
///
/// A controller holds a force from tick to tick: taken for straight lines it acts half a sample too early, which no law
/// should have to explain. A force that was measured is smooth: taken for held it acts too late. Only a motor side that
/// a force drives freely shows the difference, coupled to its measured motion, so that what else is missing counts where
/// it acts. The evidence is that of [`super::evidence`]: half the difference of chi-squared, in units of what is left a row.
pub fn held_input(
    model: &Model,
    recordings: &Stretches,
    usual: &[Experiment],
) -> Result<Option<Held>, DiagnosisError> {
    if model.hold.is_some() || usual[0].windows.is_empty() {
        return Ok(None);
    }
    let (other, words) = match usual[0].hold {
        Hold::Linear => (Hold::ZeroOrder, "held from sample to sample"),
        Hold::ZeroOrder => (Hold::Linear, "straight lines between its samples"),
        Hold::Spline | Hold::Smooth(_) => return Ok(None),
    };
    let mut model_held = model.clone();
    model_held.hold = Some(other);
    let held = Held {
        experiments: experiments(&model_held, recordings)?,
        model: model_held,
        words,
    };
    let both = coupled(model, usual).zip(coupled(&held.model, &held.experiments));
    let Some((usual, other)) = both else {
        return Ok(None);
    };
    let (before, rows, whitening) = left(model, &usual, None);
    let (after, ..) = left(&held.model, &other, Some(whitening));
    let evidence = 0.5 * (before - after) * rows / after;
    Ok((evidence > STRONG).then_some(held))
}

/// Chi-squared that a refitted model leaves of coupled experiments, the number of rows, and the noise by which they are
/// weighed.
fn left(
    model: &Model,
    coupled: &[Experiment],
    known: Option<Vec<Vec<Whitening>>>,
) -> (f64, f64, Vec<Vec<Whitening>>) {
    let rows = coupled.iter().map(split::whole).collect();
    let mut problem = problem(model, coupled, rows);
    let mut start = problem.start(model);
    match known {
        Some(whitening) => problem.whitening = whitening,
        None => {
            measure_noise(&mut problem, &start);
            let projector = Projector::new(&problem);
            start = refit(&mut problem, &start, &projector).point;
            measure_noise(&mut problem, &start);
        }
    }
    let projector = Projector::new(&problem);
    let fitted = refit(&mut problem, &start, &projector);
    let count = coupled.iter().map(Experiment::samples).sum::<usize>() as f64;
    (fitted.cost, count, problem.whitening)
}
