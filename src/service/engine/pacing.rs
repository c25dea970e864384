//! How a plan that runs is run through: its rate, and the feed that is the reason for it.

use quell_trajectories::{RateRamp, SampledTrajectory};

/// How a plan is run through.
pub struct Pacing {
    /// The plan as it was made.
    pub base: SampledTrajectory,
    /// The feed at which it was made.
    pub made_at: f64,
    /// The feed that it goes on with.
    pub feed: f64,
    /// The last change of its rate.
    pub ramp: RateRamp,
    /// The sample of the running plan with which that began.
    pub since: usize,
}

impl Pacing {
    /// A plan that was made at a feed.
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
    /// Number of the plan that makes it.
    pub ticket: u64,
    /// The feed.
    pub feed: f64,
    /// The way of the rate there.
    pub ramp: RateRamp,
    /// The rest of the plan.
    pub rest: SampledTrajectory,
}
