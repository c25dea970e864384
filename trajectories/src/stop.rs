//! A stop in a given time.

use crate::path::{STEPS, Step};
use crate::{AxisState, Limits};

/// Ten roundings: of the duration, a sum over the phases, and of the squares.
const ROUNDING: f64 = 10.0 * f64::EPSILON;

/// From a state to rest at jerk `s j`, a hold, and jerk `-s j`, where there is more time than the quickest ramp takes.
///
/// With `a` and the change of velocity `c / j`, `c = -s j v`, along the direction `s`, the held acceleration `A` above
/// `a` solves `A^2 - A (j T + a) + c + a^2 / 2 = 0`. Where less than `a` is enough, the jerk is `-s j` before the
/// hold, too: `A = (c - a^2 / 2) / (j T - a)`. A negative time, or one that is not a number, says that there is no
/// such stop.
pub(crate) fn stop(from: AxisState, limits: Limits, duration: f64) -> [Step; STEPS] {
    let jerk = limits.jerk;
    let (velocity, acceleration) = (from.velocity, from.acceleration);
    // Where the velocity ends if the acceleration only vanishes.
    let coasted = velocity + acceleration * acceleration.abs() / (2.0 * jerk);
    let direction = (-coasted).signum();
    let (along, change) = (direction * acceleration, -direction * jerk * velocity);
    let square = change + 0.5 * along * along;
    let reach = jerk * duration + along;
    // The quickest stop without a hold is a double root: what rounding leaves of it is not a hold.
    let root = match reach * reach - 4.0 * square {
        rest if rest > ROUNDING * reach * reach => rest.sqrt(),
        _ => 0.0,
    };
    let above = 2.0 * square / (reach + root);
    let (held, sign) = if above >= along {
        (above, direction)
    } else {
        let below = (change - 0.5 * along * along) / (jerk * duration - along);
        (below, -direction)
    };
    let (first, last) = ((held - along).abs() / jerk, held / jerk);
    let mut steps = [(0.0, 0.0); STEPS];
    steps[0] = (first, sign * jerk);
    steps[1] = (duration - first - last, 0.0);
    steps[2] = (last, -direction * jerk);
    steps
}
