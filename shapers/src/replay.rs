//! The search for a correction: within the limits, and of the least vibration over the rest of the move.

use crate::ahead::Ahead;
use crate::correction::{CORRECTED_MODES, CORRECTION_STEPS, Comb, Order, Schedule, sum};
use crate::cross_fade::Trains;
use crate::modal_state::ModalState;
use crate::vibration::{BINS, Meter, Profile, Sent, energy, quarter, stays_below};
use crate::{Buffer, MotionLimits, PeakRatios, Setpoint};
use arrayvec::ArrayVec;
use core::ops::Range;
use num_complex::Complex64;

/// Steps of a correction, and their width in quarter periods, by growing length: more and wider
/// steps have lower peaks.
const COMBS: [(usize, usize); 10] = [
    (5, 1),
    (5, 2),
    (7, 1),
    (7, 2),
    (9, 2),
    (9, 3),
    (13, 3),
    (13, 4),
    (17, 4),
    (CORRECTION_STEPS, 4),
];

/// Rounding of a setpoint at a limit, relative.
const ROUNDING: f64 = 1e-9;

/// A number or profile for each mode.
pub(crate) type Each<T> = ArrayVec<T, CORRECTED_MODES>;

/// A correction that keeps the limits.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub comb: Comb,
    pub amplitudes: [f64; CORRECTION_STEPS],
    pub order: Order,
}

/// How a command goes on.
#[derive(Clone, Copy)]
pub(crate) struct Choice {
    /// None where nothing is to be corrected.
    pub plan: Option<Plan>,
    /// Length of the cross-fade, ticks.
    pub fade: usize,
    /// Whether steps of earlier corrections that have not begun are dropped.
    pub superseded: bool,
    /// The vibration over the rest of the move, `sum int |psi|^2 dt` over the modes, in ticks.
    pub energy: f64,
}

/// The vibration without any change.
pub(crate) struct Present {
    /// Of the command as it goes on now.
    pub profiles: Each<Profile>,
    /// Amplitude by which no other way may exceed it.
    pub slack: f64,
    /// Energy of that of the planned input as it is.
    pub unshaped: f64,
    /// Energy that is not worth a correction.
    pub negligible: f64,
}

/// The command without a new correction, and the resulting vibration of the modes.
pub(crate) struct Forecast<'a, S> {
    pub ahead: Ahead<'a, S>,
    pub trains: Trains<'a>,
    pub sent: Setpoint,
    pub future: &'a [Setpoint],
    /// Earlier corrections that are part of it.
    pub schedule: &'a Schedule,
    /// The last tick at which a train fades.
    pub fades_until: Option<u64>,
    pub limits: MotionLimits,
    /// The lowest and the highest position.
    pub range: [f64; 2],
    /// The sum that the new steps must add up to.
    pub total: f64,
    pub meters: &'a [Meter],
    /// The vibration that everything sent up to now has left of each mode.
    pub past: Each<ModalState>,
    /// The bound for all other continuations; `None` where it does not matter.
    pub present: Option<&'a Present>,
}

