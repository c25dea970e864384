//! The rate of a running plan, and the feed behind it.

use quell_trajectories::{RateRamp, SampledTrajectory};

/// The rate of a plan.
pub struct Pacing {
    /// The plan as it was created.
    pub base: SampledTrajectory,
    /// The feed at which it was created.
    pub made_at: f64,
    /// The feed with which it continues.
    pub feed: f64,
    /// The last change of its rate.
    pub ramp: RateRamp,
    /// The sample of the running plan at which that began.
    pub since: usize,
}

impl Pacing {
    /// The pacing of a plan that was created at a feed.
    pub fn new(base: SampledTrajectory, feed: f64) -> Self {
        Self {
            base,
            made_at: feed,
            feed,
            ramp: RateRamp::steady(1.0),
            since: 0,
        }
    }

    /// A change of the rate at a sample of the running plan.
    pub fn changed_at(&self, sample: usize) -> RateRamp {
        let gone = sample.saturating_sub(self.since) as f64 * self.base.period();
        let from = self.ramp.after(gone);
        RateRamp {
            from,
            to: from.rate,
            duration: 0.0,
        }
    }
}

/// A change of the feed that the tick has not answered.
pub struct Change {
    /// Number of the plan that contains it.
    pub ticket: u64,
    /// The rate from then on.
    pub pacing: Pacing,
    /// The rest of the plan.
    pub rest: SampledTrajectory,
}
