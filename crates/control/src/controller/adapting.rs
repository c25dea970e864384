//! From an estimate to a train, at rest or in motion.

use quell_shapers::{GridTrain, Mode, Refusal, Retune, RetuneOutcome, UncertainMode};

use super::ahead::Ahead;
use super::axis::{Axis, waiting};
use super::corrected::Corrected;
use super::settings::{RetunePolicy, motion_limits};
use crate::adaptation::{Decision, Reason, residual};
use crate::estimators::Estimate;

impl Axis {
    /// Acts on the present estimate, if it is worth it.
    pub(super) fn adapt(&mut self, ahead: &Ahead<'_>) {
        let (Some(mut estimate), Some(shaper)) = (self.status.estimate, self.settings.shaper)
        else {
            return;
        };
        if let Some(hold) = self.hold {
            self.status.decision = Some(Decision::Keep(Reason::Held(hold)));
            return;
        }
        // After the end of the plan little more can be learned. An estimate that is certain enough for the
        // adaptation is then used, even if it has not converged.
        estimate.converged |= self.settings.estimator.states_error
            && ahead.remaining() == 0
            && loses_energy(&estimate);
        if let Err(reason) = self.adaptation.screen(&estimate) {
            self.status.decision = Some(Decision::Keep(reason));
            return;
        }
        // The steps of a correction are a quarter period apart, so that a higher rate gains nothing, and a
        // numerical solution of a train is expensive. The axis' own time counts, since a frozen estimate does
        // not advance.
        if self.time - self.last_considered < 0.25 * estimate.mode.damped_period() {
            return;
        }
        self.last_considered = self.time;
        if let Some(unexplained) = self.unexplained(estimate.mode) {
            self.status.decision = Some(Decision::Keep(Reason::Unexplained(unexplained)));
            return;
        }
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

    /// The part of the unshaped vibration that one mode leaves unexplained, if that is more than the train in
    /// force leaves of the mode: a train for it would then remove less than the unexplained part.
    fn unexplained(&mut self, mode: Mode) -> Option<f64> {
        // The unshaped vibration decays, and the phases of a move may cancel: the largest value of the move
        // counts.
        let unshaped = self.filter.residual(mode)?.unshaped;
        self.unshaped = self.unshaped.max(unshaped);
        let unexplained = self.estimator.unexplained() / self.unshaped.max(f64::MIN_POSITIVE);
        let in_force = residual(self.next_train(), mode);
        (unexplained > in_force).then_some(unexplained)
    }

    /// How well the mode of an estimate is known. If the method states no error, it counts as a belief.
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
        let in_motion = self.settings.retune == RetunePolicy::InMotion
            && self.lane.is_none()
            && self.is_ringing(estimate.mode);
        if in_motion && let Some(decision) = self.correct(estimate, known, next, ahead) {
            return decision;
        }
        match self.consider_at_rest(estimate, known, next) {
            // The residual is no reason for another train, but a shorter delay is.
            Decision::Keep(Reason::DeadBand(_))
                if self.is_much_shorter(next, known.mode) && self.install(next, known) =>
            {
                Decision::Accept(known.mode)
            }
            decision => decision,
        }
    }

    /// Whether the next train suits an estimate, and no train is much shorter: positive impulses need half a
    /// period. Then no train has to be designed.
    fn has_shortest_for(&self, estimate: &Estimate) -> bool {
        let next = self.next_train();
        next.duration() < 0.75 * estimate.mode.damped_period()
            && self.adaptation.suits(next, estimate)
    }

    /// Whether a train saves delay. Trains for well-known and poorly known modes differ in length by half
    /// periods; half of that is well above their rounding to the grid.
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

    /// Corrects the command under way, if that removes more vibration over the rest of the move than it adds.
    /// Changes to a train for the mode if the one in force is worse by more than the dead band.
    fn correct(
        &mut self,
        estimate: &Estimate,
        known: &UncertainMode,
        next: &GridTrain,
        ahead: &Ahead<'_>,
    ) -> Option<Decision> {
        // A correction under way is replaced only for an estimate that differs by more than its own error.
        let corrects_for_it =
            self.filter.is_correcting() && self.corrected.suffices_for(estimate.mode);
        if corrects_for_it || !self.adaptation.may_correct(estimate, next) {
            return None;
        }
        let present = self.next_train();
        let excess = residual(present, known.mode) - residual(next, known.mode);
        let changes = excess >= self.settings.adaptation.dead_band;
        let train = if changes { next } else { present }.clone();
        let modes = [*known];
        let request = self.request(&train, &modes);
        let planned = |k: usize| ahead.setpoint(k - 1);
        match self.filter.retune(&request, ahead.remaining(), planned) {
            RetuneOutcome::Refused(Refusal::NotWorth(_)) => return None,
            RetuneOutcome::Refused(_) => {
                self.status.refused += 1;
                return None;
            }
            RetuneOutcome::Corrected(correction) => {
                self.changes += 1;
                self.status.correction = Some(correction);
                self.status.corrections += 1;
                self.corrected = Corrected::of(&[*known]);
            }
            RetuneOutcome::Installed => {}
        }
        if changes {
            self.changed(known);
        }
        Some(self.adaptation.accept(known.mode))
    }

