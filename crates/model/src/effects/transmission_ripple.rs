//! Kinematic error of the transmission.

use super::grid::{PHASES, orders, product};
use super::shared_parameters::{ORDER, PHASE};
use super::{Effect, Law, Parameter, ParameterRole, Place, Property, Quantity, Slot};

/// The transmission passes on `u + A sin(N u + phase)` instead of `u`.
pub const TRANSMISSION_RIPPLE: Effect = Effect {
    name: "transmission_ripple",
    title: "transmission ripple",
    places: &[Place::Transmission],
    physics: "Teeth are not where they should be: the output is u + A sin(N u + phase), N periods in \
        2 pi of position, such as twice the gear ratio for a harmonic drive. The error shakes the \
        link most at the speed w / N. Source: Tuttle and Seering, IEEE Trans. Robotics and Automation \
        12 (1996); Ghorbel, Gandhi, Alpeter, ASME J. Mechanical Design 123 (2001).",
    remedy: "Look for an eccentric gear or a worn tooth at this period; correct the position by a \
        table.",
    parameters: &[
        Parameter {
            name: "amplitude",
            role: ParameterRole::Size,
            quantity: Quantity::POSITION,
            bounds: |scales| (0.0, scales.deformation),
            neutral: 0.0,
            typical: |scales| 0.03 * scales.deformation,
        },
        ORDER,
        PHASE,
    ],
    properties: &[Property::Slot(Slot::TransmissionError)],
    law: |p| {
        let (amplitude, order, phase) = (p[0], p[1], p[2]);
        Law::Kinematic(Box::new(move |u| {
            let (sin, cos) = (order * u + phase).sin_cos();
            [amplitude * sin, amplitude * order * cos]
        }))
    },
    starts: |scales| product(&[&[0.02 * scales.deformation], &orders(scales, 6), &PHASES]),
};
