//! From an estimate to a train, at rest or in motion.

use quell_shapers::{GridTrain, Mode, Refusal, Retune, RetuneOutcome, Setpoint, UncertainMode};

use super::ahead::Ahead;
use super::axis::{Axis, waiting};
use super::settings::{RetunePolicy, motion_limits};
use crate::adaptation::{Decision, Reason, residual};
use crate::estimators::Estimate;

/// Length of the shortest correction, periods: five smooth steps of a quarter period.
const SHORTEST_CORRECTION: f64 = 1.25;

impl Axis {
    /// Acts on the present estimate, if it is worth it.
    pub(super) fn adapt(&mut self, ahead: &Ahead<'_>) {
        let (Some(mut estimate), Some(shaper)) = (self.status.estimate, self.settings.shaper)
        else {
            return;
        };
        // Once the plan has ended there is little more to learn: what is certain enough for the
        // adaptation is used then, settled or not.
        estimate.converged |= self.settings.estimator.states_error
            && ahead.remaining() == 0
            && loses_energy(&estimate);
        if let Err(reason) = self.adaptation.screen(&estimate) {
            self.status.decision = Some(Decision::Keep(reason));
            return;
        }
        // The steps of a correction are a quarter period apart: more often gains nothing, and a train that
        // is solved numerically costs. Counted by the axis' own time, since a frozen estimate does not advance.
        if self.time - self.last_considered < 0.25 * estimate.mode.damped_period() {
            return;
        }
        self.last_considered = self.time;
        let known = self.known(&estimate);
        let next = match self.has_shortest_for(&estimate) {
            true => Ok(self.next_train().clone()),
            false => shaper.on_grid_for(&known, self.settings.sample_time),
        };
        // By reference, here and below: a train has 4 KiB.
        self.status.decision = Some(match &next {
            Ok(next) => self.judge(&estimate, &known, next, ahead),
            Err(_) => Decision::Keep(Reason::Implausible(estimate.mode)),
        });
    }

    /// How well the mode of an estimate is known: where the method states no error, no better than a belief.
    fn known(&self, estimate: &Estimate) -> UncertainMode {
        match self.settings.estimator.states_error {
            true => self.adaptation.known(estimate),
            false => UncertainMode::believed(estimate.mode),
        }
    }

    fn judge(
        &mut self,
        estimate: &Estimate,
        known: &UncertainMode,
        next: &GridTrain,
        ahead: &Ahead<'_>,
    ) -> Decision {
        let decision = match self.settings.retune {
            RetunePolicy::InMotion if self.lane.is_none() && self.is_ringing(estimate.mode) => {
                self.consider_in_motion(estimate, known, next, ahead)
            }
            _ => self.consider_at_rest(estimate, known, next),
        };
        match decision {
            // What is left is no reason for another train, but the delay is.
            Decision::Keep(Reason::DeadBand(_))
                if self.is_much_shorter(next, known.mode) && self.install(next, known) =>
            {
                Decision::Accept(known.mode)
            }
            _ => decision,
        }
    }

    /// Whether the next train does for an estimate, and none could be shorter by much: positive impulses need half
    /// a period. Nothing has to be designed then.
    fn has_shortest_for(&self, estimate: &Estimate) -> bool {
        let next = self.next_train();
        next.duration() < 0.75 * estimate.mode.damped_period()
            && self.adaptation.suits(next, estimate)
    }

    /// Whether a train saves delay: trains for a mode that is known well and for one that is not are half
    /// periods apart, and half of that is no rounding of theirs.
    fn is_much_shorter(&self, next: &GridTrain, mode: Mode) -> bool {
        next.duration() + 0.25 * mode.damped_period() < self.next_train().duration()
    }

    /// Whether anything is moving, or may still ring.
    fn is_ringing(&self, mode: Mode) -> bool {
        !self.filter.is_settled() || self.since_plan_end < ringing_time(mode)
    }

    fn consider_at_rest(
        &mut self,
        estimate: &Estimate,
        known: &UncertainMode,
        next: &GridTrain,
    ) -> Decision {
        let waiting = waiting(self.lane.as_ref(), &self.filter);
        let best = residual(next, known.mode);
        let excess = |mode| residual(waiting, mode) - best;
        let decision = self.adaptation.consider(estimate, next, excess);
        if let Decision::Accept(_) = decision {
            self.install(next, known);
        }
        decision
    }

