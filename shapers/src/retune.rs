//! Changing the train in motion: cross-fade and replay correction.

use crate::adaptive_filter::AdaptiveFilter;
use crate::ahead::Ahead;
use crate::correction::{CORRECTED_MODES, Order, Schedule};
use crate::cross_fade::{CrossFade, Trains};
use crate::history::Entry;
use crate::modal_state::{ModalState, pole, pole_variance};
use crate::replay::{Choice, Each, Forecast, Present};
use crate::vibration::{Meter, Profile, energy, largest, quarter};
use crate::{Buffer, Correction, GridTrain, Refusal, Retune, RetuneOutcome, Setpoint};
use num_traits::Float;

/// Lengths of the cross-fades that are tried, damped periods; 0 keeps the old train to the end.
const FADES: [f64; 3] = [1.0, 2.0, 0.0];

/// What is known of the modes before a choice is made.
struct Known {
    meters: Each<Meter>,
    /// What everything planned, and everything sent, has left of each.
    planned: Each<ModalState>,
    sent: Each<ModalState>,
}

/// A change of the train in motion.
#[derive(Clone, Copy)]
struct Change<'a> {
    train: &'a GridTrain,
    /// Length of the cross-fade, ticks; 0 keeps the trains at work, unless the line is constant.
    fade: usize,
    /// The earlier corrections as they go on.
    schedule: &'a Schedule,
}

impl<'a> Change<'a> {
    /// The trains of the ticks after `tick`, over those at work.
    fn trains(&self, present: &'a CrossFade, switches: bool, tick: u64) -> Trains<'a> {
        match self.fade {
            _ if switches => Trains::Switched(self.train),
            0 => Trains::AsTheyAre(present),
            ticks => Trains::Fading(present, self.train, tick, ticks),
        }
    }
}

impl<S: Buffer<Setpoint>, E: Buffer<Entry>> AdaptiveFilter<S, E> {
    /// Goes over to another train in motion, and takes away what the wrong one has left of the given modes.
    ///
    /// `planned(k)` is the input at the `k`-th tick from now, `1 <= k <= remaining`; after that it
    /// stays where it is. The output is simulated ahead with a cross-fade to the new train. What everything
    /// sent and to be sent will leave, `phi = sum du_k exp(-lambda t_k)`, `lambda = -xi omega + j omega_d`, differs by
    /// `d` from what is wanted: what the new train leaves of everything planned up to now, or nothing at all.
    /// `N` smooth steps that begin at once, a quarter period apart, take the difference away; their amplitudes are
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
    /// May be called again at any time, with a better estimate, or as what was not possible has become so: steps that
    /// have begun run to their end, the others are replaced (or, if the limits cannot be kept without them,
    /// added to). After the end of the command it cancels what still rings.
    ///
    /// No allocation. Cost: the horizon, 6 times the remaining ticks times the taps, and up to 120 corrections
    /// of at most 7 periods; most are discarded early.
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

