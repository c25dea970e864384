//! Kinematic error of the transmission, of any shape.

use super::learned::{FINER, PARAMETERS, ordinate, parameters, spline, start};
use super::{Effect, Law, Parameter, Place, Property, Quantity, Slot};

const ERROR: Parameter = ordinate(
    Quantity::POSITION,
    |scales| (-scales.deformation, scales.deformation),
    |scales| 0.03 * scales.deformation,
);

/// The transmission passes on `u + f(u)` instead of `u`.
pub const LEARNED_TRANSMISSION_ERROR: Effect = Effect {
    parameters: &parameters::<PARAMETERS>(ERROR, Quantity::POSITION),
    properties: &[
        Property::Slot(Slot::TransmissionError),
        Property::Finer(&FINE),
    ],
    starts: |scales| vec![start::<PARAMETERS>(scales.visited_motor_position())],
    ..FINE
};

/// The same with finer knots, for several teeth within the travel.
const FINE: Effect = Effect {
    name: "learned_transmission_error",
    title: "learned transmission error",
    places: &[Place::Transmission],
    physics: "The output of the transmission is u + f(u) at the position u of the motor side: teeth, a wave generator or a \
        screw's lead are not where they should be, and the error has harmonics. The curve is learned: a cubic spline through \
        its values at equally spaced positions, constant outside of what was visited. What has more periods in the travel than \
        the curve has points is transmission ripple. Source: Tuttle and Seering, IEEE Trans. Robotics and Automation 12 (1996); \
        Ghorbel, Gandhi, Alpeter, ASME J. Mechanical Design 123 (2001).",
    remedy: "Correct the motor's position by the curve as a table; look for an eccentric gear or a worn tooth.",
    parameters: &parameters::<FINER>(ERROR, Quantity::POSITION),
    properties: &[Property::Slot(Slot::TransmissionError)],
    law: |p| {
        let error = spline(p);
        Law::Kinematic(Box::new(move |u| error.held(u)))
    },
    starts: |scales| vec![start::<FINER>(scales.visited_motor_position())],
};
