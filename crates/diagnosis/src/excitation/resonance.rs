//! Whether recordings show the resonance that a model has.

use super::sampled::rate;
use super::words::advice;
use crate::baseline::problem;
use crate::data::Data;
use crate::document::{Diagnosis, Verdict};
use crate::explanation::Explanation;
use crate::figure::figure;
use crate::fit::Fitted;
use crate::judge::Judge;
use crate::next_move::SEPARATES;
use crate::point::Point;
use crate::problem::Problem;
use crate::projector::Projector;
use crate::refitted::baseline;
use crate::thresholds::LONG;
use quell_model::{Model, NO_RESONANCE};
use quell_recording::health::quantum;
use std::f64::consts::TAU;

/// Largest damping ratio of the fit: the faster of the two real poles is then at 6 times the natural frequency, where the
/// integration is still stable.
const OVERDAMPED: f64 = 3.0;
/// Damping ratio from which a fit without a resonance starts.
const DAMPED: f64 = 0.8;
/// Steps of a fit after which its starts are compared.
const FIRST: usize = 3;
/// Ratio of the frequencies of two starts.
const APART: f64 = 2.0;

/// Recordings that a linear response of the model's kind explains down to the noise, and that show no resonance.
///
/// The model is refitted with any frequency that the samples can show and any damping. If that leaves only noise, and
///
/// - a rigid transmission leaves as much, the recordings show no flexibility,
/// - every response with a damping ratio below [`NO_RESONANCE`] leaves more, they show no resonance.
///
/// "More" is a chi-squared of 10, which is strong evidence. A search would bend a resonance by friction and damping until it is
/// none.
pub struct NoResonance {
    words: String,
}

impl NoResonance {
    /// The verdict where the refitted model leaves more than noise, or ends at the end of what is believed of its mode. `None`
    /// where it does neither, where the mode is known for certain, where the recordings show a resonance, or where they show another mismatch.
    pub fn of(
        model: &Model,
        data: &Data,
        refit: &Problem,
        own: (&Explanation, &Judge),
    ) -> Option<Self> {
        let mode: [usize; 2] = refit.kind.mode?.into();
        let (refitted, judge) = own;
        let mut ends = refit.at_their_ends(&refitted.fitted.point);
        let is_known = mode.iter().any(|key| !refit.free.contains(key));
        if is_known || judge.leaves_noise(refitted) && !ends.any(|key| mode.contains(&key)) {
            return None;
        }
        let mut free = Free::new(model, data, mode);
        let start = free.best(&free.problem, DAMPED).point;
        let mut given = model.clone();
        for key in mode {
            given.values[key] = start.keys[key].into();
        }
        let (any, projector) = baseline(&given, &mut free.problem);
        let judge = Judge::new(model, data, &free.problem, &any.point);
        let (hertz, ratio, least) = (any.point.keys[mode[0]], any.point.keys[mode[1]], any.cost);
        let own = judge.judge(&free.problem, &projector, any);
        if !judge.leaves_noise(&own) {
            return None;
        }
        let most = least + SEPARATES * judge.unit(&own);
        let noise = free.problem.noise[0][0].deviation;
        let rigid = free.rigid();
        let words = if rigid.cost < most || free.is_rounding(&own.fitted.point, &rigid.point) {
            free.of_rigid(model, noise)
        } else if free.resonant().cost > most {
            of_damped(hertz, ratio)
        } else {
            return None;
        };
        Some(Self { words })
    }

    /// Replaces the verdict, which is about the response of a resonance.
    pub fn said(self, diagnosis: &mut Diagnosis) {
        diagnosis.verdict = Verdict::NotExcited;
        diagnosis.summary = self.words;
    }
}

/// The refit with a free mode.
struct Free<'a> {
    problem: Problem<'a>,
    /// Keys of the natural frequency and of the damping ratio.
    mode: [usize; 2],
    start: Point,
    /// A frequency that is high against what the samples show, Hz: a step of the integration is a radian of it, and the
    /// integration still stable.
    stiff: f64,
}

