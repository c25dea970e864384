//! How far a drift has come that slows down.

/// `(1 - exp(-s t)) / s`, which is `t` where nothing slows it down (`s = 0`): it begins with the slope 1
/// and levels off at `1 / s`.
pub(super) fn levelling(time: f64, settling: f64) -> f64 {
    match settling == 0.0 {
        true => time,
        false => -(-settling * time).exp_m1() / settling,
    }
}

/// A drift slows down within a twentieth of the recording at the soonest: sooner it is a step.
pub(super) fn settling_bounds(duration: f64) -> (f64, f64) {
    (0.0, 20.0 / duration)
}
