//! The search for a correction that keeps the limits.

use crate::complex::Complex;
use crate::correction::{CORRECTED_MODES, CORRECTION_STEPS, Comb, Order, sum};
use crate::modal_state::ModalState;
use crate::{MotionLimits, PeakRatios, Setpoint};
use arrayvec::ArrayVec;
use num_traits::Float;

/// A correction may exceed the limits of the move by 5 %.
pub const CORRECTION_OVERSHOOT: f64 = 1.05;

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

/// Periods that a correction may last longer if it cancels the slope too. Without that 1 % of
/// frequency error leaves 1 to 5 % of the vibration, which then rings for many periods.
const ROBUSTNESS_WORTH: f64 = 2.0;

/// A correction that keeps the limits.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    pub comb: Comb,
    pub amplitudes: [f64; CORRECTION_STEPS],
    pub order: Order,
    /// Ticks from now to the end of the command.
    pub end: usize,
    /// `end`, and [`ROBUSTNESS_WORTH`] more where the slope is not cancelled.
    pub cost: usize,
}

impl Plan {
    pub fn is_robust(&self) -> bool {
        self.order == Order::Slope
    }
}

/// The future without a new correction.
pub(crate) struct Forecast<'a> {
    pub now: u64,
    pub sample_time: f64,
    pub sent: Setpoint,
    pub future: &'a [Setpoint],
    pub limits: MotionLimits,
    /// Poles and states of the modes, referred to now, of everything sent and to be sent.
    pub modes: ArrayVec<(Complex, ModalState), CORRECTED_MODES>,
    /// What the new steps must add up to.
    pub total: f64,
}

impl Forecast<'_> {
    /// The correction of least cost below `below`.
    pub fn search(&self, period: f64, below: usize) -> Option<Plan> {
        let penalty = Float::ceil(ROBUSTNESS_WORTH * period) as usize;
        let robust = self.search_order(Order::Slope, period, 0, below);
        let below = robust.as_ref().map_or(below, |plan| plan.cost);
        self.search_order(Order::Value, period, penalty, below)
            .or(robust)
    }

    /// The correction that is over first: by completion in quarter periods, then by length.
    fn search_order(
        &self,
        order: Order,
        period: f64,
        penalty: usize,
        below: usize,
    ) -> Option<Plan> {
        let excess = self.excess();
        let quarter = (Float::round(0.25 * period) as usize).max(1);
        let rest = self.future.len();
        let longest = COMBS
            .iter()
            .map(|(count, width)| count - 1 + width)
            .max()
            .unwrap_or(0);
        for completion in 1..=rest.div_ceil(quarter) + longest {
            let end = rest.max(completion * quarter);
            if end + penalty >= below {
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
                if let Some(amplitudes) = self.attempt(&comb, order, excess) {
                    return Some(Plan {
                        comb,
                        amplitudes,
                        order,
                        end,
                        cost: end + penalty,
                    });
                }
            }
        }
        None
    }

    /// The amplitudes of a comb, if it solves the conditions and keeps the limits.
    fn attempt(
        &self,
        comb: &Comb,
        order: Order,
        excess: Option<(usize, usize)>,
    ) -> Option<[f64; CORRECTION_STEPS]> {
        let from = (comb.start - self.now) as usize;
        let to = from + comb.span();
        let outside = excess.is_some_and(|(first, last)| first <= from || last > to);
        if outside || comb.count < order.fewest_steps(self.modes.len()) {
            return None;
        }
        let amplitudes = comb.amplitudes(self.now, &self.modes, order, self.total)?;
        // A coarse pass discards most: the mean jerk over several ticks is at most the largest.
        let coarse = (comb.spacing / 8).max(1);
        let keeps = |stride| self.keeps(comb, &amplitudes, (from, to), stride);
        (keeps(coarse) && (coarse == 1 || keeps(1))).then_some(amplitudes)
    }

    /// Whether the future with a correction keeps the limits at every `stride`-th tick.
    fn keeps(
        &self,
        comb: &Comb,
        amplitudes: &[f64],
        (from, to): (usize, usize),
        stride: usize,
    ) -> bool {
        let mut before = self.base(from);
        (from + stride..=to).step_by(stride).all(|k| {
            let now = self.corrected(comb, amplitudes, k);
            let held = self.holds(before, now, stride);
            before = now;
            held
        })
    }

    /// Peaks of the future with the correction of a plan.
    pub fn peaks(&self, plan: &Plan) -> PeakRatios {
        let mut before = self.sent;
        let mut peaks = PeakRatios::default();
        for k in 1..=plan.end {
            let now = self.corrected(&plan.comb, &plan.amplitudes, k);
            peaks = peaks.max(PeakRatios::of_tick(
                before,
                now,
                &self.limits,
                self.sample_time,
            ));
            before = now;
        }
        peaks
    }

    fn corrected(&self, comb: &Comb, amplitudes: &[f64], ahead: usize) -> Setpoint {
        let added = comb.output(self.now + ahead as u64, self.sample_time, amplitudes);
        sum(self.base(ahead), added)
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
        let time = self.sample_time * ticks as f64;
        let keeps = |peaks: PeakRatios| peaks.worst() <= CORRECTION_OVERSHOOT;
        keeps(PeakRatios::of_tick(before, now, &self.limits, time))
            && keeps(PeakRatios::between(before, now, &self.limits, time))
    }

    /// First and last tick at which the future exceeds the limits without a correction.
    fn excess(&self) -> Option<(usize, usize)> {
        let exceeds = |&k: &usize| !self.holds(self.base(k - 1), self.base(k), 1);
        let first = (1..=self.future.len()).find(exceeds)?;
        (1..=self.future.len())
            .rev()
            .find(exceeds)
            .map(|last| (first, last))
    }
}
