//! How far a drift has come that slows down.

use super::{Parameter, ParameterRole, Quantity};

/// `(1 - exp(-s t)) / s`, which is `t` where nothing slows it down (`s = 0`): it begins with the slope 1
/// and levels off at `1 / s`.
pub(super) fn levelling(time: f64, settling: f64) -> f64 {
    match settling == 0.0 {
        true => time,
        false => -(-settling * time).exp_m1() / settling,
    }
}

/// The rate at which a drift settles. It slows down within a twentieth of the recording at the soonest: sooner
/// it is a step.
pub(super) const SETTLING_RATE: Parameter = Parameter {
    name: "settling_rate",
    role: ParameterRole::Shape,
    quantity: Quantity::FREQUENCY,
    bounds: |scales| (0.0, 20.0 / scales.duration()),
    neutral: 0.0,
    typical: |scales| 1.0 / scales.duration(),
};
