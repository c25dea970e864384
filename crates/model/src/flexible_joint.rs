//! A flexible joint driven by its motor side.

use super::chain::{Linear, MotorSide};
use super::kind::{Key, Kind};
use super::piecewise::Hold;
use crate::effects::{Place, Quantity};
use quell_recording::Role;
use std::f64::consts::TAU;

/// `y'' = w^2 (u - y) + 2 xi w (u' - y')`: link position `y`, motor side position `u`.
///
/// The damper sits across the joint; one to ground is the effect `viscous_drag`. With a known force `F` and a known
/// inertia `J` it is `J y'' = k (u - y) + c (u' - y') + F`, `k = w^2 link_inertia`.
pub const FLEXIBLE_JOINT: Kind = Kind {
    name: "flexible_joint",
    keys: &[
        Key {
            name: "natural_frequency_hz",
            quantity: Quantity::FREQUENCY,
            default: None,
            range: (1e-3, 1e4),
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
            name: "lever_arm_m",
            quantity: Quantity::NUMBER,
            default: Some(1.0),
            range: (1e-6, 1e3),
            belief: 0.0,
        },
        Key {
            name: "tip_height_m",
            quantity: Quantity::NUMBER,
            default: Some(0.0),
            range: (-1e3, 1e3),
            belief: 0.0,
        },
        Key {
            // Only beside a known force or inertia: the motion of the motor side alone does not show it.
            name: "link_inertia",
            quantity: Quantity::new(1, -1, 2),
            default: Some(0.0),
            range: (1e-12, 1e9),
            belief: 0.0,
        },
    ],
    inputs: &[
        Role::MotorPosition,
        // Where the motor side has only a velocity it is integrated.
        Role::MotorVelocity,
        Role::CommandPosition,
    ],
    outputs: &[
        Role::LinkPosition,
        Role::Deformation,
        Role::TipPosition,
        Role::LinkAcceleration,
        Role::TipAcceleration,
    ],
    places: |input| match input {
        // What the drive does is already inside a measured motor side.
        Role::MotorPosition | Role::MotorVelocity => &[
            Place::Transmission,
            Place::Link,
            Place::Base,
            Place::Sensor,
            Place::Environment,
        ],
        _ => &[
            Place::Drive,
            Place::Transmission,
            Place::Link,
            Place::Base,
            Place::Sensor,
            Place::Environment,
        ],
    },
    takes: |_, _| true,
    hold: |_| Hold::Spline,
    linear: |p, _| {
        let (w, xi) = (p[0] * TAU, p[1]);
        Linear {
            motor: MotorSide::Prescribed,
            link: Some((1.0, 0.0)),
            stiffness: w * w,
            damping: 2.0 * xi * w,
            unit_force: w * w,
            ..Linear::NONE
        }
    },
    newton: |p| {
        let own = p.get(4).copied().filter(|inertia| *inertia > 0.0);
        own.map(f64::recip)
    },
    mode: Some((0, 1)),
    normalised: true,
    differentiates: false,
};
