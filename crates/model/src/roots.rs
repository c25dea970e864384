//! The instant in a step at which something changes its sign.

/// The share in (0, `high`) at which a function falls through 0, given `f(high) < 0`: the Illinois variant of
/// false position. `None` if the function is nowhere above 0.
///
/// If it starts at 0, for example the velocity after a release, it is first followed upwards.
pub(super) fn first_root(f: impl Fn(f64) -> f64, mut high: f64) -> Option<f64> {
    let (mut low, mut at_low) = (0.0, f(0.0));
    let mut at_high = f(high);
    while at_low <= 0.0 {
        low = 0.5 * high;
        at_low = f(low);
        if at_low <= 0.0 {
            (high, at_high) = (low, at_low);
        }
        if low < SHORTEST {
            return None;
        }
    }
    // In the long run each round at least halves the bracket; a few are usual.
    for _ in 0..60 {
        if high - low < RESOLUTION || at_high == 0.0 {
            break;
        }
        let share = (low * at_high - high * at_low) / (at_high - at_low);
        let value = f(share);
        if value > 0.0 {
            (low, at_low) = (share, value);
            at_high *= 0.5;
        } else {
            (high, at_high) = (share, value);
            at_low *= 0.5;
        }
    }
    Some(high)
}

/// Shortest duration of an event, as a share of a step; shorter ones are ignored.
const SHORTEST: f64 = 1e-9;

/// Accuracy of a root, as a share of a step; the step itself is no more accurate.
const RESOLUTION: f64 = 1e-10;

/// The first share at which the parabola through values at 0, 1/2 and 1 falls through 0, if one of the
/// last two is below 0.
pub(super) fn root_of_parabola([start, middle, end]: [f64; 3]) -> f64 {
    if start <= 0.0 {
        return 0.0;
    }
    // start + b s + a s^2.
    let a = 2.0 * (start - 2.0 * middle + end);
    let b = end - start - a;
    let root = (b * b - 4.0 * a * start).max(0.0).sqrt();
    // The smaller positive root, without cancellation.
    let share = match b < 0.0 {
        true => 2.0 * start / (-b + root),
        false => (-b - root) / (2.0 * a),
    };
    if share.is_finite() {
        share.clamp(0.0, 1.0)
    } else {
        1.0
    }
}
