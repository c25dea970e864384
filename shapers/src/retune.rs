//! Changing the train in motion: cross-fade and replay correction.

use crate::adaptive_filter::AdaptiveFilter;
use crate::candidates::{Change, Known};
use crate::correction::{CORRECTED_MODES, Order};
use crate::history::Entry;
use crate::replay::Choice;
use crate::vibration::{energy, largest};
use crate::{Buffer, Correction, Refusal, Retune, RetuneOutcome, Setpoint};
use num_traits::Float;

impl<S: Buffer<Setpoint>, E: Buffer<Entry>> AdaptiveFilter<S, E> {
    /// Goes over to another train in motion, and cancels the vibration that the wrong one has left in the given
    /// modes.
    ///
    /// `planned(k)` is the input at the `k`-th tick from now, `1 <= k <= remaining`; after that it
    /// stays where it is. The output is simulated ahead with a cross-fade to the new train. What everything
    /// sent and to be sent will leave, `phi = sum du_k exp(-lambda t_k)`, `lambda = -xi omega + j omega_d`, differs by
    /// `d` from what is wanted: what the new train leaves of everything planned up to now, or nothing at all.
    /// `N` smooth steps that begin at once, a quarter period of one of the modes apart, take the difference away; their amplitudes are
    /// the smallest (least norm) with
    ///
    /// ```text
    /// sum c_i = 0,    sum c_i S exp(-lambda t_i) = -d
    /// ```
    ///
    /// where `S` is the contribution of one step. The derivative of both sides by `lambda` may be matched, too, so
    /// that an error of the estimate counts only squared. The joint must have been at rest at the last
    /// [`AdaptiveFilter::reset`]; the plant between command and mode may be any linear one, because it
    /// multiplies `phi` by a constant.
    ///
    /// Of all ways (cross-fades of several lengths or none, no correction, more and wider steps, with the derivative or
    /// without) that is taken which leaves the least vibration over the rest of the move and its decay, `int E |psi|^2
    /// dt`, expected over the error of the modes ([`crate::UncertainMode`]; module `vibration` says what `psi` is).
    /// Nothing is changed where that is not less than what the present command makes, by the square of the dead band
    /// of what the planned input would make unshaped; or where the envelope would at any time exceed that of the
    /// present command, within half a period, by more than the dead band of the largest that the planned input leaves. Position, velocity and acceleration stay continuous; velocity, acceleration and jerk stay
    /// within the limits. So a plan that leaves nothing of its limits free is corrected where it does not
    /// need them.
    ///
    /// It may be called again at any time, with a better estimate, or once a refused correction has become
    /// possible. Steps that have begun run to their end; the others are replaced (or, if the limits cannot be
    /// kept without them, extended). After the end of the command it cancels the remaining vibration.
    ///
    /// No allocation. Cost: the horizon, 6 times the remaining ticks times the taps, and up to 60 corrections
    /// a mode, of at most 7 periods; most are discarded early.
    pub fn retune(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> RetuneOutcome {
        match self.try_retune(request, remaining, planned) {
            Ok(outcome) => outcome,
            Err(refusal) => RetuneOutcome::Refused(refusal),
        }
    }

    /// Computes the correction under way again for another plan, or keeps it if it leaves less vibration: with
    /// the new plan the old one may leave some, or exceed the limits.
    ///
    /// # Errors
    /// [`Refusal::Limits`] where the new plan keeps the limits with no correction, and what else
    /// [`AdaptiveFilter::retune`] refuses; nothing has changed then.
    pub fn replan(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<(), Refusal> {
        let known = self.known(request)?;
        self.load(remaining, planned)?;
        let present = self.present(request, remaining, &known)?;
        let energy = |choice: &Result<Choice, Refusal>| {
            choice
                .as_ref()
                .map_or(f64::INFINITY, |choice| choice.energy)
        };
        let anew = self.best(request, remaining, &known, &present, true);
        let kept = self.best(request, remaining, &known, &present, false);
        let choice = if energy(&anew) < energy(&kept) {
            anew
        } else {
            kept
        };
        self.apply(request, remaining, &known, &choice?)?;
        Ok(())
    }

    fn try_retune(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<RetuneOutcome, Refusal> {
        self.check(request.train).map_err(Refusal::Invalid)?;
        request.limits.check().map_err(Refusal::Invalid)?;
        if !(1..=CORRECTED_MODES).contains(&request.modes.len()) {
            return Err(Refusal::Modes(request.modes.len()));
        }
        let known = self.known(request)?;
        let still = remaining == 0 && self.is_settled();
        if still && known.sent.iter().all(|state| state.value.norm() == 0.0) {
            self.install(request.train).map_err(Refusal::Invalid)?;
            return Ok(RetuneOutcome::Installed);
        }
        self.load(remaining, planned)?;
        let present = self.present(request, remaining, &known)?;
        if largest(&present.profiles) <= request.resolution {
            return Err(Refusal::NotWorth(0.0));
        }
        let before = energy(&present.profiles);
        let unshaped = present.unshaped;
        let gain = |energy: f64| Float::sqrt((before - energy).max(0.0) / unshaped);
        if gain(0.0) <= request.dead_band {
            return Err(Refusal::NotWorth(gain(0.0)));
        }
        let choice = self
            .best(request, remaining, &known, &present, true)
            .or_else(|_| self.best(request, remaining, &known, &present, false))?;
        let gain = gain(choice.energy);
        if gain.is_nan() || gain <= request.dead_band {
            return Err(Refusal::NotWorth(gain));
        }
        self.apply(request, remaining, &known, &choice)
    }

    fn apply(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        known: &Known,
        choice: &Choice,
    ) -> Result<RetuneOutcome, Refusal> {
        let Choice {
            plan,
            fade,
            superseded,
            ..
        } = choice;
        let (mut schedule, total) = self.going_on(*superseded);
        let change = Change {
            train: request.train,
            fade: *fade,
            schedule: &schedule,
        };
        let rest = self.simulate(Some(change), remaining)?;
        let span = plan.map_or(0, |plan| plan.comb.span());
        let end = rest.max(span);
        let forecast = self.forecast_of(request, (remaining, rest), known, (&change, total), None);
        let peaks = forecast.peaks(plan.as_ref(), end);
        if let Some(plan) = plan {
            schedule.extend(plan.comb.steps(&plan.amplitudes));
        }
        let seconds = |ticks: usize| ticks as f64 * self.sample_time;
        let correction = Correction {
            cross_fade: seconds(*fade),
            duration: seconds(span),
            steps: plan.map_or(0, |plan| plan.comb.count),
            until_rest: seconds(end),
            robust: plan.is_some_and(|plan| plan.order == Order::Slope),
            peaks,
        };
        let switches = self.can_switch(request.train);
        let waits = *fade == 0 && !switches && request.train != self.fade.last();
        self.schedule = schedule;
        if switches {
            self.fade.replace(request.train);
        } else if *fade > 0 {
            self.fade.fade_in(request.train, self.tick, *fade);
        }
        self.pending = waits.then(|| request.train.clone());
        self.pending_from = self.tick + remaining as u64;
        Ok(RetuneOutcome::Corrected(correction))
    }
}