impl<'a> Free<'a> {
    fn new(model: &Model, data: &'a Data, mode: [usize; 2]) -> Self {
        let mut problem = problem(model, &data.experiments, data.train.clone());
        let outputs = data.experiments.iter().flat_map(|own| &own.outputs);
        let rates = outputs.map(|output| rate(&output.time));
        let highest = 0.5 * rates.fold(f64::INFINITY, f64::min);
        let step = data.experiments.iter().map(|own| own.grid.step());
        let stiff = (TAU * step.fold(0.0, f64::max)).recip();
        let lowest = problem.bounds[mode[0]].0;
        problem.bounds[mode[0]] = (lowest, highest.max(lowest));
        problem.bounds[mode[1]].1 = OVERDAMPED;
        for key in mode {
            problem.beliefs[key].1 = f64::INFINITY;
        }
        Self {
            start: problem.start(model),
            problem,
            mode,
            stiff,
        }
    }

    /// The best of short fits from all frequencies with a damping ratio.
    fn best(&self, problem: &Problem, damping: f64) -> Fitted {
        let projector = Projector::new(problem);
        let (low, high) = problem.bounds[self.mode[0]];
        let all = std::iter::successors(Some(low), |hertz| Some(APART * hertz));
        let fits = all.take_while(|hertz| *hertz < high).map(|hertz| {
            let mut point = self.start.clone();
            (point.keys[self.mode[0]], point.keys[self.mode[1]]) = (hertz, damping);
            problem.fit(&point, &projector, FIRST)
        });
        let none = || problem.fit(&self.start, &projector, 0);
        fits.min_by(|a, b| a.cost.total_cmp(&b.cost))
            .unwrap_or_else(none)
    }

    /// The best fit with a resonance.
    fn resonant(&self) -> Fitted {
        let mut problem = self.problem.clone();
        problem.bounds[self.mode[1]].1 = NO_RESONANCE;
        let start = self.best(&problem, 0.5 * NO_RESONANCE).point;
        problem.fit(&start, &Projector::new(&problem), LONG)
    }

    /// The fit of a transmission that is rigid as far as the samples can tell.
    fn rigid(&self) -> Fitted {
        let mut problem = self.problem.clone();
        problem.free.retain(|key| !self.mode.contains(key));
        let mut point = self.start.clone();
        (point.keys[self.mode[0]], point.keys[self.mode[1]]) = (self.stiff, 1.0);
        problem.fit(&point, &Projector::new(&problem), LONG)
    }

    /// Whether two responses differ by less than the steps of the sensors: rounding is no noise that samples average.
    fn is_rounding(&self, one: &Point, other: &Point) -> bool {
        let mut all = self.problem.experiments.iter().enumerate();
        all.all(|(e, experiment)| {
            let input = quantum(&experiment.input_values).unwrap_or(0.0);
            let [one, other] = [one, other].map(|point| self.problem.explained(point, e));
            let mut pairs = experiment.outputs.iter().zip(one.iter().zip(&other));
            pairs.all(|(output, (one, other))| {
                let step = input + quantum(&output.values).unwrap_or(0.0);
                one.iter().zip(other).all(|(a, b)| (a - b).abs() < step)
            })
        })
    }

    fn of_rigid(&self, model: &Model, noise: f64) -> String {
        let experiment = &self.problem.experiments[0];
        let output = &experiment.outputs[0];
        format!(
            "The recording shows no resonance to be modelled: {} follows {} as if both were rigid, within the noise of {}. {} If the \
             machine does not vibrate, it needs no shaper, and no flexible joint in its model.",
            output.channel,
            experiment.input,
            figure(noise * output.scale, &output.unit),
            advice(model, experiment, noise)
        )
    }
}

/// The sentence on a response that does not ring.
fn of_damped(hertz: f64, ratio: f64) -> String {
    let period = 1.0 / hertz;
    format!(
        "The recording shows no resonance to be modelled: the link follows the motor side with a damping ratio near {ratio:.2}, \
         at {} Hz, and nothing else is missing. From {NO_RESONANCE:.3} on a response has no half-power bandwidth, so that no shaper \
         is of use for it. If the machine does vibrate, record a move within {} s and the rest after it, or an accelerometer at \
         the tip.",
        figure(hertz, ""),
        figure(period, ""),
    )
}
