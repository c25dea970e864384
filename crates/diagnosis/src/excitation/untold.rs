//! Whether a motion determines the unknowns of a model.

use super::words::advice;
use crate::document::{Diagnosis, Verdict};
use crate::figure::figure;
use crate::judge::Judge;
use crate::next_move::{Information, SEPARATES};
use crate::point::{Global, Point};
use crate::problem::Problem;
use nalgebra::DVector;
use quell_model::{Experiment, Model};

/// The recordings that the verdict is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// The recordings that are fitted.
    In,
    /// Those that are held out.
    Out,
}

/// Recordings that do not determine a model's unknowns. Errors of all unknowns within the standard deviations
/// of the model's kind would, in every combination, change the outputs by a chi-squared of less than 10, which
/// is strong evidence.
pub struct Untold {
    words: String,
}

impl Untold {
    /// The verdict on a refitted model, for the fitted recordings and those held out; `None` where both
    /// determine it.
    pub fn of(model: &Model, problem: &Problem, point: &Point, judge: &Judge) -> Option<Self> {
        Self::by(model, problem, point, Held::In).or_else(|| {
            if judge.data.apart.is_empty() {
                return None;
            }
            let (apart, own) = judge.apart(problem, point);
            Self::by(model, &apart, &own.point, Held::Out)
        })
    }

    fn by(model: &Model, problem: &Problem, point: &Point, held: Held) -> Option<Self> {
        let (told, steps) = information(model, problem, point)?;
        // NaN does not count as evidence.
        if told.largest(&steps) >= SEPARATES {
            return None;
        }
        let experiment = &problem.experiments[0];
        let (output, noise) = (&experiment.outputs[0], problem.noise[0][0].deviation);
        let travel = figure(travel(&experiment.input_values), &experiment.input_unit);
        let rows: usize = problem.experiments.iter().map(Experiment::samples).sum();
        let (key, percent) = believed(model);
        let square = told.alone(0) * steps[0].powi(2);
        let change = (square.max(0.0) / rows as f64).sqrt() * noise * output.scale;
        let which = match held {
            Held::In => "",
            Held::Out => " that was held out",
        };
        Some(Self {
            words: format!(
                "The recording{which} does not excite the model: {} moves by {travel} in all, and {key} wrong by {percent} \
                 would change {} by {} rms, where the noise is {}. {}",
                experiment.input,
                output.channel,
                figure(change, &output.unit),
                figure(noise * output.scale, &output.unit),
                advice(model, experiment, noise),
            ),
        })
    }

    /// Replaces the verdict `NoMismatch`. A mismatch stays one, whatever excited it.
    pub fn said(&self, diagnosis: &mut Diagnosis) {
        if diagnosis.verdict == Verdict::NoMismatch {
            diagnosis.verdict = Verdict::NotExcited;
            diagnosis.summary.clone_from(&self.words);
        }
    }
}

/// The first key that is only believed, and its uncertainty.
fn believed(model: &Model) -> (&'static str, String) {
    let key = model.kind.keys.iter().find(|key| key.belief > 0.0);
    key.map_or(("a key", "all that is believed".into()), |key| {
        let percent = match key.range.0 > 0.0 {
            true => format!("{:.0} %", 100.0 * key.belief),
            false => figure(key.belief, ""),
        };
        (key.name, percent)
    })
}

/// Information of the data alone about the keys of a model's kind, all free and without beliefs, and their
/// usual errors.
fn information(
    model: &Model,
    problem: &Problem,
    point: &Point,
) -> Option<(Information, DVector<f64>)> {
    let keys = model.kind.keys.iter().enumerate();
    let open = |index: usize| {
        let key = &model.kind.keys[index];
        let there = model.given[index] || key.default.is_none();
        let value = point.keys[index];
        key.belief > 0.0 && there && (key.range.0..=key.range.1).contains(&value)
    };
    let free: Vec<usize> = keys.map(|(index, _)| index).filter(|i| open(*i)).collect();
    let doubting = Problem {
        whitening: problem.noise.clone(),
        beliefs: problem
            .beliefs
            .iter()
            .map(|b| (b.0, f64::INFINITY))
            .collect(),
        given: Vec::new(),
        free,
        frozen: false,
        ..problem.clone()
    };
    let globals = doubting.globals(point);
    let step = |global: &Global| match *global {
        Global::Key(key) => model.kind.keys[key].belief,
        other => doubting.typical(point, other),
    };
    let steps = DVector::from_iterator(globals.len(), globals.iter().map(step));
    (!globals.is_empty()).then(|| (Information::new(&doubting, point), steps))
}

/// Greatest minus least value.
fn travel(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    high - low
}