    fn consider_in_motion(
        &mut self,
        estimate: &Estimate,
        known: &UncertainMode,
        next: &GridTrain,
        ahead: &Ahead<'_>,
    ) -> Decision {
        let (remaining, planned) = (ahead.remaining(), |k: usize| ahead.setpoint(k - 1));
        let tick = self.settings.sample_time;
        let train = self.filter.train().duration();
        let since_end = match remaining {
            0 => self.since_plan_end,
            ticks => -(ticks as f64) * tick,
        };
        // Rounding of the encoder: a vibration below it cannot be told from none.
        let rounding = self.settings.rest.quantisation / 12f64.sqrt();
        let filter = &mut self.filter;
        // A correction can leave nothing, but not before it is over: what is left is seen there.
        let excess = |mode: Mode| match filter.forecast(mode, remaining, planned) {
            Ok(residual) => {
                let soonest = since_end + SHORTEST_CORRECTION * mode.damped_period();
                let seen = train.max(soonest);
                let decayed = |time: f64| (-mode.decay_rate() * time).exp();
                match residual.shaped * decayed(seen - since_end) > rounding {
                    true => residual.ratio() * decayed(seen),
                    false => 0.0,
                }
            }
            Err(_) => f64::INFINITY,
        };
        let decision = self.adaptation.consider(estimate, next, excess);
        if let Decision::Accept(_) = decision {
            self.correct(next, known, remaining, planned);
        }
        decision
    }

    /// Cancels what the present command would leave, and goes over to a train for the mode if the
    /// one in force is worse by more than the dead band. Where no correction keeps the limits, the
    /// train waits for rest.
    fn correct(
        &mut self,
        next: &GridTrain,
        known: &UncertainMode,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) {
        let (present, mode) = (self.next_train(), known.mode);
        let excess = residual(present, mode) - residual(next, mode);
        let changes = excess >= self.settings.adaptation.dead_band;
        let train = if changes { next } else { present }.clone();
        match self.cancel(&train, mode, remaining, planned) {
            Ok(()) if changes => self.changed(known),
            Err(_) if changes => {
                self.install(&train, known);
            }
            _ => {}
        }
    }

    /// Cancels what the present command would leave of a mode.
    fn cancel(
        &mut self,
        train: &GridTrain,
        mode: Mode,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<(), Refusal> {
        let request = Retune {
            train,
            modes: &[mode],
            limits: motion_limits(self.settings.limits),
        };
        match self.filter.retune(&request, remaining, planned) {
            RetuneOutcome::Refused(refusal) => {
                self.status.refused += 1;
                return Err(refusal);
            }
            RetuneOutcome::Corrected(correction) => {
                self.status.correction = Some(correction);
                self.status.corrections += 1;
                self.corrected = mode;
            }
            RetuneOutcome::Installed => {}
        }
        Ok(())
    }

    /// A correction was made for another plan: with the new one it would leave the wrong vibration,
    /// and could exceed the limits. Where no other keeps them either, nothing is changed.
    pub(super) fn follow(&mut self, ahead: &Ahead<'_>) -> Result<(), Refusal> {
        if !self.filter.is_correcting() {
            return Ok(());
        }
        let train = self.next_train().clone();
        let planned = |k: usize| ahead.setpoint(k - 1);
        self.cancel(&train, self.corrected, ahead.remaining(), planned)
    }

    /// Whether the train is taken: it then takes over once the command stands still.
    fn install(&mut self, train: &GridTrain, known: &UncertainMode) -> bool {
        let taken = match &mut self.lane {
            Some(lane) => lane.wait_with(train),
            None => self.filter.install(train).is_ok(),
        };
        if taken {
            self.changed(known);
        }
        taken
    }

    fn changed(&mut self, known: &UncertainMode) {
        self.status.shaped_for = *known;
        self.status.retunes += 1;
    }
}

/// Whether two standard deviations exclude that the mode is undamped. Every joint loses energy; a fit
/// that stops at no damping follows something else, as a sensor on the wrong wire shows it, and the
/// standard deviation of a maximum on the edge of its range is not that of its error.
fn loses_energy(estimate: &Estimate) -> bool {
    estimate.mode.damping_ratio() > 2.0 * estimate.damping_ratio_std
}

/// How long a mode rings after the last command, s: five time constants of its envelope leave less than
/// the dead band of 1 %.
pub fn ringing_time(mode: Mode) -> f64 {
    5.0 / mode.decay_rate()
}