    /// Makes the correction under way anew for another plan, or keeps it where it leaves less vibration: with the
    /// new plan the old one may leave some, or exceed the limits.
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
        if still && known.sent.iter().all(|state| state.value.abs() == 0.0) {
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

    fn known(&self, request: &Retune<'_>) -> Result<Known, Refusal> {
        let (mut meters, mut planned, mut sent) = (Each::new(), Each::new(), Each::new());
        let poles = request
            .modes
            .iter()
            .map(|known| pole(known.mode, self.sample_time));
        let quarter = poles.map(quarter).next().unwrap_or(1);
        for known in request.modes {
            let pole = pole(known.mode, self.sample_time);
            let variance = pole_variance(known, self.sample_time);
            let states = self.history.states(pole).ok_or(Refusal::HistoryLost)?;
            meters.push(Meter::new(pole, variance, self.sample_time, quarter));
            planned.push(states[0]);
            sent.push(states[1]);
        }
        Ok(Known {
            meters,
            planned,
            sent,
        })
    }

    /// The vibration of the command as it goes on now, and of the planned input as it is.
    fn present(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        known: &Known,
    ) -> Result<Present, Refusal> {
        let rest = self.simulate(None, remaining)?;
        let exact: Each<Meter> = known.meters.iter().map(Meter::exact).collect();
        let change = Change {
            train: self.fade.last(),
            fade: 0,
            schedule: &self.schedule,
        };
        let forecast = Forecast {
            meters: &exact,
            ..self.forecast_of(request, (remaining, rest), known, (&change, 0.0), None)
        };
        let unshaped = self.unshaped(remaining, known, &exact);
        Ok(Present {
            profiles: forecast.profiles(None),
            unshaped: energy(&unshaped),
            slack: request.dead_band * largest(&unshaped),
        })
    }

    /// The vibration of the planned input as it is.
    fn unshaped(&self, remaining: usize, known: &Known, meters: &[Meter]) -> Each<Profile> {
        let input = &self.planned[..remaining];
        let now = self.line.at(0);
        let rest = Setpoint::at_rest(input.last().unwrap_or(&now).position);
        let sent = |k: usize| {
            let input = input.get(k - 1).copied().unwrap_or(rest);
            (input, input.acceleration)
        };
        let each = meters.iter().zip(&known.planned);
        each.map(|(meter, state)| meter.profile(*state, now, remaining, sent))
            .collect()
    }

    /// Copies the planned input into the scratch.
    fn load(
        &mut self,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<(), Refusal> {
        let horizon = self.planned.len();
        let Some(slots) = self.planned.get_mut(..remaining) else {
            return Err(Refusal::Horizon {
                needed: remaining,
                horizon,
            });
        };
        for (k, slot) in slots.iter_mut().enumerate() {
            *slot = planned(k + 1);
        }
        Ok(())
    }

    /// The output of the ticks to come until it is constant, into the scratch; how many they are. With a
    /// change of train and other corrections than those under way, if they are given.
    fn simulate(&mut self, change: Option<Change<'_>>, remaining: usize) -> Result<usize, Refusal> {
        let switches = change.is_some_and(|change| self.can_switch(change.train));
        let (trains, schedule) = match change {
            None => (Trains::AsTheyAre(&self.fade), &self.schedule),
            Some(change) => {
                let trains = change.trains(&self.fade, switches, self.tick);
                (trains, change.schedule)
            }
        };
        let ahead = Ahead {
            tick: self.tick,
            sample_time: self.sample_time,
            line: &self.line,
            planned: &self.planned[..remaining],
        };
        ahead.simulate(trains, schedule, &mut self.future)
    }

    /// Whether a train can take over now without a trace, because the line is constant.
    fn can_switch(&self, train: &GridTrain) -> bool {
        let longest = self.fade.duration_in_ticks().max(train.duration_in_ticks());
        self.line.unchanged_for() >= longest
    }

    /// The earlier corrections as they go on, and what new steps must add up to.
    fn going_on(&self, superseded: bool) -> (Schedule, f64) {
        let mut schedule = self.schedule.clone();
        let undone = if superseded {
            schedule.drop_future(self.tick)
        } else {
            0.0
        };
        (schedule, -undone)
    }

    fn best(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        known: &Known,
        present: &Present,
        superseded: bool,
    ) -> Result<Choice, Refusal> {
        let period = 4 * known.meters[0].quarter;
        let moving = remaining > 0 || self.line.unchanged_for() < self.fade.duration_in_ticks();
        let (schedule, total) = self.going_on(superseded);
        let mut best: Option<Choice> = None;
        let mut refusal = Refusal::Limits;
        for periods in FADES {
            let fade = Float::ceil(periods * period as f64) as usize;
            let same = self.fade.last() == request.train;
            if fade > 0 && (self.fade.is_full() || !moving || same) {
                continue;
            }
            let change = Change {
                train: request.train,
                fade,
                schedule: &schedule,
            };
            let rest = match self.simulate(Some(change), remaining) {
                Ok(rest) => rest,
                Err(other) => {
                    refusal = other;
                    continue;
                }
            };
            let forecast = self.forecast_of(
                request,
                (remaining, rest),
                known,
                (&change, total),
                Some(present),
            );
            let left = forecast.left();
            let replayed = self.replayed(request, remaining, known, &left, fade > 0);
            let as_is = Choice {
                plan: None,
                fade,
                superseded,
                energy: f64::INFINITY,
            };
            if forecast.improve(&mut best, as_is, &[&replayed, &left]) {
                refusal = Refusal::NotWorth(0.0);
            }
        }
        let count = |choice: &Choice| choice.plan.map_or(0, |plan| plan.comb.count);
        match best {
            Some(choice) if schedule.remaining_capacity() < count(&choice) => Err(Refusal::Busy),
            other => other.ok_or(refusal),
        }
    }

    /// What is left beside what the new train would have left of everything planned up to now, and what the train
    /// in force then leaves of the rest.
    fn replayed(
        &self,
        request: &Retune<'_>,
        remaining: usize,
        known: &Known,
        left: &[ModalState],
        fades: bool,
    ) -> Each<ModalState> {
        let train = match fades || self.can_switch(request.train) {
            true => request.train,
            false => self.fade.last(),
        };
        let input = || self.planned[..remaining].iter().map(|input| input.position);
        let modes = known.meters.iter().zip(&known.planned).zip(left);
        modes
            .map(|((meter, planned), left)| {
                let now = self.line.at(0).position;
                let rest = ModalState::of_future(meter.pole, now, input());
                let before = planned.shaped(request.train, meter.pole);
                left.less(before.sum(rest.shaped(train, meter.pole)))
            })
            .collect()
    }

    fn forecast_of<'a>(
        &'a self,
        request: &Retune<'_>,
        (remaining, rest): (usize, usize),
        known: &'a Known,
        (change, total): (&Change<'a>, f64),
        present: Option<&'a Present>,
    ) -> Forecast<'a, S> {
        let trains = change.trains(&self.fade, self.can_switch(change.train), self.tick);
        Forecast {
            ahead: Ahead {
                tick: self.tick,
                sample_time: self.sample_time,
                line: &self.line,
                planned: &self.planned[..remaining],
            },
            fades_until: trains.fades_until(),
            trains,
            sent: self.sent,
            future: &self.future[..rest],
            schedule: change.schedule,
            limits: request.limits,
            total,
            meters: &known.meters,
            past: known.sent.clone(),
            present,
        }
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
        let span = plan.map_or(0, |plan| plan.comb.end() - self.tick) as usize;
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
