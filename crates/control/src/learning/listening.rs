//! The fit of modes to the samples of a move.

use super::cause::Cause;
use super::fit::{Fit, Problem};
use super::forecast::{Expected, Forecast};
use super::loads::ModesOf;
use super::map::Place;
use super::mode_map::ModeMap;
use super::monitor::{self, Outcome};
use super::path::{NODES, Way};
use super::point::{Point, Prior};
use super::{Explained, Learner, Pending, Surroundings, order};
use crate::estimators::Sample;
use quell_trajectories::SampledTrajectory;

/// Fewest samples of a move for a fit: more than twice the unknowns of three modes.
pub(super) const FEWEST: usize = 64;
/// Factor by which the weight of a move's unexplained part falls with each later move.
const FORGETS: f64 = 0.5;
/// Largest inflation by the residual's colour that counts as white: a correlation of neighbours of 0.2.
const COLOURED: f64 = 1.5;

/// What explains a move.
pub(super) struct Explanation {
    /// Its fit.
    pub fit: Fit,
    /// Whose modes they are.
    pub modes_of: ModesOf,
    /// Logarithm of the odds that the inertia changes along the way, and not the stiffness, with this move.
    pub odds: f64,
}

impl Learner {
    /// Learns from the samples of a move, from its start until it has rung out, and its plan. `None` where too
    /// little vibrates.
    pub fn learn(
        &mut self,
        heard: &[Sample],
        plan: &SampledTrajectory,
        surroundings: &Surroundings,
    ) -> Option<Explained> {
        let pending = self.pending.take();
        let samples = in_order(heard);
        let way = Way::new(
            samples.first()?.motor_position,
            samples.last()?.motor_position,
        );
        if samples.len() < FEWEST {
            return None;
        }
        let places = self.places(&way, surroundings);
        let Some(explanation) = self.explain(&samples, way, &places) else {
            self.take(ModesOf::Nobody);
            self.unexplained = 1.0;
            return None;
        };
        let Explanation {
            fit,
            modes_of,
            odds,
        } = explanation;
        self.odds = odds;
        self.take(modes_of);
        self.keep(&fit, &self.loads.of_present(places));
        // The map that prescribed had another load: what its train leaves says nothing of the present one.
        if modes_of != ModesOf::AnotherLoad {
            self.watch(pending, &fit, way, (plan, &samples));
        }
        Some(Explained { fit, way })
    }

    /// Counts whose modes a move had, and forgets a map that has failed: the arm has changed, or is not described by modes.
    fn take(&mut self, modes_of: ModesOf) {
        if !self.modes.is_empty() {
            self.loads.take(modes_of);
        }
        if modes_of == ModesOf::Nobody {
            self.modes.clear();
        }
    }

    /// Adds a fit to the maps of its modes.
    fn keep(&mut self, fit: &Fit, places: &[Place; NODES]) {
        for (k, fitted) in fit.modes.iter().enumerate() {
            if k == self.modes.len() {
                // The spring of the lowest mode is the joint's. No description says how the other modes follow
                // the inertia.
                let log_w = fitted.point.log_w[1];
                let lowest = fit.modes.iter().all(|other| other.point.log_w[1] >= log_w);
                self.modes
                    .push(match lowest && self.settings.inertia.is_some() {
                        true => ModeMap::described(log_w, &places[1]),
                        false => ModeMap::new(log_w),
                    });
            }
            self.modes[k].learn(fitted, places);
        }
    }

    /// Cancels the prescription: its move is not made, or is another one.
    pub fn withdraw(&mut self) {
        self.pending = None;
    }

    /// The fit of a move, with the stiffness or the inertia changing along the way: which of them, all moves so far and this
    /// one decide.
    pub(super) fn explain(
        &self,
        samples: &[Sample],
        way: Way,
        places: &[Place; NODES],
    ) -> Option<Explanation> {
        let (likely, other) = self.causes(self.odds);
        let (fit, modes_of) = self.explain_by(likely, samples, way, places)?;
        let mut explanation = Explanation {
            odds: self.odds,
            fit,
            modes_of,
        };
        explanation.odds += self.odds_of(&explanation.fit, other, samples, way);
        if self.causes(explanation.odds).0 == other
            && let Some(better) = self.explain_by(other, samples, way, places)
        {
            (explanation.fit, explanation.modes_of) = better;
        }
        Some(explanation)
    }

    /// What the odds say, and the other.
    fn causes(&self, odds: f64) -> (Cause, Cause) {
        Cause::by_odds(odds, self.settings.inertia.is_some())
    }

