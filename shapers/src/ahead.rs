//! The output of the ticks to come.

use crate::correction::{Schedule, sum};
use crate::cross_fade::Trains;
use crate::filter::{DelayLine, shape};
use crate::{Buffer, Refusal, Setpoint};

/// The known input: the line of the past, and what is planned from now on.
pub(crate) struct Ahead<'a, S> {
    pub tick: u64,
    pub sample_time: f64,
    pub line: &'a DelayLine<S>,
    /// The inputs of the ticks after this one; after the last it stays there.
    pub planned: &'a [Setpoint],
}

impl<S: Buffer<Setpoint>> Ahead<'_, S> {
    /// The output of the ticks to come until it is constant; how many they are.
    pub fn simulate(
        &self,
        trains: Trains<'_>,
        schedule: &Schedule,
        future: &mut [Setpoint],
    ) -> Result<usize, Refusal> {
        let steps_end = schedule.end().saturating_sub(self.tick) as usize;
        let needed = (self.planned.len() + trains.duration_in_ticks()).max(steps_end);
        let horizon = future.len();
        let Some(future) = future.get_mut(..needed) else {
            return Err(Refusal::Horizon { needed, horizon });
        };
        let goal = self.goal();
        let alone = trains.single().filter(|_| schedule.adds_nothing());
        for (ahead, slot) in future.iter_mut().enumerate() {
            let input = |age: usize| self.input(ahead + 1, age, goal);
            *slot = match alone {
                Some(train) => shape(train, input),
                None => {
                    let tick = self.tick + ahead as u64 + 1;
                    let shaped = trains.output(tick, self.sample_time, input);
                    sum(shaped, schedule.output(tick, self.sample_time))
                }
            };
        }
        Ok(needed)
    }

    /// Where the input stays after the last that is planned.
    pub fn goal(&self) -> Setpoint {
        let at_rest = |last: &Setpoint| Setpoint::at_rest(last.position);
        self.planned.last().map_or_else(|| self.line.at(0), at_rest)
    }

    /// The acceleration of the output `ahead` ticks from now that comes from that of the input.
    pub fn planned_acceleration(&self, trains: Trains<'_>, ahead: usize) -> f64 {
        let (tick, goal) = (self.tick + ahead as u64, self.goal());
        trains.planned_acceleration(tick, self.sample_time, |age| self.input(ahead, age, goal))
    }

    /// The input of an age, seen `ahead` ticks from now: an age of `ahead` is the newest of the line.
    #[inline]
    fn input(&self, ahead: usize, age: usize, goal: Setpoint) -> Setpoint {
        match ahead.checked_sub(age) {
            Some(0) => self.line.at(0),
            Some(k) => self.planned.get(k - 1).copied().unwrap_or(goal),
            None => self.line.at(age - ahead),
        }
    }
}
