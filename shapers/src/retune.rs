//! Changing the train in motion: cross-fade and replay correction.

use crate::adaptive_filter::AdaptiveFilter;
use crate::complex::Complex;
use crate::correction::{CORRECTED_MODES, CORRECTION_STEPS, Comb, Schedule, sum};
use crate::cross_fade::CrossFade;
use crate::{GridTrain, Mode, MotionLimits, PeakRatios, Residual, Setpoint, ShaperError};
use arrayvec::ArrayVec;
use num_traits::Float;

/// A correction may exceed the limits of the move by 5 %.
pub const CORRECTION_OVERSHOOT: f64 = 1.05;

/// Steps of a correction, and their width in quarter periods, by growing length: each has a lower
/// peak than the one before it.
const COMBS: [(usize, usize); 7] = [(5, 1), (5, 2), (7, 2), (9, 3), (13, 4), (17, 4), (25, 4)];

/// Lengths of the cross-fades that are tried, damped periods; 0 keeps the old train to the end.
const FADES: [f64; 3] = [1.0, 2.0, 0.0];

/// What a retune is to reach.
#[derive(Clone, Copy, Debug)]
pub struct Retune<'a> {
    /// The train to go over to.
    pub train: &'a GridTrain,
    /// The modes whose vibration is cancelled, 1 to 3; the first sets the pace.
    pub modes: &'a [Mode],
    /// The limits of the move.
    pub limits: MotionLimits,
}

/// What a retune did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RetuneOutcome {
    /// Nothing had moved: the train is in force, or will be at rest.
    Installed,
    /// The command goes on as described; nothing of the modes will be left after it.
    Corrected(Correction),
    /// Nothing was changed.
    Refused(Refusal),
}

/// How a command goes on after a retune.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// Length of the cross-fade, s; 0 where the old train is kept to the end of the move and the
    /// new one takes over at rest.
    pub cross_fade: f64,
    /// From now to the start of the correction, s.
    pub delay: f64,
    /// Length of the correction, s.
    pub duration: f64,
    /// Number of its smooth steps.
    pub steps: usize,
    /// From now to the end of the whole command, s.
    pub until_rest: f64,
    /// Peaks of the command from now on, over the limits.
    pub peaks: PeakRatios,
}

/// Why a retune was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// The train or a limit is not usable here.
    #[error("{0}")]
    Invalid(ShaperError),
    /// The number of modes is not 1 to 3.
    #[error("{0} modes to correct; 1 to 3 are possible")]
    Modes(usize),
    /// More ticks ahead than the filter looks.
    #[error("{needed} ticks ahead; the filter looks {horizon} ahead")]
    Horizon {
        /// Ticks until the command is at rest.
        needed: usize,
        /// Ticks that the filter can look ahead.
        horizon: usize,
    },
    /// The start of the move has been overwritten.
    #[error("the start of the move is older than the filter remembers")]
    HistoryLost,
    /// No correction keeps the limits, however long or late.
    #[error("no correction keeps the limits")]
    Limits,
    /// Too many steps of earlier corrections are under way.
    #[error("too many steps of earlier corrections are under way")]
    Busy,
}

/// The best way found so far.
#[derive(Clone, Copy)]
struct Plan {
    fade: usize,
    comb: Comb,
    amplitudes: [f64; CORRECTION_STEPS],
    /// Ticks until the command without the correction is constant.
    rest: usize,
    /// Ticks from now to the end of the command.
    end: usize,
}

/// The future without a correction.
struct Forecast<'a> {
    now: u64,
    sample_time: f64,
    sent: Setpoint,
    future: &'a [Setpoint],
    limits: MotionLimits,
    modes: ArrayVec<(Mode, Complex), CORRECTED_MODES>,
    /// What the new steps must add up to.
    total: f64,
}

