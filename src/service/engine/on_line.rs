//! The stop of joints that move on a straight line together: on that line.
//!
//! Joint `i` is at `x_i = a_i + d_i s(t)`. With limits `c |d_i|`, where `c` is the least of `limit_k / |d_k|` over all of
//! them, the limits of `s` are the same for each joint, and so the stops are one plan of `s`. It takes as long as
//! the longest of the stops that each would make alone: the line costs no time.

use quell_trajectories::Limits;

use super::Engine;
use super::learned::WITHIN;
use super::running::Running;

impl Engine {
    /// Limits with which a joint is stopped: its own, or less where it moves on a straight line with others.
    pub(super) fn braking(&self, index: usize) -> Limits {
        let own = self.joints[index].config.limits;
        let Some((group, way)) = self.joints[index].running.as_ref().and_then(line) else {
            return own;
        };
        let others = self.joints.iter().filter_map(|joint| {
            let (its_group, its_way) = joint.running.as_ref().and_then(line)?;
            (its_group == group).then_some((joint.config.limits, way / its_way))
        });
        others.fold(own, |least, (limits, share)| Limits {
            velocity: least.velocity.min(share * limits.velocity),
            acceleration: least.acceleration.min(share * limits.acceleration),
            jerk: least.jerk.min(share * limits.jerk),
        })
    }
}

/// The group with which a joint moves on a line, and its own way on it, rad. A move with trains is not on a line.
fn line(running: &Running) -> Option<(u64, f64)> {
    let way = (running.start.target_rad - running.start.from_rad).abs();
    let group = running.together?;
    (running.start.shaper == WITHIN && way > 0.0).then_some((group, way))
}
