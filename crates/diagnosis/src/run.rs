//! One investigation, from experiments to a diagnosis; a second one where something changed with time.

use super::baseline::{Data, problem, refit};
use super::candidate::Known;
use super::conclude::{better_model, conclude, reported};
use super::draw::draw;
use super::error::DiagnosisError;
use super::excitation::Untold;
use super::explanation::{Explanation, Judge};
use super::fit::{Fitted, Projector};
use super::found::Found;
use super::next_move::next_move;
use super::outcome::{Options, Outcome, Progress};
use super::point::Point;
use super::problem::Problem;
use super::remarks::recorded;
use super::search::Search;
use super::settled::{search, settled};
use super::start::ringing;
use super::thresholds::LONG;
use super::weights::measure_noise;
use quell_model::{Experiment, Model};
use quell_recording::Recording;

/// What experiments, and others held apart, say; and the explanations that were looked at.
pub(super) fn attempt(
    model: &Model,
    train: &[Recording],
    (fitted, apart): (Vec<Experiment>, Vec<Experiment>),
    known: &Known,
    options: &Options,
    progress: Progress,
) -> Result<(Outcome, Vec<Point>), DiagnosisError> {
    let mut data = Data::new(fitted, apart);
    let told = recorded(train);
    let mut ending = investigate(model, &data, known, options, progress, told.clone(), false)?;
    loop {
        match ending {
            Ending::Told(outcome, points) => {
                return Ok((named(*outcome, &data, train), points));
            }
            Ending::Surprised(period, mut points) => {
                // What happens at a time (a payload, an impact) and was held out cannot be learned: hold out
                // parts of every move instead.
                data.interleave(INTERLEAVED_PERIODS * period);
                let remark = "What was held out differs from what was fitted: something changed with time. \
                    Stretches of every move were held out instead of the last moves.";
                let told = std::iter::once(remark.to_string()).chain(told.clone());
                let told = told.collect();
                // What was fitted best may be right all the same: a force that is wrong by little drifts away
                // in what was held out.
                points.extend(known.points.iter().cloned());
                let known = Known {
                    points,
                    ..known.clone()
                };
                ending = investigate(model, &data, &known, options, progress, told, true)?;
            }
        }
    }
}

/// Where there are several recordings, each series that is drawn bears the name of its own.
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

/// Length of held-out stretches of time, in periods of the mode: long enough that the noise of one is
/// not the noise of its neighbours.
const INTERLEAVED_PERIODS: f64 = 3.0;
/// Held-out chi-squared per row over the fitted part's, above which something changed with time.
const SURPRISE: f64 = 2.0;
/// Log of the odds by which an explanation of what was fitted is better, so that its failure on what was held out
/// tells that something changed: 1000 to 1.
const CERTAIN: f64 = 6.9;

/// How an investigation ends.
enum Ending {
    /// With what it says, and the explanations that were looked at.
    Told(Box<Outcome>, Vec<Point>),
    /// What was held out is worse than what was fitted by more than chance: something changed with time.
    /// The period of the mode, s, and the explanations that were looked at.
    Surprised(f64, Vec<Point>),
}

/// The whole journey; a second one is told however it ends.
fn investigate(
    model: &Model,
    data: &Data,
    known: &Known,
    options: &Options,
    progress: Progress,
    mut remarks: Vec<String>,
    is_second: bool,
) -> Result<Ending, DiagnosisError> {
    progress(0.05, "refitting the model");
    let mut problem = problem(model, &data.experiments, data.train.clone());
    problem.stop = options.stop.clone();
    problem.catalogue = options.catalogue;
    let (fitted, mut projector) = baseline(model, &mut problem);
    options.stop.check()?;
    let judge = Judge::new(model, data, &problem, &fitted.point);
    let untold = Untold::of(model, &problem, &fitted.point, &judge);
    let baseline: Explanation = judge.judge(&problem, &projector, fitted);
    progress(0.1, "locating the mismatch");
    let located = problem.locate(&baseline);
    problem.scales = problem.located_in(&baseline);
    options.stop.check()?;
    progress(0.15, "screening the catalogue");
    let told = (known, progress);
    let found = settled(&mut problem, &mut projector, &judge, baseline, told);
    let search = search(&problem, &projector, &judge, told);
    if !is_second && data.apart.is_empty() && surprised(&search, &found) {
        return Ok(Ending::Surprised(problem.scales.period(), found.points()));
    }
    options.stop.check()?;
    remarks.extend(super::remarks::remarks(&problem, &found));
    if options.enough.was_asked() {
        let remark = "The search was ended before its time: this is the best explanation so far, and further \
            effects may be missing.";
        remarks.push(remark.into());
    }
    let (mut diagnosis, scale) = conclude(&search, &found, &located, remarks, options.seed);
    if let Some(untold) = untold {
        untold.said(&mut diagnosis);
    }
    options.stop.check()?;
    let verdict = diagnosis.verdict;
    diagnosis.next_move =
        next_move(&search, &found, verdict).or_else(|| scale.as_ref()?.next_move());
    let told = reported(verdict, &found);
    let points = found.points();
    let traces = draw(&search, &found.baseline, told, &located);
    let better = better_model(model, told);
    let outcome = Outcome {
        model: match scale {
            Some(scale) => scale.corrected(better),
            None => better,
        },
        diagnosis,
        traces,
    };
    Ok(Ending::Told(Box::new(outcome), points))
}

/// Whether what is held out is unlike what was fitted; or what explains the latter best, by far, fails on
/// the former, as a law of time does that ends or levels off.
fn surprised(search: &Search, found: &Found) -> bool {
    let (judge, temperature) = (search.judge, found.temperature);
    if judge.held_out_rows == 0 || search.leaves_noise(&found.best) {
        return false;
    }
    let fitted = |own: &Explanation| own.evidence.of_fitted(temperature);
    let all = found.ranked.iter().map(|own| fitted(&own.0));
    if all.fold(f64::NEG_INFINITY, f64::max) > fitted(&found.best) + CERTAIN {
        return true;
    }
    let per_row = |chi: f64, rows: usize| chi / rows.max(1) as f64;
    let held = per_row(
        found.best.evidence.held_out_beyond_fit(),
        judge.held_out_rows,
    );
    held > SURPRISE * per_row(found.best.train, judge.train_rows).max(1.0)
}

/// The given model, refitted, with the noise that it leaves measured.
fn baseline(model: &Model, problem: &mut Problem) -> (Fitted, Projector) {
    let start = problem.start(model);
    if problem.experiments[0].outputs.len() > 1 {
        // What the model as it was given leaves of each output is the first guess of their weights.
        measure_noise(problem, &start);
    }
    let mut projector = Projector::new(problem);
    let mut first = refit(problem, &start, &projector);
    first = ringing(problem, first, &projector);
    // What rings at the start would be taken for noise, were it not fitted first.
    measure_noise(problem, &first.point);
    projector = Projector::new(problem);
    (problem.fit(&first.point, &projector, LONG), projector)
}
