//! The possible continuations of a command: with or without a cross-fade, with or without a correction.

use crate::adaptive_filter::AdaptiveFilter;
use crate::ahead::Ahead;
use crate::correction::Schedule;
use crate::cross_fade::{CrossFade, Trains};
use crate::history::Entry;
use crate::modal_state::ModalState;
use crate::pole::{pole, pole_variance};
use crate::replay::{Choice, Each, Forecast, Present};
use crate::vibration::{Meter, Profile, energy, largest, quarter};
use crate::{Buffer, GridTrain, Refusal, Retune, Setpoint};
use num_traits::Float;

/// Lengths of the cross-fades that are tried, damped periods; 0 keeps the old train to the end.
const FADES: [f64; 3] = [1.0, 2.0, 0.0];

/// Known quantities of the modes before a choice is made.
pub(crate) struct Known {
    pub meters: Each<Meter>,
    /// The vibration that everything planned, and everything sent, has left of each.
    pub planned: Each<ModalState>,
    pub sent: Each<ModalState>,
}

/// A change of the train in motion.
#[derive(Clone, Copy)]
pub(crate) struct Change<'a> {
    pub train: &'a GridTrain,
    /// Length of the cross-fade, ticks; 0 keeps the trains at work, unless the line is constant.
    pub fade: usize,
    /// The earlier corrections as they go on.
    pub schedule: &'a Schedule,
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
    pub(crate) fn known(&self, request: &Retune<'_>) -> Result<Known, Refusal> {
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
    pub(crate) fn present(
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
            negligible: request.dead_band * request.dead_band * energy(&unshaped),
        })
    }

    /// The vibration of the planned input as it is.
    pub(crate) fn unshaped(
        &self,
        remaining: usize,
        known: &Known,
        meters: &[Meter],
    ) -> Each<Profile> {
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
    pub(crate) fn load(
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
    pub(crate) fn simulate(
        &mut self,
        change: Option<Change<'_>>,
        remaining: usize,
    ) -> Result<usize, Refusal> {
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

    /// Whether a train can take over now without any effect, because the line is constant.
    pub(crate) fn can_switch(&self, train: &GridTrain) -> bool {
        let longest = self.fade.duration_in_ticks().max(train.duration_in_ticks());
        self.line.unchanged_for() >= longest
    }

    /// The earlier corrections as they go on, and what new steps must add up to.
    pub(crate) fn going_on(&self, superseded: bool) -> (Schedule, f64) {
        let mut schedule = self.schedule.clone();
        let undone = if superseded {
            schedule.drop_future(self.tick)
        } else {
            0.0
        };
        (schedule, -undone)
    }

    pub(crate) fn best(
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
            if forecast.improve(&mut best, as_is, [&replayed, &left]) {
                refusal = Refusal::NotWorth(0.0);
            }
        }
        let count = |choice: &Choice| choice.plan.map_or(0, |plan| plan.comb.count);
        match best {
            Some(choice) if schedule.remaining_capacity() < count(&choice) => Err(Refusal::Busy),
            other => other.ok_or(refusal),
        }
    }

    /// The residual beside that which the new train would have left of everything planned up to now, and what the train
    /// in force then leaves of the rest.
    pub(crate) fn replayed(
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

    pub(crate) fn forecast_of<'a>(
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
            range: self.range,
            total,
            meters: &known.meters,
            past: known.sent.clone(),
            present,
        }
    }
}
