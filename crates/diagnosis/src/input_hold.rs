//! The course of a force or a command between its samples, as the recordings show it.

use super::baseline::{problem, refit};
use super::error::DiagnosisError;
use super::experiments::{coupled, experiments};
use super::point::Point;
use super::problem::{Problem, Rows};
use super::projector::Projector;
use super::screen::{Table, candidates};
use super::split;
use super::stretches::Stretches;
use super::thresholds::{LONG, STRONG};
use super::weights::measure_noise;
use super::whitening::Whitening;
use quell_model::effects::Slot;
use quell_model::{Experiment, Hold, Model, Term};
use quell_recording::Role;

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
/// too late. So does a command that its controller renews more often than it is recorded. Only a motor side that a
/// force drives freely, and a position loop, show the difference. The free motor side is coupled to its measured
/// motion, so that other missing physics counts where it acts. Friction, which every axis has, changes with the
/// acceleration and so would decide: a learned law takes it up. The evidence is that of [`super::evidence`]: half
/// the difference of chi-squared, in units of the residual per row.
pub fn held_input(
    model: &Model,
    recordings: &Stretches,
    usual: &[Experiment],
) -> Result<Option<Held>, DiagnosisError> {
    let is_command = usual[0].input == Role::CommandPosition;
    if model.hold.is_some() || usual[0].windows.is_empty() && !is_command {
        return Ok(None);
    }
    let (other, words) = match usual[0].hold {
        Hold::Linear => (Hold::ZeroOrder, "held from sample to sample"),
        Hold::ZeroOrder if is_command => (Hold::Spline, "a smooth curve through its samples"),
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
    let as_driven = |model: &Model, all: &[Experiment]| match is_command {
        true => Some(all.to_vec()),
        false => coupled(model, all),
    };
    let both = as_driven(model, usual).zip(as_driven(&held.model, &held.experiments));
    let Some((usual, other)) = both else {
        return Ok(None);
    };
    let rows: usize = usual.iter().map(Experiment::samples).sum();
    let own = Fitted::new(model, &usual);
    let (before, after) = (own.cost, own.cost_with(&held.model, &other));
    let evidence = 0.5 * (before - after) * rows as f64 / after;
    tracing::debug!(before, after, evidence, words, "input between samples");
    Ok((evidence > STRONG).then_some(held))
}

/// A refitted model with friction.
struct Fitted {
    point: Point,
    /// The noise that weighs the rows.
    whitening: Vec<Vec<Whitening>>,
    /// Chi-squared.
    cost: f64,
}

impl Fitted {
    fn new(model: &Model, experiments: &[Experiment]) -> Self {
        let mut problem = problem(model, experiments, rows(experiments));
        let start = problem.start(model);
        measure_noise(&mut problem, &start);
        let projector = Projector::new(&problem);
        let refitted = refit(&mut problem, &start, &projector).point;
        let start = with_friction(&problem, refitted);
        let fitted = problem.fit(&start, &projector, LONG);
        measure_noise(&mut problem, &fitted.point);
        let fitted = problem.fit(&fitted.point, &Projector::new(&problem), LONG);
        Self {
            point: fitted.point,
            whitening: problem.whitening,
            cost: fitted.cost,
        }
    }

    /// Chi-squared, with the same noise, of another model on its own experiments, fitted from here.
    fn cost_with(&self, model: &Model, experiments: &[Experiment]) -> f64 {
        let mut problem = problem(model, experiments, rows(experiments));
        problem.whitening.clone_from(&self.whitening);
        problem
            .fit(&self.point, &Projector::new(&problem), LONG)
            .cost
    }
}

fn rows(experiments: &[Experiment]) -> Vec<Vec<Rows>> {
    experiments.iter().map(split::whole).collect()
}

/// A point with a learned law of friction at the first place that may have one.
fn with_friction(problem: &Problem, point: Point) -> Point {
    let mut learned = candidates(problem, Table::Learned).into_iter();
    match learned.find(|own| own.0.slot() == Some(Slot::Friction)) {
        Some((effect, place)) => {
            let starts = (effect.starts)(&problem.scales);
            let values = starts
                .into_iter()
                .next()
                .unwrap_or_else(|| effect.neutral());
            point.with(Term::new(effect, place, values))
        }
        None => point,
    }
}
