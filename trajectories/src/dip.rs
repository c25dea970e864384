//! A short move whose acceleration dips on its way and never rests at zero.

use crate::path::{STEPS, Step};
use crate::{AxisState, Limits};

/// Jerk `-s j`, then `s j`, a hold at the limit of the acceleration if it gets there, then `-s j`: the quickest move
/// to a target just beyond where the axis can come to rest, for example. `side` is `s`. A negative time, or one that
/// is not a number, says that there is no such move.
///
/// With the dip `b` and the peak `A` of the acceleration (both times `s`), `w = (j T - a_0 + a_1) / 2` and
/// `q = s j (v_1 - v_0) - (a_0^2 - a_1^2) / 2`: without a hold `A - b = w` and `A^2 - b^2 = q`; with `A` at its limit
/// `(A - b)^2 = 2 A w - q`, and the hold takes what is left of the duration `T`.
pub(crate) fn dip(
    from: AxisState,
    to: AxisState,
    limits: Limits,
    duration: f64,
    side: f64,
) -> [Step; STEPS] {
    let (jerk, limit) = (limits.jerk, limits.acceleration);
    let (a0, a1) = (side * from.acceleration, side * to.acceleration);
    let change = side * jerk * (to.velocity - from.velocity);
    let width = 0.5 * (jerk * duration - a0 + a1);
    let squares = change - 0.5 * (a0 * a0 - a1 * a1);
    let free = 0.5 * (squares / width + width);
    let (peak, height) = if free <= limit {
        (free, width)
    } else {
        (limit, (2.0 * limit * width - squares).sqrt())
    };
    let bottom = peak - height;
    let hold = duration - (a0 - a1 + 2.0 * height) / jerk;
    let mut steps = [(0.0, 0.0); STEPS];
    steps[0] = ((a0 - bottom) / jerk, -side * jerk);
    steps[1] = (height / jerk, side * jerk);
    steps[2] = (hold, 0.0);
    steps[3] = ((peak - a1) / jerk, -side * jerk);
    steps
}
