//! The course of a force or a command between its samples, as the recordings show it.

use super::autocorrelation::correlation;
use super::baseline::{problem, refit};
use super::error::DiagnosisError;
use super::experiments::{coupled, experiments};
use super::point::Point;
use super::problem::{Problem, Rows};
use super::projector::Projector;
use super::screen::{Table, candidates};
use super::split;
use super::stretches::Stretches;
use super::thresholds::{LONG, MOSTLY_NOISE, STRONG};
use super::weights::measure_noise;
use super::whitening::Whitening;
use nalgebra::DVector;
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

/// The model with the other course of its input between the samples, if that explains the recordings better. It is a first guess:
/// what the model lacks may act as half a sample does.
///
/// A controller holds a force from tick to tick. If it is interpolated by straight lines, it acts half a sample
/// too early, which no law should have to explain. A measured force is smooth; if it is taken for held, it acts
/// too late. So does a command that its controller renews more often than it is recorded. Only a motor side that a
/// force drives freely, and a position loop, show the difference. The free motor side is coupled to its measured
/// motion, so that other missing physics counts where it acts. The evidence is that of [`super::evidence`]: half
/// the difference of chi-squared, in units of the residual per row.
pub fn held_input(
    model: &Model,
    recordings: &Stretches,
    usual: &[Experiment],
) -> Result<Option<Held>, DiagnosisError> {
    let other = Other::new(model, recordings, usual)?;
    Ok(other
        .filter(|own| own.evidence() > STRONG)
        .map(|own| own.held))
}

/// The same with the model that was found, once noise is most of what is left. It is asked without its effects of drive and sensor, too: a
/// delay or a lag among these may stand for half a sample. Of the residual only independent rows count.
pub fn held_beside(
    found: &Model,
    recordings: &Stretches,
    usual: &[Experiment],
) -> Result<Option<Held>, DiagnosisError> {
    let is_certain = |own: &Other| {
        own.per_row() < MOSTLY_NOISE && own.evidence() / correlation(&own.left) > STRONG
    };
    let mut without = found.clone();
    without.effects.retain(|own| !own.effect.acts_on_signal());
    let mut asked = vec![found];
    if without.effects.len() < found.effects.len() {
        asked.push(&without);
    }
    for model in asked {
        let other = Other::new(model, recordings, usual)?;
        if let Some(own) = other.filter(is_certain) {
            return Ok(Some(own.held));
        }
    }
    Ok(None)
}

/// The other course of the input, beside the present one.
struct Other {
    held: Held,
    /// Chi-squared with the present course.
    before: f64,
    /// Residual with the other one.
    left: DVector<f64>,
}

impl Other {
    /// Both courses, each with the model refitted; `None` where the motion does not show the difference.
    fn new(
        model: &Model,
        recordings: &Stretches,
        usual: &[Experiment],
    ) -> Result<Option<Self>, DiagnosisError> {
        let is_command = usual[0].input == Role::CommandPosition;
        if usual[0].windows.is_empty() && !is_command {
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
        let own = Fitted::new(model, &usual);
        let other = Self {
            before: own.left.norm_squared(),
            left: own.left_with(&held.model, &other),
            held,
        };
        tracing::debug!(
            before = other.before,
            per_row = other.per_row(),
            evidence = other.evidence(),
            words,
            "input between samples"
        );
        Ok(Some(other))
    }

    /// Chi-squared per row that the other course leaves.
    fn per_row(&self) -> f64 {
        self.left.norm_squared() / self.left.len() as f64
    }

    /// Log evidence for the other course where all rows are independent.
    fn evidence(&self) -> f64 {
        0.5 * (self.before - self.left.norm_squared()) / self.per_row()
    }
}

/// A refitted model. Friction, which every axis has, changes with the acceleration and so would decide: where the model has no effect,
/// a learned law takes it up.
struct Fitted {
    point: Point,
    /// The noise that weighs the rows.
    whitening: Vec<Vec<Whitening>>,
    /// Whitened residual.
    left: DVector<f64>,
}

impl Fitted {
    fn new(model: &Model, experiments: &[Experiment]) -> Self {
        let mut problem = problem(model, experiments, rows(experiments));
        let start = problem.start(model);
        measure_noise(&mut problem, &start);
        let projector = Projector::new(&problem);
        let refitted = refit(&mut problem, &start, &projector).point;
        let start = match model.effects.is_empty() {
            true => with_friction(&problem, refitted),
            false => refitted,
        };
        let fitted = problem.fit(&start, &projector, LONG);
        measure_noise(&mut problem, &fitted.point);
        let (point, left) = fitted_from(&problem, &fitted.point);
        Self {
            point,
            left,
            whitening: problem.whitening,
        }
    }

    /// The residual, with the same noise, of another model on its own experiments, fitted from here.
    fn left_with(&self, model: &Model, experiments: &[Experiment]) -> DVector<f64> {
        let mut problem = problem(model, experiments, rows(experiments));
        problem.whitening.clone_from(&self.whitening);
        fitted_from(&problem, &self.point).1
    }
}

/// The end of a fit, and what it leaves.
fn fitted_from(problem: &Problem, start: &Point) -> (Point, DVector<f64>) {
    let projector = Projector::new(problem);
    let point = problem.fit(start, &projector, LONG).point;
    let left = problem.evaluate(&point, &projector).residuals;
    let rows: Vec<f64> = left.iter().flatten().copied().collect();
    (point, rows.into())
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
