//! A mass that a force moves: an axis whose transmission is stiff.

use super::chain::{Linear, MotorSide, PositionLoop};
use super::kind::{Key, Kind};
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;

/// `m u'' = g F - b u'`: motor side position `u`, force, torque, current or voltage `F`.
///
/// With a position loop in the model the input is its reference `r`: `F = K_v (K_p (r - u) - u')`, cut
/// off at `output_limit`; where `loop_sample_time_s` is above 0, as a controller with that period
/// computes it, its output held and its velocity the backward difference over one period, or over
/// `loop_velocity_span_s` where that is longer. Delay, lag and rate limit of the drive then act on its reference, and what has
/// no memory on the loop's output.
///
/// A known force `F_k` and a known inertia `J` make it `(m + J) u'' = g F - b u' + F_k`: `m` is then what moves with the
/// motor alone.
///
/// Source: Janot, Gautier, Brunot, Data set and reference models of EMPS, Workshop on Nonlinear System
/// Identification Benchmarks (2019), for axis and loop.
pub const RIGID_AXIS: Kind = Kind {
    name: "rigid_axis",
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
        Key {
            // Force for one unit of the input.
            name: "force_gain",
            quantity: Quantity::GAIN,
            default: Some(1.0),
            range: (1e-9, 1e9),
            // With the mass free, the motion shows only gain / mass.
            belief: 0.0,
        },
        Key {
            name: "position_gain",
            quantity: Quantity::FREQUENCY,
            default: Some(0.0),
            range: (1e-6, 1e6),
            // A gain that somebody typed in is known.
            belief: 0.0,
        },
        Key {
            name: "velocity_gain",
            quantity: Quantity::new(1, -1, 1),
            default: Some(0.0),
            range: (1e-9, 1e9),
            belief: 0.0,
        },
        Key {
            name: "output_limit",
            quantity: Quantity::FORCE,
            default: Some(f64::INFINITY),
            range: (1e-12, f64::INFINITY),
            belief: 0.0,
        },
        Key {
            name: "loop_sample_time_s",
            quantity: Quantity::TIME,
            default: Some(0.0),
            range: (1e-9, 1.0),
            belief: 0.0,
        },
        Key {
            // The mean of several backward differences is the difference over their time.
            name: "loop_velocity_span_s",
            quantity: Quantity::TIME,
            default: Some(0.0),
            range: (1e-9, 1.0),
            belief: 0.0,
        },
    ],
    // A loop in the model is there to be used: under feedback an open-loop replay drifts away.
    inputs: &[
        Role::CommandPosition,
        Role::Force,
        Role::Torque,
        Role::MotorCurrent,
        Role::MotorVoltage,
    ],
    outputs: &[
        Role::MotorPosition,
        Role::MotorVelocity,
        Role::Force,
        Role::Torque,
    ],
    places: |_| {
        &[
            Place::Drive,
            // The payload and what drags it: they move with the motor side.
            Place::Link,
            Place::Sensor,
            Place::Environment,
        ]
    },
    takes: |p, input| input != Role::CommandPosition || p[3] > 0.0 && p[4] > 0.0,
    hold: |input| match input {
        Role::Force | Role::Torque => Hold::Linear,
        // A controller holds its output, and reads its reference, from tick to tick.
        _ => Hold::ZeroOrder,
    },
    linear: |p, input| {
        let &[
            mass,
            viscous,
            force_gain,
            position_gain,
            velocity_gain,
            limit,
            sample_time,
            velocity_span,
        ] = p
        else {
            return Linear::NONE;
        };
        let under_loop = input == Role::CommandPosition;
        Linear {
            motor: MotorSide::Free {
                inertia: mass,
                viscous,
            },
            motor_gain: force_gain,
            position_loop: under_loop.then_some(PositionLoop {
                position_gain,
                velocity_gain,
                limit,
                sample_time,
                velocity_span,
            }),
            ..Linear::NONE
        }
    },
    newton: |_| Some(1.0),
    mode: None,
    normalised: false,
    differentiates: false,
};
