//! New linearisations: the decision for one, its replay of the window, and its acceptance.

use quell_shapers::Mode;

use super::fit::profile;
use super::region::trusted;
use super::{Likelihood, Track};

/// Samples that replays may take in one tick.
const REPLAY_BUDGET: usize = 128;

impl Likelihood {
    /// Keeps the younger half of a full window and replays it from its own first sample.
    pub(super) fn slide(&mut self) {
        let half = self.window.samples().len() / 2;
        self.window.drop_oldest(half);
        self.start_candidate(self.active.mode);
        self.must_replace = true;
        // The active track keeps its old sums; only its place in the window has moved.
        self.active.walk.count -= half;
        self.locked = true;
    }

    fn start_candidate(&mut self, mode: Mode) {
        self.candidate = Some(Track::new(mode, self.settings.sample_time));
    }

    /// Iterates: new linearisations as long as the step matters and the tick's budget lasts.
    pub(super) fn relinearise(&mut self) {
        let mut budget = REPLAY_BUDGET;
        while budget > 0 {
            if self.candidate.is_none() && !self.propose() {
                return;
            }
            let folding = self.folding();
            let Some(candidate) = &mut self.candidate else {
                return;
            };
            let length = self.window.samples().len();
            while budget > 0 && candidate.walk.count < length {
                candidate.absorb(&self.window, &folding);
                budget -= 1;
            }
            if candidate.walk.count < length {
                return;
            }
            self.judge();
        }
    }

    /// Starts a candidate at the end of the step, if the step matters. A step `d` of `lambda / w` causes an
    /// error of `d^2 / 2` times the phase of the vibration until it has decayed. More than a tenth of a
    /// standard deviation of that is too much.
    fn propose(&mut self) -> bool {
        let Some(fit) = &self.fit else { return false };
        // At the edge of the range the step may lead to no mode.
        let from = self.active.point;
        let to = self.region.nearest(trusted(from, fit.step, 1.0));
        let [x, y] = [0, 1].map(|k| to[k] - from[k]);
        let missed = 0.5 * (x * x + y * y) * self.phase();
        let least = fit.variances[0].min(fit.variances[1]);
        let negligible = x.abs() < 1e-9 && y.abs() < 1e-9;
        let exact = missed * missed <= 0.01 * least * self.noise.variance;
        if negligible || exact || self.shrink < 1e-3 {
            return false;
        }
        let next = self.region.mode(trusted(from, fit.step, self.shrink));
        let Some(next) = next.filter(|&next| next != self.active.mode) else {
            return false;
        };
        self.start_candidate(next);
        true
    }

    /// Phase of the vibration, rad: over the window, or over a time constant of its envelope.
    fn phase(&self) -> f64 {
        let mode = self.active.mode;
        (mode.natural_frequency() * self.elapsed())
            .min(mode.damping_ratio().recip())
            .max(1.0)
    }

    /// Accepts a candidate that has caught up, if it explains the data better.
    fn judge(&mut self) {
        let Some(candidate) = self.candidate.take() else {
            return;
        };
        let priors = self.priors();
        let cost = profile(&candidate, &priors, self.noise.variance).unwrap_or(f64::INFINITY);
        let present = self.fit.as_ref().map_or(f64::INFINITY, |fit| fit.cost);
        if self.must_replace || cost <= present {
            self.must_replace = false;
            self.active = candidate;
            self.shrink = (4.0 * self.shrink).min(1.0);
            self.refit();
        } else {
            self.shrink *= 0.25;
        }
    }
}
