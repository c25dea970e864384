//! A mass on a spring to ground, driven by a force; and the spring alone, driven by its deformation.

use super::chain::{Linear, MotorSide};
use super::kind::{Key, Kind};
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;
use std::f64::consts::TAU;

/// `x'' + 2 xi w x' + w^2 x = g w^2 F`: link position `x` for a force `F`; at rest `x = g F`.
///
/// A known force is added to `F`, in its unit; a known inertia `J` stands for `1 / (g w^2)`.
pub const OSCILLATOR: Kind = Kind {
    name: "oscillator",
    keys: &[
        Key {
            name: "natural_frequency_hz",
            quantity: Quantity::FREQUENCY,
            default: None,
            range: (1e-3, 1e6),
            // A frequency from a finite element model or a similar machine.
            belief: 0.1,
        },
        Key {
            name: "damping_ratio",
            quantity: Quantity::NUMBER,
            default: None,
            range: (1e-5, 1.0),
            // Damping is hardly ever known within a third.
            belief: 0.4,
        },
        Key {
            name: "gain",
            quantity: Quantity::new(-1, 1, 0),
            default: Some(1.0),
            range: (1e-12, 1e12),
            // A static compliance, from a drawing or a load test.
            belief: 0.2,
        },
    ],
    inputs: FORCES,
    outputs: &[
        Role::LinkPosition,
        Role::LinkAcceleration,
        Role::LinkVelocity,
    ],
    places: |_| {
        &[
            Place::Drive,
            Place::Transmission,
            Place::Link,
            Place::Sensor,
            Place::Environment,
        ]
    },
    takes: |_, _| true,
    // A force is band-limited by what makes and what samples it.
    hold: |_| Hold::Spline,
    linear: |p, _| {
        let &[frequency, xi, gain] = p else {
            return Linear::NONE;
        };
        let w = frequency * TAU;
        Linear {
            motor: MotorSide::Fixed,
            link: Some((1.0, 0.0)),
            stiffness: w * w,
            damping: 2.0 * xi * w,
            link_gain: gain * w * w,
            unit_force: w * w,
            ..Linear::NONE
        }
    },
    newton: |p| match p {
        &[frequency, _, gain] => Some(gain * (frequency * TAU).powi(2)),
        _ => None,
    },
    mode: Some((0, 1)),
    normalised: true,
    differentiates: false,
};

/// `F = k x + c x'`: the force that holds a spring and a damper in the motion `x`.
///
/// A known force `F_k` that pushes as well leaves `F = k x + c x' - F_k`.
pub const SPRING_AND_DAMPER: Kind = Kind {
    name: "oscillator",
    keys: &[
        Key {
            name: "stiffness",
            quantity: Quantity::new(1, -1, 0),
            default: None,
            range: (1e-12, 1e15),
            // Contact and mounting make more of it than a drawing shows.
            belief: 0.5,
        },
        Key {
            name: "viscous",
            quantity: Quantity::new(1, -1, 1),
            default: Some(0.0),
            range: (1e-12, 1e15),
            // Viscous friction changes by a factor with oil, temperature and wear.
            belief: 0.7,
        },
    ],
    inputs: &[Role::LinkPosition, Role::Deformation, Role::MotorPosition],
    outputs: FORCES,
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
        let &[stiffness, viscous] = p else {
            return Linear::NONE;
        };
        Linear {
            link: Some((1.0, 0.0)),
            link_is_input: true,
            stiffness,
            damping: viscous,
            ..Linear::NONE
        }
    },
    newton: |_| Some(1.0),
    mode: None,
    normalised: false,
    differentiates: false,
};

const FORCES: &[Role] = &[
    Role::Force,
    Role::Torque,
    Role::MotorVoltage,
    Role::MotorCurrent,
];