    /// As [`super::Controller::retune`].
    pub(super) fn retune(
        &mut self,
        train: &GridTrain,
        known: &UncertainMode,
        modes: &[UncertainMode],
        ahead: &Ahead<'_>,
    ) -> RetuneOutcome {
        if self.lane.is_some() {
            // The trains of a kept path belong to all axes.
            return RetuneOutcome::Refused(Refusal::Busy);
        }
        let request = self.request(train, modes);
        let planned = |k: usize| ahead.setpoint(k - 1);
        let outcome = self.filter.retune(&request, ahead.remaining(), planned);
        self.retuned(outcome, known, modes);
        outcome
    }

    /// Records the outcome of a retune: a new train for a mode and a correction for modes, or a refusal.
    pub(super) fn retuned(
        &mut self,
        outcome: RetuneOutcome,
        known: &UncertainMode,
        modes: &[UncertainMode],
    ) {
        self.changes += 1;
        match outcome {
            // It would leave no less, or another change came first.
            RetuneOutcome::Refused(Refusal::NotWorth(_) | Refusal::Busy) => {}
            RetuneOutcome::Refused(_) => self.status.refused += 1,
            RetuneOutcome::Installed => self.status.shaped_for = *known,
            RetuneOutcome::Corrected(correction) => {
                self.status.correction = Some(correction);
                self.status.corrections += 1;
                self.status.shaped_for = *known;
                self.corrected = Corrected::of(modes);
            }
        }
    }

    fn request<'a>(&self, train: &'a GridTrain, modes: &'a [UncertainMode]) -> Retune<'a> {
        Retune {
            train,
            modes,
            limits: motion_limits(self.settings.limits),
            dead_band: self.settings.adaptation.dead_band,
            resolution: self.resolution(),
        }
    }

    /// Rounding of the encoder, rad: a vibration below it cannot be told from none.
    pub(super) fn resolution(&self) -> f64 {
        self.settings.rest.quantisation / 12f64.sqrt()
    }

    /// Prepares for a move from rest: the mode may have changed since the last one, for example by a payload.
    ///
    /// The memory of the last move would be replayed with the new mode, and a vibration cancelled that does not
    /// exist. It is forgotten if less than the dead band is left according to the last mode.
    pub(super) fn begin_from_rest(&mut self) {
        if self.has_died() {
            self.filter.forget();
        }
        self.begin_move();
    }

    /// Whether less than the dead band is left of the unshaped vibration, according to the mode that was
    /// estimated last.
    fn has_died(&self) -> bool {
        let estimate = self.status.estimate.as_ref();
        let estimate = estimate.filter(|found| self.adaptation.screen(found).is_ok());
        let mode = estimate.map_or(self.status.shaped_for.mode, |found| found.mode);
        if self.since_plan_end > ringing_time(mode) {
            return true;
        }
        let left = self.filter.residual(mode);
        let dead_band = self.settings.adaptation.dead_band;
        left.is_none_or(|left| left.shaped <= dead_band * left.unshaped.max(self.unshaped))
    }

    /// Adapts a correction to a new plan: with that it could leave another vibration and exceed the limits. If
    /// no correction keeps them, nothing is changed.
    pub(super) fn follow(&mut self, ahead: &Ahead<'_>) -> Result<(), Refusal> {
        if !self.filter.is_correcting() {
            return Ok(());
        }
        let (train, corrected) = (self.next_train().clone(), self.corrected);
        let request = self.request(&train, corrected.modes());
        let planned = |k: usize| ahead.setpoint(k - 1);
        self.filter.replan(&request, ahead.remaining(), planned)?;
        self.corrected = corrected.replanned();
        Ok(())
    }

    /// Whether the train was accepted; it takes over once the command stands still.
    fn install(&mut self, train: &GridTrain, known: &UncertainMode) -> bool {
        let taken = match &mut self.lane {
            Some(lane) => lane.wait_with(train),
            None => self.filter.install(train).is_ok(),
        };
        if taken {
            self.changes += 1;
            self.changed(known);
        }
        taken
    }

    fn changed(&mut self, known: &UncertainMode) {
        self.status.shaped_for = *known;
        self.status.retunes += 1;
    }
}

/// Whether two standard deviations exclude zero damping. Every joint loses energy: a fit with zero damping
/// follows another signal, for example of a miswired sensor. The standard deviation of a maximum at the edge of
/// its range is not that of its error.
fn loses_energy(estimate: &Estimate) -> bool {
    estimate.mode.damping_ratio() > 2.0 * estimate.damping_ratio_std
}

/// How long a mode rings after the last command, s: five time constants of its envelope leave less than
/// the dead band of 1 %.
pub fn ringing_time(mode: Mode) -> f64 {
    5.0 / mode.decay_rate()
}
