//! The steps of constant jerk into which a motion is divided.

use quell_trajectories::AxisProfile;

/// Number of steps with jerk. With 48 to 128 of them a problem takes 5 to 20 ms.
const STEPS: (f64, f64) = (48.0, 128.0);

/// A step of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Its duration, s.
    pub duration: f64,
    /// Whether it has no jerk. Then it may be long: the cruise, a long acceleration.
    pub without_jerk: bool,
}

/// Steps of a motion of a duration (s), which is at least that of the unshaped plan; about as short as `fine` s.
///
/// A motion that lasts `d` longer than the fastest one is nowhere more than `d` behind it. So a ramp of its acceleration begins at most `d` before
/// that of the plan, for a later one that is longer, and its mean is at most `d` later. From `d` before a ramp of the plan to `2 d` after it
/// the steps are short. Between these stretches, where they leave a gap, one step has no jerk.
pub fn steps(plan: &AxisProfile, duration: f64, fine: f64) -> Vec<Step> {
    let phases = plan.phases();
    let planned: f64 = phases.iter().map(|phase| phase.duration).sum();
    let longer = duration - planned;
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    for phase in phases.iter().filter(|phase| phase.jerk != 0.0) {
        let from = (phase.start - longer).max(0.0);
        let to = (phase.start + phase.duration + 2.0 * longer).min(duration);
        match stretches.last_mut() {
            Some(last) if from - last[1] < fine => last[1] = to,
            _ => stretches.push([from, to]),
        }
    }
    let total: f64 = stretches.iter().map(|[from, to]| to - from).sum();
    let step = total / (total / fine).clamp(STEPS.0, STEPS.1).floor();
    let mut steps = Vec::new();
    let mut at = 0.0;
    for [from, to] in stretches {
        if from > at {
            steps.push(Step {
                duration: from - at,
                without_jerk: true,
            });
        }
        let count = ((to - from) / step).round().max(1.0);
        let short = Step {
            duration: (to - from) / count,
            without_jerk: false,
        };
        steps.extend(core::iter::repeat_n(short, count as usize));
        at = to;
    }
    steps
}
