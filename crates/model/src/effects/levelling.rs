//! The course of a drift that levels off.

use super::{Parameter, ParameterRole, Quantity};

/// `(1 - exp(-s t)) / s`, or `t` for `s = 0`: the initial slope is 1, and it levels off at `1 / s`.
pub(crate) fn levelling(time: f64, settling: f64) -> f64 {
    match settling == 0.0 {
        true => time,
        false => -(-settling * time).exp_m1() / settling,
    }
}

/// The rate at which a drift levels off. The time constant is at least a twentieth of the recording: a shorter
/// one is a step.
pub(super) const SETTLING_RATE: Parameter = Parameter {
    name: "settling_rate",
    role: ParameterRole::Shape,
    quantity: Quantity::FREQUENCY,
    bounds: |scales| (0.0, 20.0 / scales.duration()),
    neutral: 0.0,
    typical: |scales| 1.0 / scales.duration(),
};