impl AdaptiveFilter {
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
    /// where `S` is the contribution of one step. The joint must have been at rest at the last
    /// [`AdaptiveFilter::reset`]; the plant between command and mode may be any linear one, because
    /// it multiplies `phi` by a constant. Position, velocity and acceleration stay continuous, and
    /// velocity, acceleration and jerk within 5 % of the limits: longer cross-fades, none at all,
    /// more and wider steps, and later starts are tried, and the way that is at rest first is taken.
    ///
    /// May be called again at any time with a better estimate: steps that have begun run to their
    /// end, the others are replaced. After the end of the command it cancels what still rings.
    ///
    /// No allocation. Cost: `3 remaining` times the taps, and at most `21 (q + 28)` corrections of at
    /// most `7` periods, where `q` is the time to the end in quarter periods; most are discarded at
    /// their first tick above a limit.
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
        let vibration = self
            .history
            .vibration(mode, self.sample_time)
            .ok_or(Refusal::HistoryLost)?;
        self.load(remaining, planned)?;
        let last = self.line.at(0).position;
        let input = &self.planned[..remaining];
        let unshaped = vibration.planned + ahead(mode, self.sample_time, last, input);
        let (fade, schedule) = (self.fade.clone(), self.schedule.clone());
        let end = self.simulate(&fade, &schedule, remaining)?;
        let output = &self.future[..end];
        let shaped = vibration.sent + ahead(mode, self.sample_time, self.sent.position, output);
        Ok(Residual {
            shaped: shaped.abs(),
            unshaped: unshaped.abs(),
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
        let mut past: ArrayVec<(Mode, Complex), CORRECTED_MODES> = ArrayVec::new();
        for &mode in request.modes {
            let vibration = self
                .history
                .vibration(mode, self.sample_time)
                .ok_or(Refusal::HistoryLost)?;
            past.push((mode, vibration.sent));
        }
        let still = remaining == 0 && self.is_settled();
        if still && past.iter().all(|(_, vibration)| vibration.abs() == 0.0) {
            self.install(request.train).map_err(Refusal::Invalid)?;
            return Ok(RetuneOutcome::Installed);
        }
        self.load(remaining, planned)?;
        let mut schedule = self.schedule.clone();
        let total = -schedule.drop_future(self.tick);
        let plan = self.best_plan(request, remaining, &schedule, &past, total)?;
        if schedule.remaining_capacity() < plan.comb.count {
            return Err(Refusal::Busy);
        }
        self.apply(request, remaining, schedule, plan)
    }

    /// Copies the planned input into the scratch.
    fn load(
        &mut self,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> Result<(), Refusal> {
        let horizon = self.planned.len();
        let needed = remaining;
        let slots = self
            .planned
            .get_mut(..remaining)
            .ok_or(Refusal::Horizon { needed, horizon })?;
        for (k, slot) in slots.iter_mut().enumerate() {
            *slot = planned(k + 1);
        }
        Ok(())
    }

    /// The output of the ticks to come until it is constant, into the scratch; how many they are.
    fn simulate(
        &mut self,
        fade: &CrossFade,
        schedule: &Schedule,
        remaining: usize,
    ) -> Result<usize, Refusal> {
        let steps_end = schedule.end().saturating_sub(self.tick) as usize;
        let needed = (remaining + fade.duration_in_ticks()).max(steps_end);
        let horizon = self.future.len();
        let future = self
            .future
            .get_mut(..needed)
            .ok_or(Refusal::Horizon { needed, horizon })?;
        let (planned, line) = (&self.planned[..remaining], &self.line);
        let goal = planned
            .last()
            .map_or_else(|| line.at(0), |last| Setpoint::at_rest(last.position));
        for (ahead, slot) in future.iter_mut().enumerate() {
            // `ahead + 1` ticks from now; an age of `ahead + 1` is the newest input of the line.
            let input = |age: usize| match (ahead + 1).checked_sub(age) {
                Some(0) => line.at(0),
                Some(k) => planned.get(k - 1).copied().unwrap_or(goal),
                None => line.at(age - ahead - 1),
            };
            let tick = self.tick + ahead as u64 + 1;
            let shaped = fade.output(tick, self.sample_time, input);
            *slot = sum(shaped, schedule.output(tick, self.sample_time));
        }
        Ok(needed)
    }

    fn faded(&self, train: &GridTrain, ticks: usize) -> CrossFade {
        let mut fade = self.fade.clone();
        if ticks > 0 {
            fade.fade_in(train, self.tick, ticks);
        }
        fade
    }

    fn best_plan(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        schedule: &Schedule,
        past: &[(Mode, Complex)],
        total: f64,
    ) -> Result<Plan, Refusal> {
        let period = request.modes[0].damped_period() / self.sample_time;
        let moving = remaining > 0 || self.line.unchanged_for() < self.fade.duration_in_ticks();
        let mut best: Result<Plan, Refusal> = Err(Refusal::Limits);
        for periods in FADES {
            let fade_ticks = Float::ceil(periods * period) as usize;
            if fade_ticks > 0 && (self.fade.is_full() || !moving) {
                continue;
            }
            let fade = self.faded(request.train, fade_ticks);
            let rest = match self.simulate(&fade, schedule, remaining) {
                Ok(rest) => rest,
                Err(refusal) => {
                    best = best.or(Err(refusal));
                    continue;
                }
            };
            let (future, sent) = (&self.future[..rest], self.sent);
            let modes = past
                .iter()
                .map(|&(mode, vibration)| {
                    (
                        mode,
                        vibration + ahead(mode, self.sample_time, sent.position, future),
                    )
                })
                .collect();
            let (now, sample_time, limits) = (self.tick, self.sample_time, request.limits);
            let forecast = Forecast {
                now,
                sample_time,
                sent,
                future,
                limits,
                modes,
                total,
            };
            let below = best.as_ref().map_or(usize::MAX, |plan| plan.end);
            if let Some((comb, amplitudes, end)) = forecast.search(period, below) {
                best = Ok(Plan {
                    fade: fade_ticks,
                    comb,
                    amplitudes,
                    rest,
                    end,
                });
            }
        }
        best
    }

    fn apply(
        &mut self,
        request: &Retune<'_>,
        remaining: usize,
        mut schedule: Schedule,
        plan: Plan,
    ) -> Result<RetuneOutcome, Refusal> {
        let Plan {
            fade: fade_ticks,
            comb,
            amplitudes,
            end,
            ..
        } = plan;
        let fade = self.faded(request.train, fade_ticks);
        self.simulate(&fade, &schedule, remaining)?;
        let peaks = self.peaks(&plan, &request.limits);
        schedule.extend(comb.steps(&amplitudes));
        self.schedule = schedule;
        self.fade = fade;
        self.pending = if fade_ticks > 0 {
            None
        } else {
            Some(request.train.clone())
        };
        let seconds = |ticks: usize| ticks as f64 * self.sample_time;
        Ok(RetuneOutcome::Corrected(Correction {
            cross_fade: seconds(fade_ticks),
            delay: seconds((comb.start - self.tick) as usize),
            duration: seconds(comb.span()),
            steps: comb.count,
            until_rest: seconds(end),
            peaks,
        }))
    }
}

impl AdaptiveFilter {
    /// Peaks of the simulated future with the correction of a plan.
    fn peaks(&self, plan: &Plan, limits: &MotionLimits) -> PeakRatios {
        let mut before = self.sent;
        let mut peaks = PeakRatios::default();
        for k in 1..=plan.end {
            let tick = self.tick + k as u64;
            let added = plan.comb.output(tick, self.sample_time, &plan.amplitudes);
            let now = sum(base(self.sent, &self.future[..plan.rest], k), added);
            peaks = peaks.max(PeakRatios::of_tick(before, now, limits, self.sample_time));
            before = now;
        }
        peaks
    }
}

/// The setpoint `ahead` ticks after the one just sent; at rest after the last.
fn base(sent: Setpoint, future: &[Setpoint], ahead: usize) -> Setpoint {
    let Some(index) = ahead.checked_sub(1) else {
        return sent;
    };
    let at_rest = || Setpoint::at_rest(future.last().unwrap_or(&sent).position);
    future.get(index).copied().unwrap_or_else(at_rest)
}

/// `sum du_k exp(-lambda t_k)` of positions at the ticks after now.
fn ahead(mode: Mode, sample_time: f64, last: f64, future: &[Setpoint]) -> Complex {
    let pole = Complex::new(mode.decay_rate(), -mode.damped_frequency()).scale(sample_time);
    let turn = pole.exp();
    let mut weight = Complex::ONE;
    let mut before = last;
    let mut total = Complex::default();
    for now in future {
        weight = weight * turn;
        total = total + weight.scale(now.position - before);
        before = now.position;
    }
    total
}

impl Forecast<'_> {
    fn base(&self, ahead: usize) -> Setpoint {
        base(self.sent, self.future, ahead)
    }

    fn holds(&self, before: Setpoint, now: Setpoint) -> bool {
        let peaks = PeakRatios::of_tick(before, now, &self.limits, self.sample_time);
        peaks.worst() <= CORRECTION_OVERSHOOT
    }

    /// First and last tick at which the future exceeds the limits without a correction.
    fn excess(&self) -> Option<(usize, usize)> {
        let exceeds = |&k: &usize| !self.holds(self.base(k - 1), self.base(k));
        let first = (1..=self.future.len()).find(exceeds)?;
        (1..=self.future.len())
            .rev()
            .find(exceeds)
            .map(|last| (first, last))
    }

    /// The correction that is over first, before `below` ticks: by completion in quarter periods,
    /// then by length.
    fn search(&self, period: f64, below: usize) -> Option<(Comb, [f64; CORRECTION_STEPS], usize)> {
        let excess = self.excess();
        let quarter = (Float::round(0.25 * period) as usize).max(1);
        let rest = self.future.len();
        let longest = COMBS
            .iter()
            .map(|(count, width)| count - 1 + width)
            .max()
            .unwrap_or(0);
        for completion in 1..=rest.div_ceil(quarter) + longest {
            if rest.max(completion * quarter) >= below {
                return None;
            }
            for (count, width) in COMBS {
                let Some(delay) = completion.checked_sub(count - 1 + width) else {
                    continue;
                };
                let start = self.now + (delay * quarter) as u64;
                let comb = Comb {
                    start,
                    count,
                    spacing: quarter,
                    ticks: width * quarter,
                };
                if let Some(amplitudes) = self.attempt(&comb, excess) {
                    return Some((comb, amplitudes, rest.max(completion * quarter)));
                }
            }
        }
        None
    }

    /// The amplitudes of a comb, if it solves the conditions and keeps the limits.
    fn attempt(
        &self,
        comb: &Comb,
        excess: Option<(usize, usize)>,
    ) -> Option<[f64; CORRECTION_STEPS]> {
        let from = (comb.start - self.now) as usize;
        let to = from + comb.span();
        let outside = excess.is_some_and(|(first, last)| first <= from || last > to);
        if outside || comb.count < 2 * self.modes.len() + 3 {
            return None;
        }
        let amplitudes = comb.amplitudes(self.now, self.sample_time, &self.modes, self.total)?;
        let mut before = self.base(from);
        for k in from + 1..=to {
            let tick = self.now + k as u64;
            let now = sum(
                self.base(k),
                comb.output(tick, self.sample_time, &amplitudes),
            );
            if !self.holds(before, now) {
                return None;
            }
            before = now;
        }
        Some(amplitudes)
    }
}
