//! Parameters that several effects have.

use super::grid::{order_bounds, phase_bounds, resonant_order, typical_time};
use super::{Parameter, ParameterRole, Quantity};

/// Dry friction: the force against sliding.
pub(super) const FRICTION: Parameter = Parameter {
    name: "friction",
    role: ParameterRole::Size,
    quantity: Quantity::FORCE,
    bounds: |scales| (0.0, scales.force),
    neutral: 0.0,
    typical: |scales| 0.05 * scales.force,
};

/// Breakaway over kinetic friction, less 1.
pub(super) const EXCESS: Parameter = Parameter {
    name: "excess",
    role: ParameterRole::Shape,
    quantity: Quantity::NUMBER,
    // Breakaway is not below kinetic friction.
    bounds: |_| (0.0, 5.0),
    neutral: 0.0,
    typical: |_| 0.5,
};

/// Velocity at which the excess has fallen by the factor e.
pub(super) const STRIBECK_VELOCITY: Parameter = Parameter {
    name: "stribeck_velocity",
    role: ParameterRole::Shape,
    quantity: Quantity::VELOCITY,
    bounds: |scales| {
        let (slow, fast) = speeds(scales.velocity, scales.deformation_rate);
        (1e-3 * slow, 3.0 * fast)
    },
    neutral: 1.0,
    typical: |scales| 0.1 * speeds(scales.velocity, scales.deformation_rate).0,
};

/// The slower and the faster of the two.
pub(super) fn speeds(a: f64, b: f64) -> (f64, f64) {
    (a.min(b), a.max(b))
}

/// Amplitude of a force that swings.
pub(super) const AMPLITUDE: Parameter = Parameter {
    name: "amplitude",
    role: ParameterRole::Size,
    quantity: Quantity::FORCE,
    bounds: |scales| (0.0, 2.0 * scales.force),
    neutral: 0.0,
    typical: |scales| 0.05 * scales.force,
};

/// Phase of a periodic effect, rad.
pub(super) const PHASE: Parameter = Parameter {
    name: "phase",
    role: ParameterRole::Phase,
    quantity: Quantity::NUMBER,
    bounds: phase_bounds,
    neutral: 0.0,
    typical: |_| 1.0,
};

/// Order of a periodic effect, in radians per unit of position.
pub(super) const ORDER: Parameter = Parameter {
    name: "order",
    role: ParameterRole::Order,
    quantity: Quantity::new(0, -1, 0),
    bounds: order_bounds,
    neutral: 1.0,
    typical: resonant_order,
};

/// Damping ratio of a further mode, which is not overdamped.
pub(super) const DAMPING_RATIO: Parameter = Parameter {
    name: "damping_ratio",
    role: ParameterRole::Shape,
    quantity: Quantity::NUMBER,
    bounds: |_| (0.0, 0.5),
    neutral: 0.0,
    typical: |_| 0.05,
};

/// What the damper of the joint does to a further mode, as a damping ratio.
pub(super) const DAMPING_COUPLING: Parameter = Parameter {
    name: "damping_coupling",
    role: ParameterRole::Shape,
    quantity: Quantity::NUMBER,
    bounds: |_| (-0.5, 0.5),
    neutral: 0.0,
    typical: |_| 0.03,
};

/// Instant of an event.
pub(super) const EVENT_TIME: Parameter = Parameter {
    name: "time",
    role: ParameterRole::Time,
    quantity: Quantity::TIME,
    bounds: |scales| scales.span,
    neutral: 0.0,
    typical: typical_time,
};

/// A pure delay.
pub(super) const DELAY: Parameter = Parameter {
    name: "delay",
    role: ParameterRole::Size,
    quantity: Quantity::TIME,
    bounds: |scales| (0.0, scales.period().max(20.0 * scales.sample_time)),
    neutral: 0.0,
    typical: |scales| 0.05 * scales.period(),
};

/// Time constant of a sensor's filter.
pub(super) const SENSOR_TIME_CONSTANT: Parameter = Parameter {
    name: "time_constant",
    role: ParameterRole::Size,
    quantity: Quantity::TIME,
    bounds: |scales| (0.0, 2.0 * scales.period()),
    neutral: 0.0,
    typical: |scales| 0.05 * scales.period(),
};
