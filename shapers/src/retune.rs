//! Changing the train in motion: cross-fade and replay correction.

use crate::adaptive_filter::AdaptiveFilter;
use crate::ahead::Ahead;
use crate::complex::Complex;
use crate::correction::{CORRECTED_MODES, Schedule};
use crate::cross_fade::Trains;
use crate::history::Entry;
use crate::modal_state::{ModalState, of_future, pole};
use crate::replay::{Forecast, Plan};
use crate::{
    Buffer, Correction, GridTrain, Mode, MotionLimits, Refusal, Residual, Retune, RetuneOutcome,
    Setpoint,
};
use arrayvec::ArrayVec;
use num_traits::Float;

/// Lengths of the cross-fades that are tried, damped periods; 0 keeps the old train to the end.
const FADES: [f64; 3] = [1.0, 2.0, 0.0];

/// The modes with their poles and the states that everything sent has left.
type Past = ArrayVec<(Complex, ModalState), CORRECTED_MODES>;

/// A plan, and what it is added to.
struct Choice {
    plan: Plan,
    /// Length of the cross-fade, ticks.
    fade: usize,
    /// Whether steps of earlier corrections that have not begun are dropped.
    superseded: bool,
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

impl<S: Buffer<Setpoint>, E: Buffer<Entry>> AdaptiveFilter<S, E> {
    /// Goes over to another train in motion so that nothing of the given modes is left.
    ///
    /// `planned(k)` is the input at the `k`-th tick from now, `1 <= k <= remaining`; after that it
    /// stays where it is. The output is simulated ahead with a cross-fade to the new train. The
    /// vibration that everything sent and to be sent will have left,
    /// `phi = sum du_k exp(-lambda t_k)`, `lambda = -xi omega + j omega_d`, is then cancelled by `N`
    /// smooth steps, a quarter period apart, whose amplitudes are the smallest (least norm) with
    ///
    /// ```text
    /// sum c_i = 0,    sum c_i S exp(-lambda t_i) = -phi
    /// ```
    ///
    /// where `S` is the contribution of one step. Where it costs at most two more periods the
    /// derivative of both sides by `lambda` is matched too, so that an error of the estimate counts
    /// only squared. The joint must have been at rest at the last [`AdaptiveFilter::reset`]; the
    /// plant between command and mode may be any linear one, because it multiplies `phi` by a
    /// constant. Position, velocity and acceleration stay continuous; velocity, acceleration and
    /// jerk stay within 5 % of the limits: longer cross-fades, none at all, more and wider steps, and
    /// later starts are tried, and the way that is at rest first is taken.
    ///
    /// May be called again at any time with a better estimate: steps that have begun run to their
    /// end, the others are replaced (or, if the limits cannot be kept without them, added to). After
    /// the end of the command it cancels what still rings.
    ///
    /// No allocation. Cost: the horizon, 6 times the remaining ticks times the taps, and at most
    /// `100 (q + 28)` corrections of at most 7 periods, where `q` is the time to the end in quarter
    /// periods; most are discarded early. For a move of 0.4 s this is some 0.3 ms at 250 Hz, 0.5 ms
    /// at 1 kHz and 2 ms at 4 kHz on a desktop processor: at fast ticks call it between them.
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