impl<S: Buffer<Setpoint>> Forecast<'_, S> {
    /// The vibration that the command leaves of each mode, referred to now.
    pub fn left(&self) -> Each<ModalState> {
        let of_future = |meter: &Meter| {
            let positions = self.future.iter().map(|setpoint| setpoint.position);
            ModalState::of_future(meter.pole, self.sent.position, positions)
        };
        let states = self.meters.iter().zip(&self.past);
        states
            .map(|(meter, past)| past.sum(of_future(meter)))
            .collect()
    }

    /// The vibration from now on, less a state that is taken away now.
    pub fn profiles(&self, taken: Option<&[ModalState]>) -> Each<Profile> {
        let each = self.meters.iter().zip(&self.past).enumerate();
        each.map(|(index, (meter, past))| {
            let taken = taken.map_or_else(ModalState::default, |taken| taken[index]);
            let state = past.less(taken);
            meter.profile(state, self.sent, self.future.len(), |k| self.command(k))
        })
        .collect()
    }

    /// Searches a continuation of less vibration than `best`: without a correction, and with each that removes
    /// one of `wanted`. Returns whether any continuation keeps the limits, however much it vibrates.
    pub fn improve(
        &self,
        best: &mut Option<Choice>,
        as_is: Choice,
        wanted: [&[ModalState]; 2],
    ) -> bool {
        let excess = self.excess();
        let alone = self.profiles(None);
        // Where steps are dropped, the sum of those that have begun must be undone.
        let mut possible = self.total == 0.0 && excess.is_none();
        if possible && self.is_allowed(&alone, 0..BINS) {
            let energy = energy(&alone);
            take(best, Choice { energy, ..as_is });
        }
        let [replayed, left] = wanted;
        possible |= self.correct(best, as_is, replayed, excess);
        let between = left.iter().zip(replayed).map(|(left, own)| left.less(*own));
        // Most trains leave nothing, and both are equal. A residual by a train's design is removed only at the
        // end.
        let ended = self.ahead.planned.is_empty();
        if (ended || self.is_worth(replayed)) && self.is_worth(&between.collect::<Each<_>>()) {
            possible |= self.correct(best, as_is, left, excess);
        }
        possible
    }

    /// As [`Self::improve`], with corrections that take `wanted` away.
    fn correct(
        &self,
        best: &mut Option<Choice>,
        as_is: Choice,
        wanted: &[ModalState],
        excess: Option<usize>,
    ) -> bool {
        if !self.is_worth(wanted) {
            return false;
        }
        let mut possible = false;
        let after = self.profiles(Some(wanted));
        let orders = [Order::Value, Order::Slope];
        let spacings = self.spacings();
        let combs = orders
            .iter()
            .flat_map(|order| COMBS.map(|comb| (order, comb)))
            .flat_map(|comb| spacings.iter().map(move |spacing| (comb, *spacing)));
        for ((order, (count, width)), spacing) in combs {
            let most = best.map_or(f64::INFINITY, |best| best.energy);
            let comb = self.comb(count, width, spacing);
            if self.energy_after(&comb, &after) >= most {
                continue;
            }
            let Some(plan) = self.attempt(&comb, (*order, wanted), excess) else {
                continue;
            };
            possible = true;
            if let Some(energy) = self.energy(&plan, &after, most) {
                let plan = Some(plan);
                take(
                    best,
                    Choice {
                        plan,
                        energy,
                        ..as_is
                    },
                );
            }
        }
        possible
    }

    /// Quarter periods of the modes, ticks: a comb whose steps are a period of a mode apart cannot take that mode away.
    fn spacings(&self) -> Each<usize> {
        let mut spacings: Each<usize> = Each::new();
        for meter in self.meters {
            let spacing = quarter(meter.pole);
            if !spacings.contains(&spacing) {
                spacings.push(spacing);
            }
        }
        spacings
    }

    /// A comb that begins now.
    fn comb(&self, count: usize, width: usize, spacing: usize) -> Comb {
        Comb {
            start: self.ahead.tick,
            count,
            spacing,
            ticks: width * spacing,
        }
    }

    /// The vibration after a correction.
    fn energy_after(&self, comb: &Comb, after: &[Profile]) -> f64 {
        let bins = comb.span().div_ceil(self.meters[0].quarter);
        after.iter().map(|profile| profile.energy_after(bins)).sum()
    }

    /// The vibration with a correction, if it is below `most`, and nowhere above that of the present command.
    fn energy(&self, plan: &Plan, after: &[Profile], most: f64) -> Option<f64> {
        let span = plan.comb.span();
        let bins = span.div_ceil(self.meters[0].quarter);
        let mut energy = self.energy_after(&plan.comb, after);
        let mut during: Each<Profile> = Each::new();
        for (meter, past) in self.meters.iter().zip(&self.past) {
            let mut profile = Profile::from(*past, self.sent);
            meter.follow(&mut profile, span, most - energy, |k| {
                let (base, planned) = self.command(k);
                let tick = self.tick(k);
                let added = plan
                    .comb
                    .output(tick, self.ahead.sample_time, &plan.amplitudes);
                (sum(base, added), planned)
            });
            energy += profile.energy;
            if energy >= most {
                return None;
            }
            during.push(profile);
        }
        (self.is_allowed(&during, 0..bins) && self.is_allowed(after, bins..BINS)).then_some(energy)
    }

    /// Whether the vibration that a correction would remove has more than a negligible energy in its decay.
    fn is_worth(&self, wanted: &[ModalState]) -> bool {
        let modes = self.meters.iter().zip(wanted);
        let energy: f64 = modes
            .map(|(meter, state)| meter.exact().decay(*state))
            .sum();
        // Where steps are dropped, others must undo those that have begun.
        self.total != 0.0
            || self
                .present
                .is_none_or(|present| energy > present.negligible)
    }

    /// Whether the vibration in the given quarter periods does not exceed that of the present command.
    fn is_allowed(&self, profiles: &[Profile], bins: Range<usize>) -> bool {
        self.present
            .is_none_or(|present| stays_below(profiles, &present.profiles, bins, present.slack))
    }

    /// The correction of a comb, if it solves the conditions and keeps the limits.
    fn attempt(
        &self,
        comb: &Comb,
        (order, wanted): (Order, &[ModalState]),
        excess: Option<usize>,
    ) -> Option<Plan> {
        let to = comb.span();
        let outside = excess.is_some_and(|last| last > to);
        if outside || comb.count < order.fewest_steps(wanted.len()) {
            return None;
        }
        let poles = self.meters.iter().map(|meter| meter.pole);
        let modes: Each<(Complex64, ModalState)> = poles.zip(wanted.iter().copied()).collect();
        let amplitudes = comb.amplitudes(self.ahead.tick, &modes, order, self.total)?;
        // A coarse pass discards most: the mean jerk over several ticks is at most the largest.
        let coarse = (comb.spacing / 8).max(1);
        let keeps = |stride| self.keeps(comb, &amplitudes, to, stride);
        (keeps(coarse) && (coarse == 1 || keeps(1))).then_some(Plan {
            comb: *comb,
            amplitudes,
            order,
        })
    }

    /// Whether the future with a correction keeps the limits at every `stride`-th tick.
    fn keeps(&self, comb: &Comb, amplitudes: &[f64], to: usize, stride: usize) -> bool {
        let mut before = self.sent;
        (stride..=to).step_by(stride).all(|k| {
            let now = self.corrected(comb, amplitudes, k);
            let held = self.holds(before, now, stride);
            before = now;
            held
        })
    }

    /// Peaks of the future with the correction of a plan, until `end`.
    pub fn peaks(&self, plan: Option<&Plan>, end: usize) -> PeakRatios {
        let mut before = self.sent;
        let mut peaks = PeakRatios::default();
        for k in 1..=end {
            let now = match plan {
                Some(plan) => self.corrected(&plan.comb, &plan.amplitudes, k),
                None => self.base(k),
            };
            let tick = PeakRatios::of_tick(before, now, &self.limits, self.ahead.sample_time);
            peaks = peaks.max(tick);
            before = now;
        }
        peaks
    }

    fn corrected(&self, comb: &Comb, amplitudes: &[f64], ahead: usize) -> Setpoint {
        let added = comb.output(self.tick(ahead), self.ahead.sample_time, amplitudes);
        sum(self.base(ahead), added)
    }

    /// The setpoint of a tick from now, and how much of its acceleration is planned.
    fn command(&self, ahead: usize) -> Sent {
        let (base, tick) = (self.base(ahead), self.tick(ahead));
        let plain = self.schedule.end() <= tick && self.fades_until.is_none_or(|end| end <= tick);
        match plain {
            true => (base, base.acceleration),
            false => (base, self.ahead.planned_acceleration(self.trains, ahead)),
        }
    }

    fn tick(&self, ahead: usize) -> u64 {
        self.ahead.tick + ahead as u64
    }

    /// The setpoint `ahead` ticks after the one just sent; at rest after the last.
    fn base(&self, ahead: usize) -> Setpoint {
        let Some(index) = ahead.checked_sub(1) else {
            return self.sent;
        };
        let at_rest = || Setpoint::at_rest(self.future.last().unwrap_or(&self.sent).position);
        self.future.get(index).copied().unwrap_or_else(at_rest)
    }

    fn holds(&self, before: Setpoint, now: Setpoint, ticks: usize) -> bool {
        let time = self.ahead.sample_time * ticks as f64;
        let keeps = |peaks: PeakRatios| peaks.worst() <= 1.0 + ROUNDING;
        let [low, high] = self.range;
        let slack = ROUNDING * (high - low);
        let stays = (low - slack..=high + slack).contains(&now.position);
        stays
            && keeps(PeakRatios::of_tick(before, now, &self.limits, time))
            && keeps(PeakRatios::between(before, now, &self.limits, time))
    }

    /// Last tick at which the future exceeds the limits without a correction.
    fn excess(&self) -> Option<usize> {
        let exceeds = |&k: &usize| !self.holds(self.base(k - 1), self.base(k), 1);
        (1..=self.future.len()).rev().find(exceeds)
    }
}

/// Takes a choice of less vibration.
fn take(best: &mut Option<Choice>, choice: Choice) {
    if best.is_none_or(|best| choice.energy < best.energy) {
        *best = Some(choice);
    }
}
