//! The course of a force between its samples, as the recordings show it.

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

/// A model that says how its input runs between the samples, where the given model does not.
pub struct Held {
    /// The model.
    pub model: Model,
    /// The recordings as this model sees them.
    pub experiments: Vec<Experiment>,
    /// The course of the input, in words.
    pub words: &'static str,
}

/// The model with the other course of its input between the samples, if that explains the recordings clearly
/// better. `None` if it does not, or if the model itself says how its input runs.
///
/// A controller holds a force from tick to tick. If it is interpolated by straight lines, it acts half a sample
/// too early, which no law should have to explain. A measured force is smooth; if it is taken for held, it acts
/// too late. Only a motor side that a force drives freely shows the difference. It is coupled to its measured
/// motion, so that other missing physics counts where it acts. The evidence is that of [`super::evidence`]:
/// half the difference of chi-squared, in units of the residual per row.
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
        Hold::Spline | Hold::Smooth(_) | Hold::Mean(_) => return Ok(None),
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

/// Chi-squared of a refitted model on coupled experiments, the number of rows, and the noise that weighs them.
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