    /// What a move adds to the odds: its modes are fitted with the other cause, from where they are.
    fn odds_of(&self, fit: &Fit, other: Cause, samples: &[Sample], way: Way) -> f64 {
        let mut problem = Problem::new(samples, way, fit.range, other);
        let start: Vec<Point> = fit.modes.iter().map(|mode| mode.point).collect();
        let priors: Vec<Prior> = fit.modes.iter().map(|mode| mode.prior).collect();
        let with_other = problem.fit(&start, &priors);
        // Where neither leaves only white noise, neither is what moves, and their ratio is no evidence.
        let with_other = with_other.filter(|other| other.inflation.min(fit.inflation) <= COLOURED);
        with_other.map_or(0.0, |with_other| {
            0.5 * fit.cause.sign() * order::evidence(fit, &with_other, samples)
        })
    }

    /// The fit of a move with one cause, and whose modes it has.
    fn explain_by(
        &self,
        cause: Cause,
        samples: &[Sample],
        way: Way,
        places: &[Place; NODES],
    ) -> Option<(Fit, ModesOf)> {
        let range = self.settings.natural_frequency.map(f64::ln);
        let range = (range[0], range[1]);
        let fit = |priors: &[Prior]| {
            let mut problem = Problem::new(samples, way, range, cause);
            order::explain(samples, &mut problem, priors)
        };
        let fit_at = |places: &[Place; NODES]| {
            let priors: Vec<Prior> = self.modes.iter().map(|mode| mode.prior(places)).collect();
            let any = !priors.is_empty();
            let found = any.then(|| fit(&priors)).flatten();
            found.filter(|found| self.is_theirs(found))
        };
        let known = fit_at(places);
        // Only white noise is left, and no mode had to be added: no other fit can be better.
        let is_enough =
            |fit: &Fit| fit.inflation <= COLOURED && fit.modes.len() == self.modes.len();
        if known.as_ref().is_some_and(is_enough) {
            return known.map(|fit| (fit, ModesOf::Map));
        }
        let Some(anew) = fit(&[]) else {
            return known.map(|fit| (fit, ModesOf::Map));
        };
        // The map stays unless the samples exclude it, or fewer modes explain them as well. A mode that has
        // shifted is still the same mode.
        let stays = |known: &Fit| {
            let fewer = anew.modes.len() < known.modes.len();
            let as_good = fewer && !order::excludes(known, &anew, samples);
            !as_good && !order::excludes(&anew, known, samples)
        };
        if let Some(known) = known.filter(stays) {
            return Some((known, ModesOf::Map));
        }
        let other = fit_at(&self.loads.another(places)).filter(stays);
        let other = other.map(|fit| (fit, ModesOf::AnotherLoad));
        Some(other.unwrap_or((anew, ModesOf::Nobody)))
    }

    /// Whether the modes of a fit are those of the map, and still oscillate.
    fn is_theirs(&self, fit: &Fit) -> bool {
        let theirs = self.modes.iter().zip(&fit.modes);
        (0..fit.modes.len()).all(|k| order::rings(fit, k))
            && !theirs
                .into_iter()
                .any(|(map, fitted)| map.is_surprised(fitted))
    }

    /// Compares the residual of a move with that of the other train.
    fn watch(
        &mut self,
        pending: Option<Pending>,
        fit: &Fit,
        way: Way,
        (plan, samples): (&SampledTrajectory, &[Sample]),
    ) {
        let modes: Vec<Expected> = fit.modes.iter().map(Expected::from).collect();
        let forecast = Forecast::new(plan, way, &modes).whole();
        let base = &self.settings.base;
        let adapted = pending.as_ref().map_or(base, |pending| &pending.adapted);
        let left = forecast.left_of(&[base, adapted]);
        let unshaped = left.unshaped().max(f64::MIN_POSITIVE);
        let unexplained = 2.0 * fit.unexplained() / (unshaped * unshaped);
        self.unexplained = (FORGETS * self.unexplained).max(unexplained).min(1.0);
        let Some(Pending { adapted, is_base }) = pending.filter(|one| one.adapted != *base) else {
            return;
        };
        let (amplitude, std) = monitor::ringing(samples, fit);
        let (measured, std) = (amplitude / unshaped, std / unshaped);
        let (base, adapted) = match is_base {
            true => (measured, left.by(&adapted)),
            false => (left.by(base), measured),
        };
        self.monitor.take(Outcome { base, adapted, std });
    }
}

/// The finite samples that advance in time.
pub(super) fn in_order(heard: &[Sample]) -> Vec<Sample> {
    let mut samples: Vec<Sample> = Vec::with_capacity(heard.len());
    for sample in heard.iter().filter(|sample| sample.is_finite()) {
        if samples.last().is_none_or(|last| sample.time > last.time) {
            samples.push(*sample);
        }
    }
    samples
}
