//! Where a plan goes.

use quell_trajectories::SampledTrajectory;

use super::joint::Joint;
use super::running::ROUNDING;
use crate::service::between::inexact;
use crate::service::contract::ServiceError;

#[cfg(test)]
impl super::Engine {
    /// Plans the first joint within another range (rad) than the tick keeps, as a fault of the service would.
    pub(in crate::service) fn mistake_range(&mut self, range: [f64; 2]) {
        self.joints[0].config.range = range;
    }
}

/// Checks that a plan stays within the joint's range, or between it and where the joint is. The command does then:
/// it is a mean of what was planned.
pub fn check_range(joint: &Joint, plan: &SampledTrajectory) -> Result<(), ServiceError> {
    let inexact = inexact(joint.config.limits, plan.period());
    let [low, high] = joint.config.range;
    let range = [low - inexact, high + inexact];
    if stays(plan, range) {
        return Ok(());
    }
    let [lowest, highest] = extent(plan.positions(0));
    Err(ServiceError::LeavesRange {
        joint: joint.config.name.clone(),
        position: match range[0] - lowest > highest - range[1] {
            true => lowest,
            false => highest,
        },
    })
}

/// The lowest and the highest of positions.
pub fn extent(positions: &[f64]) -> [f64; 2] {
    let fold = |of: fn(f64, f64) -> f64| positions.iter().copied().reduce(of).unwrap_or(f64::NAN);
    [fold(f64::min), fold(f64::max)]
}

/// Whether a plan stays within a range, or between it and where the plan begins.
pub fn stays(plan: &SampledTrajectory, [low, high]: [f64; 2]) -> bool {
    let positions = plan.positions(0);
    let from = positions.first().copied().unwrap_or(low);
    let [lowest, highest] = extent(positions);
    lowest >= low.min(from) - ROUNDING && highest <= high.max(from) + ROUNDING
}
