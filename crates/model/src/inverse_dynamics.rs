//! The torque of a rigid axis for a motion.

use super::chain::Linear;
use super::kind::{Key, Kind};
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;

/// `F = m u'' + b u'`: the force or torque `F` that moves a mass as `u` was recorded.
///
/// A known force `F_k` and a known inertia `J` make it `F = (m + J) u'' + b u' - F_k`: `m` is then what moves with the motor
/// alone. Nothing is integrated, so that noise of the torque stays noise. The second derivative of the position is that of a
/// smoother whose bandwidth is the likeliest; what it may leave out counts as noise of the force. The force at rest is not used:
/// friction holds whatever it can bear there.
///
/// Source: Khalil and Dombre, Modeling, Identification and Control of Robots (2002), chapter 12.
pub const INVERSE_DYNAMICS: Kind = Kind {
    name: "inverse_dynamics",
    keys: &[
        Key {
            name: "mass",
            quantity: Quantity::new(1, -1, 2),
            default: None,
            range: (1e-9, 1e9),
            // Moving parts are weighed or drawn; what is bolted to them is less sure.
            belief: 0.2,
        },
        Key {
            name: "viscous",
            quantity: Quantity::new(1, -1, 1),
            default: Some(0.0),
            range: (1e-9, 1e9),
            // Viscous friction changes by a factor with oil, temperature and wear.
            belief: 0.7,
        },
    ],
    inputs: &[Role::LinkPosition, Role::MotorPosition],
    outputs: &[Role::Torque, Role::Force],
    places: |_| {
        &[
            Place::Transmission,
            Place::Link,
            Place::Sensor,
            Place::Environment,
        ]
    },
    takes: |_, _| true,
    hold: |_| Hold::Spline,
    linear: |p, _| {
        let &[mass, viscous] = p else {
            return Linear::NONE;
        };
        Linear {
            link: Some((mass, viscous)),
            link_is_input: true,
            held_inertia: mass,
            ..Linear::NONE
        }
    },
    newton: |_| Some(1.0),
    mode: None,
    normalised: false,
    differentiates: true,
};
