//! From an estimate to a train, at rest or in motion.

use quell_shapers::{GridTrain, Mode, Refusal, Retune, RetuneOutcome, Setpoint, Shaper};

use super::ahead::Ahead;
use super::axis::{Axis, waiting};
use super::settings::{RetunePolicy, motion_limits};
use crate::adaptation::Decision;
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
        let decision = match self.settings.retune {
            RetunePolicy::InMotion if self.lane.is_none() && self.is_ringing(estimate.mode) => {
                // The steps of a correction are a quarter period apart: more often gains nothing.
                // Counted by the axis' own time, since a frozen estimate does not advance.
                let pause = 0.25 * estimate.mode.damped_period();
                if estimate.converged && self.time - self.last_forecast < pause {
                    return;
                }
                if estimate.converged {
                    self.last_forecast = self.time;
                }
                self.consider_in_motion(&estimate, shaper, ahead)
            }
            _ => self.consider_at_rest(&estimate, shaper),
        };
        self.status.decision = Some(decision);
    }

    /// Whether anything is moving, or may still ring.
    fn is_ringing(&self, mode: Mode) -> bool {
        !self.filter.is_settled() || self.since_plan_end < ringing_time(mode)
    }

    fn consider_at_rest(&mut self, estimate: &Estimate, shaper: &dyn Shaper) -> Decision {
        let tick = self.settings.sample_time;
        let waiting = waiting(self.lane.as_ref(), &self.filter);
        let excess = |mode| excess_of(waiting, shaper, mode, tick);
        let decision = self.adaptation.consider(estimate, shaper, excess);
        if let Decision::Accept(mode) = decision
            && let Ok(train) = shaper.on_grid(mode, tick)
        {
            self.install(&train, mode);
        }
        decision
    }

    fn consider_in_motion(
        &mut self,
        estimate: &Estimate,
        shaper: &dyn Shaper,
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
        let decision = self.adaptation.consider(estimate, shaper, excess);
        if let Decision::Accept(mode) = decision
            && let Ok(train) = shaper.on_grid(mode, tick)
        {
            self.correct(&train, mode, shaper, remaining, planned);
        }
        decision
    }

    /// Cancels what the present command would leave, and goes over to a train for the mode if the
    /// one in force is worse by more than the dead band. Where no correction keeps the limits, the
    /// train waits for rest.
    fn correct(
        &mut self,
        designed: &GridTrain,
        mode: Mode,
        shaper: &dyn Shaper,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) {
        let present = self.next_train();
        let tick = self.settings.sample_time;
        let excess = excess_of(present, shaper, mode, tick);
        let changes = excess >= self.settings.adaptation.dead_band;
        let train = if changes {
            designed.clone()
        } else {
            present.clone()
        };
        match self.cancel(&train, mode, remaining, planned) {
            Ok(()) if changes => self.changed(mode),
            Err(_) if changes => self.install(&train, mode),
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

    fn install(&mut self, train: &GridTrain, mode: Mode) {
        let taken = match &mut self.lane {
            Some(lane) => lane.wait_with(train),
            None => self.filter.install(train).is_ok(),
        };
        if taken {
            self.changed(mode);
        }
    }

    fn changed(&mut self, mode: Mode) {
        self.status.mode = mode;
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

/// V of a train at a mode beyond that of the train designed for it.
fn excess_of(train: &GridTrain, shaper: &dyn Shaper, mode: Mode, sample_time: f64) -> f64 {
    let left = |train: &GridTrain| {
        train.residual_vibration(mode.natural_frequency(), mode.damping_ratio())
    };
    match &shaper.on_grid(mode, sample_time) {
        Ok(best) => left(train) - left(best),
        Err(_) => f64::INFINITY,
    }
}
