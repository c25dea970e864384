//! The search for a correction beside the tick.
//!
//! Until something else changes the command, filter and plan determine its future exactly. So the tick lends a
//! copy of its filter. The borrower runs the copy ahead of the tick, searches there for the correction, which
//! takes longer than a short control period, and gives the copy back. When the tick reaches the same point, it
//! goes on with the copy, unless the command has changed in the meantime.

use quell_shapers::{
    AdaptiveFilter, MotionLimits, Refusal, Retune, RetuneOutcome, Setpoint, UncertainMode,
};

use super::Controller;
use super::settings::motion_limits;
use quell_shapers::GridTrain;

/// The copy of an axis' filter, and what a search for a correction needs.
pub struct Lent {
    filter: AdaptiveFilter,
    limits: MotionLimits,
    dead_band: f64,
    resolution: f64,
    /// Value of [`Axis::changes`] when it was lent.
    changes: u64,
    /// The planned setpoint then.
    planned: Setpoint,
    /// The last setpoint before the correction.
    before: Setpoint,
    outcome: RetuneOutcome,
}

impl Lent {
    /// The planned setpoint at the last tick before it was lent.
    pub fn planned(&self) -> Setpoint {
        self.planned
    }

    /// Runs `ahead` ticks ahead and goes over to `train` there for one to three modes, as
    /// [`AdaptiveFilter::retune`] does. `planned(k)` is the input at the `k`-th tick after the lending,
    /// `1 <= k <= remaining`; then it stays where it is.
    pub fn retune(
        &mut self,
        (train, modes): (&GridTrain, &[UncertainMode]),
        ahead: usize,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) -> RetuneOutcome {
        for tick in 1..=ahead {
            self.filter.step(planned(tick));
        }
        self.before = self.filter.sent();
        let request = Retune {
            train,
            modes,
            limits: self.limits,
            dead_band: self.dead_band,
            resolution: self.resolution,
        };
        let rest = remaining.saturating_sub(ahead);
        self.outcome = self.filter.retune(&request, rest, |k| planned(ahead + k));
        self.outcome
    }
}

impl Controller {
    /// Reserves the copy that [`Controller::lend`] lends. Allocates as much as the axis has.
    pub fn keep_spare(&mut self) {
        let axis = &self.axis;
        let settings = &axis.settings;
        self.spare = Some(Box::new(Lent {
            filter: axis.filter.clone(),
            limits: motion_limits(settings.limits),
            dead_band: settings.adaptation.dead_band,
            resolution: axis.resolution(),
            changes: axis.changes,
            planned: self.planned,
            before: axis.filter.sent(),
            outcome: RetuneOutcome::Refused(Refusal::Busy),
        }));
    }

    /// Lends a copy of the filter. `None` while it is lent, while the command stands still, on a kept path, or
    /// without a reserved copy. No allocation; the cost is a copy of the move's memory.
    pub fn lend(&mut self) -> Option<Box<Lent>> {
        if self.is_settled() || self.axis.lane.is_some() {
            return None;
        }
        let mut lent = self.spare.take()?;
        lent.filter.copy_from(&self.axis.filter);
        (lent.changes, lent.planned) = (self.axis.changes, self.planned);
        lent.outcome = RetuneOutcome::Refused(Refusal::Busy);
        Some(lent)
    }

    /// Ticks until the command reaches the end of a copy; negative if it is past that.
    pub fn due_in(&self, lent: &Lent) -> i64 {
        lent.filter.ticks() as i64 - self.axis.filter.ticks() as i64
    }

    /// Takes a copy back without using it; does nothing if the axis has its copy already. No allocation.
    pub fn give_back(&mut self, lent: &mut Option<Box<Lent>>) {
        if self.spare.is_none() {
            self.spare = lent.take();
        }
    }

    /// Takes a copy back. If the command is exactly at the end of the copy and was not changed since the
    /// lending, it goes on with the copy. Otherwise the answer is [`Refusal::Busy`], and nothing is changed. No
    /// allocation.
    pub fn adopt(
        &mut self,
        lent: &mut Option<Box<Lent>>,
        known: &UncertainMode,
        modes: &[UncertainMode],
    ) -> RetuneOutcome {
        let axis = &mut self.axis;
        let fits = |lent: &&mut Lent| {
            lent.changes == axis.changes
                && lent.filter.ticks() == axis.filter.ticks()
                && lent.before == axis.filter.sent()
        };
        let mut outcome = RetuneOutcome::Refused(Refusal::Busy);
        if let Some(lent) = lent.as_deref_mut().filter(fits) {
            outcome = lent.outcome;
            if !matches!(outcome, RetuneOutcome::Refused(_)) {
                core::mem::swap(&mut lent.filter, &mut axis.filter);
            }
        }
        axis.retuned(outcome, known, modes);
        self.give_back(lent);
        outcome
    }
}
