//! One investigation, from experiments to a diagnosis.

use super::baseline::problem;
use super::better_model::better_model;
use super::candidate::Known;
use super::conclude::{Concluded, conclude, reported};
use super::data::Data;
use super::document::Verdict;
use super::draw::draw;
use super::error::DiagnosisError;
use super::excitation::{NoResonance, Untold};
use super::explanation::Explanation;
use super::judge::Judge;
use super::long_steps::searched_in_long_steps;
use super::next_move::{Late, next_move};
use super::outcome::{Options, Outcome, Progress};
use super::point::Point;
use super::pool::Pool;
use super::refitted::baseline;
use super::remarks::{of_fit, of_outputs, recorded};
use super::scores::Recordings;
use super::settled::{finished, search, settled};
use super::stop::Stop;
use super::units::units;
use quell_model::{Experiment, Model};
use quell_recording::Recording;

/// Rounds of refining a gain: a deformation's, which the given model may show out of step with its own, is wrong by
/// some ten percent before the first one, and each leaves about the square of that.
const GAIN_ROUNDS: usize = 2;
/// Remark where the next move was left out.
const LATE: &str = "The time was over before the next move was found.";

/// Result of one look.
pub(super) struct Looked {
    /// The outcome.
    pub outcome: Outcome,
    /// Fitted points of the explanations of the search.
    pub points: Vec<Point>,
    /// Whether effects were found, with all keys of the model inside their believed ranges.
    pub believable: bool,
}

/// One look at experiments, and at others held apart.
pub(super) fn attempt(
    model: &Model,
    recordings: Recordings,
    (fitted, apart): (Vec<Experiment>, Vec<Experiment>),
    known: &Known,
    options: &Options,
    progress: Progress,
) -> Result<Looked, DiagnosisError> {
    let mut data = Data::new(model, fitted, apart);
    let start = refine_gains(model, &mut data, options)?;
    let data = (&start, &data);
    let looked = investigate(model, (data, recordings), known, options, progress)?;
    Ok(Looked {
        outcome: named(looked.outcome, data.1, recordings.0),
        ..looked
    })
}

/// Refines gains between raw readings with the refitted model, and gives the model to start from. With the given one a
/// vibration whose frequency it does not have is out of step with the reading, and takes part in the gain.
fn refine_gains(
    model: &Model,
    data: &mut Data,
    options: &Options,
) -> Result<Model, DiagnosisError> {
    let mut start = model.clone();
    let is_unknown = |own: &Experiment| own.outputs.iter().any(|output| output.gain.is_some());
    if !data.experiments.iter().chain(&data.apart).any(is_unknown) {
        return Ok(start);
    }
    for _ in 0..GAIN_ROUNDS {
        start = with_gains(&start, data);
        let mut problem = problem(model, &data.experiments, data.train.clone());
        problem.stop = options.stop.clone();
        let (fitted, _) = baseline(&start, &mut problem);
        options.stop.check()?;
        start = better_model(model, &fitted.point);
    }
    Ok(with_gains(&start, data))
}

/// Refines the gains of all experiments with a model; gives the model by which the last of them is told.
fn with_gains(model: &Model, data: &mut Data) -> Model {
    let all = data.experiments.iter_mut().chain(&mut data.apart);
    all.fold(model.clone(), |model, own| own.refine_gain(&model))
}

/// Adds the recording's name to each drawn series where there are several recordings.
fn named(mut outcome: Outcome, data: &Data, recordings: &[Recording]) -> Outcome {
    if recordings.len() > 1 {
        let pairs = recordings.iter().zip(&data.experiments);
        let names = pairs.flat_map(|(r, e)| std::iter::repeat_n(&r.name, e.outputs.len()));
        for (trace, name) in outcome.traces.outputs.iter_mut().zip(names) {
            trace.name = format!("{name}: {}", trace.name);
        }
    }
    outcome
}

/// All steps of a look.
fn investigate(
    model: &Model,
    ((start, data), recordings): ((&Model, &Data), Recordings),
    known: &Known,
    options: &Options,
    progress: Progress,
) -> Result<Looked, DiagnosisError> {
    let mut remarks = recorded(recordings.0);
    progress(0.05, "refitting the model");
    let mut problem = problem(model, &data.experiments, data.train.clone());
    problem.stop = options.stop.clone();
    problem.catalogue = options.catalogue;
    let (fitted, mut projector) = baseline(start, &mut problem);
    options.stop.check()?;
    let mut judge = Judge::new(model, data, &problem, &fitted.point);
    let untold = Untold::of(model, &problem, &fitted.point, &judge);
    let baseline: Explanation = judge.judge(&problem, &projector, fitted);
    let unresonant = NoResonance::of(model, data, &problem, (&baseline, &judge));
    options.stop.check()?;
    progress(0.1, "locating the mismatch");
    let located = problem.locate(&baseline);
    problem.locate_again(&baseline);
    options.stop.check()?;
    progress(0.15, "screening the catalogue");
    let told = (known, progress);
    problem.enough = options.enough.clone();
    let mut pool = match unresonant {
        // There is no mode whose physics could be searched.
        Some(_) => Pool::new(baseline),
        None => {
            let own = (&mut problem, &mut projector);
            let pool = searched_in_long_steps(own.0, own.1, &mut judge, &baseline, told);
            let pool = pool.unwrap_or_else(|| Pool::new(baseline));
            settled(&mut problem, &mut projector, &mut judge, pool, told)
        }
    };
    let cut = problem.is_cut();
    // What is told is fitted to its end.
    problem.enough = Stop::default();
    if cut {
        pool = finished(&mut problem, &mut projector, &mut judge, &pool, told);
    }
    pool.is_unfinished |= cut;
    let search = search(&problem, &projector, &judge, told);
    let found = search.found(pool);
    options.stop.check()?;
    remarks.extend(of_outputs(&problem, &found));
    remarks.extend(search.elsewhere(&found));
    let told = (recordings, remarks);
    let Concluded {
        mut diagnosis,
        scale,
        better,
        point: last,
    } = conclude(&search, &found, &located, told, options);
    if let Some(untold) = untold {
        untold.said(&mut diagnosis);
    }
    if let Some(unresonant) = unresonant {
        unresonant.said(&mut diagnosis);
    }
    options.stop.check()?;
    let verdict = diagnosis.verdict;
    if verdict != Verdict::NotExcited {
        diagnosis.remarks.extend(of_fit(&problem, &found));
    }
    let next = next_move(&search, &found, verdict, &options.enough);
    let next = next.unwrap_or_else(|Late| {
        diagnosis.remarks.push(LATE.into());
        None
    });
    diagnosis.next_move = next.or_else(|| scale.as_ref()?.next_move());
    let told = reported(verdict, [&found.baseline, &found.best]);
    let points = found.points();
    let traces = draw(&search, &found.baseline, told, &located);
    let point = &told.fitted.point;
    let believable = told.terms() > 0 && problem.at_their_ends(point).next().is_none();
    let terms = last.terms.iter().cloned();
    let outcome = Outcome {
        happened: terms.filter(|term| term.recording.is_some()).collect(),
        model: better,
        diagnosis,
        traces,
        units: Some(units(&problem, &last)),
    };
    Ok(Looked {
        outcome,
        points,
        believable,
    })
}