    /// The vibration that will be left of `mode` when the planned input has been sent as things
    /// stand, referred to now, beside that of the planned input itself.
    ///
    /// # Errors
    /// [`Refusal::Horizon`], [`Refusal::HistoryLost`].
    pub fn forecast(
        &mut self,
        mode: Mode,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<Residual, Refusal> {
        let pole = pole(mode, self.sample_time);
        let [given, sent] = self.history.left(pole).ok_or(Refusal::HistoryLost)?;
        self.load(remaining, planned)?;
        let input = self.planned[..remaining].iter().map(|input| input.position);
        let unshaped = ModalState::value_of_future(pole, self.line.at(0).position, input);
        let shaped = match remaining == 0 && self.is_settled() {
            // A command that stands still adds nothing.
            true => Complex::default(),
            false => {
                let rest = self.simulate(None, remaining)?;
                let output = self.future[..rest].iter().map(|output| output.position);
                ModalState::value_of_future(pole, self.sent.position, output)
            }
        };
        Ok(Residual {
            shaped: (sent + shaped).abs(),
            unshaped: (given + unshaped).abs(),
        })
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
        let mut past = Past::new();
        for &mode in request.modes {
            let pole = pole(mode, self.sample_time);
            let sent = self.history.sent(pole).ok_or(Refusal::HistoryLost)?;
            past.push((pole, sent));
        }
        let still = remaining == 0 && self.is_settled();
        if still && past.iter().all(|(_, state)| state.value.abs() == 0.0) {
            self.install(request.train).map_err(Refusal::Invalid)?;
            return Ok(RetuneOutcome::Installed);
        }
        self.load(remaining, planned)?;
        let choice = self
            .best(request, remaining, &past, true)
            .or_else(|_| self.best(request, remaining, &past, false))?;
        self.apply(request, remaining, &choice)
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
        let (trains, schedule) = match change {
            None => (Trains::AsTheyAre(&self.fade), &self.schedule),
            Some(Change {
                train,
                fade,
                schedule,
            }) => {
                let trains = match fade {
                    _ if self.can_switch(train) => Trains::Switched(train),
                    0 => Trains::AsTheyAre(&self.fade),
                    ticks => Trains::Fading(&self.fade, train, self.tick, ticks),
                };
                (trains, schedule)
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
        past: &Past,
        superseded: bool,
    ) -> Result<Choice, Refusal> {
        let period = request.modes[0].damped_period() / self.sample_time;
        let moving = remaining > 0 || self.line.unchanged_for() < self.fade.duration_in_ticks();
        let (schedule, total) = self.going_on(superseded);
        let mut best: Option<Choice> = None;
        let mut refusal = Refusal::Limits;
        for periods in FADES {
            let fade = Float::ceil(periods * period) as usize;
            if fade > 0 && (self.fade.is_full() || !moving) {
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
            let forecast = self.forecast_of(rest, past, total, request.limits);
            let below = best.as_ref().map_or(usize::MAX, |choice| choice.plan.cost);
            if let Some(plan) = forecast.search(period, below) {
                best = Some(Choice {
                    plan,
                    fade,
                    superseded,
                });
            }
        }
        match best {
            Some(choice) if schedule.remaining_capacity() < choice.plan.comb.count => {
                Err(Refusal::Busy)
            }
            other => other.ok_or(refusal),
        }
    }

    fn forecast_of(
        &self,
        rest: usize,
        past: &Past,
        total: f64,
        limits: MotionLimits,
    ) -> Forecast<'_> {
        let future = &self.future[..rest];
        let from_now = |pole| of_future(pole, self.sent.position, future);
        let modes = past
            .iter()
            .map(|&(pole, state)| (pole, state.sum(from_now(pole))))
            .collect();
        let (now, sample_time, sent) = (self.tick, self.sample_time, self.sent);
        Forecast {
            now,
            sample_time,
            sent,
            future,
            limits,
            modes,
            total,
        }
    }

    fn apply(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        choice: &Choice,
    ) -> Result<RetuneOutcome, Refusal> {
        let Choice {
            plan,
            fade,
            superseded,
        } = choice;
        let (mut schedule, total) = self.going_on(*superseded);
        let change = Change {
            train: request.train,
            fade: *fade,
            schedule: &schedule,
        };
        let rest = self.simulate(Some(change), remaining)?;
        let forecast = self.forecast_of(rest, &Past::new(), total, request.limits);
        let peaks = forecast.peaks(plan);
        schedule.extend(plan.comb.steps(&plan.amplitudes));
        let seconds = |ticks: usize| ticks as f64 * self.sample_time;
        let correction = Correction {
            cross_fade: seconds(*fade),
            delay: seconds((plan.comb.start - self.tick) as usize),
            duration: seconds(plan.comb.span()),
            steps: plan.comb.count,
            until_rest: seconds(plan.end),
            robust: plan.is_robust(),
            peaks,
        };
        let switches = self.can_switch(request.train);
        let waits = *fade == 0 && !switches;
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
