//! A motor and a link, with a spring between them.

use super::chain::{Linear, MotorSide};
use super::kind::{Key, Kind};
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;

const INERTIA: Quantity = Quantity::new(1, -1, 2);
const DAMPING: Quantity = Quantity::new(1, -1, 1);

/// `J_m u'' = K I - B_m u' + k d + c d'`, `J_l y'' = -B_l y' - k d - c d'`, `d = y - u`: motor side `u`,
/// link `y`, current `I`; a torque drives it with `K = 1`.
///
/// A known force `F` is added to the second equation; a known inertia `J` stands there for `J_l`.
///
/// Source: Spong, Modeling and Control of Elastic Joint Robots, ASME J. Dynamic Systems, Measurement
/// and Control 109 (1987).
pub const TWO_MASS: Kind = Kind {
    name: "two_mass",
    keys: &[
        Key {
            name: "motor_inertia",
            quantity: INERTIA,
            default: None,
            range: (1e-12, 1e9),
            // A catalogue's rotor times the square of the ratio, and what else turns with it.
            belief: 0.3,
        },
        Key {
            name: "link_inertia",
            quantity: INERTIA,
            default: None,
            range: (1e-12, 1e9),
            // Moving parts are drawn; cables and what is bolted on are not.
            belief: 0.2,
        },
        Key {
            name: "motor_viscous",
            quantity: DAMPING,
            default: Some(0.0),
            range: (1e-9, 1e9),
            // Viscous friction changes by a factor with oil, temperature and wear; often it stands in
            // for all friction.
            belief: 1.0,
        },
        Key {
            name: "stiffness",
            quantity: Quantity::new(1, -1, 0),
            default: None,
            range: (1e-12, 1e15),
            // The parts between drawing and joint make it softer.
            belief: 0.4,
        },
        Key {
            // Torque for one unit of the current.
            name: "torque_constant",
            quantity: Quantity::GAIN,
            default: Some(1.0),
            range: (1e-12, 1e9),
            // Magnets and gear efficiency: within some percent of the catalogue.
            belief: 0.1,
        },
        Key {
            name: "link_viscous",
            quantity: DAMPING,
            default: Some(0.0),
            range: (1e-9, 1e9),
            belief: 1.0,
        },
        Key {
            name: "damping",
            quantity: DAMPING,
            default: Some(0.0),
            range: (1e-9, 1e9),
            belief: 1.0,
        },
    ],
    inputs: &[
        Role::MotorCurrent,
        Role::Torque,
        Role::Force,
        Role::MotorVoltage,
    ],
    outputs: &[
        Role::MotorPosition,
        Role::MotorVelocity,
        Role::Deformation,
        Role::LinkPosition,
        Role::LinkVelocity,
        Role::LinkAcceleration,
    ],
    places: |_| {
        &[
            Place::Drive,
            Place::Transmission,
            Place::Link,
            Place::Base,
            Place::Sensor,
            Place::Environment,
        ]
    },
    takes: |_, _| true,
    hold: |input| match input {
        Role::Torque | Role::Force => Hold::Linear,
        // An amplifier holds its current from tick to tick.
        _ => Hold::ZeroOrder,
    },
    linear: |p, input| {
        let &[
            motor_inertia,
            link_inertia,
            motor_viscous,
            stiffness,
            torque_constant,
            link_viscous,
            damping,
        ] = p
        else {
            return Linear::NONE;
        };
        Linear {
            motor: MotorSide::Free {
                inertia: motor_inertia,
                viscous: motor_viscous,
            },
            link: Some((link_inertia, link_viscous)),
            stiffness,
            damping,
            motor_gain: match input {
                Role::Torque | Role::Force => 1.0,
                _ => torque_constant,
            },
            ..Linear::NONE
        }
    },
    newton: |_| Some(1.0),
    mode: None,
    normalised: false,
    differentiates: false,
};
