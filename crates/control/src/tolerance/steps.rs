//! The steps of constant jerk into which a motion is divided.

use quell_trajectories::AxisProfile;

/// Number of steps with jerk. With 48 to 128 of them a problem takes 5 to 50 ms.
const STEPS: (f64, f64) = (48.0, 128.0);
/// Length of the longest even steps, in short ones: a third of a period of the fastest mode.
const EVENLY: f64 = 4.0;

/// A step of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Its duration, s.
    pub duration: f64,
    /// Whether it has no jerk. Then it may be long: the cruise, a long acceleration.
    pub without_jerk: bool,
}

/// Steps of a motion of a duration (s), which is not below that of the fastest plan; short ones last about `short` s.
///
/// Where even steps would be too long, the short ones are where the [ramps](stretches) of the acceleration may be, and
/// one step without jerk is between two stretches of them.
pub fn steps(plan: &AxisProfile, duration: f64, short: f64) -> Vec<Step> {
    let stretches = if duration <= EVENLY * STEPS.1 * short {
        vec![[0.0, duration]]
    } else {
        stretches(plan, duration, short)
    };
    let total: f64 = stretches.iter().map(|[from, to]| to - from).sum();
    let step = total / (total / short).clamp(STEPS.0, STEPS.1).floor();
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
        let one = Step {
            duration: (to - from) / count,
            without_jerk: false,
        };
        steps.extend(core::iter::repeat_n(one, count as usize));
        at = to;
    }
    steps
}

/// Stretches of time around the ramps of the plan, less than `gap` s apart joined: from `d` before a ramp to `2 d` after it, where the
/// motion lasts `d` longer than the plan.
///
/// Such a motion is nowhere more than `d` behind the plan. A ramp is longer by a train of mean delay `d`, which is `2 d` long, or begins
/// `d` earlier and ends `d` later, as the last one does where only that is shaped.
fn stretches(plan: &AxisProfile, duration: f64, gap: f64) -> Vec<[f64; 2]> {
    let planned: f64 = plan.phases().iter().map(|phase| phase.duration).sum();
    let longer = duration - planned;
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    for phase in plan.phases().iter().filter(|phase| phase.jerk != 0.0) {
        let from = (phase.start - longer).max(0.0);
        let to = (phase.start + phase.duration + 2.0 * longer).min(duration);
        match stretches.last_mut() {
            Some(last) if from - last[1] < gap => last[1] = to,
            _ => stretches.push([from, to]),
        }
    }
    stretches
}
