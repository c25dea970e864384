//! The linear part of a chain, from the keys of a model.

use super::attachment::Attachment;
use crate::effects::{Motion, Place};

/// The motion of the motor side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorSide {
    /// Its position is the input.
    Prescribed,
    /// It stands still.
    Fixed,
    /// It has an inertia and moves under the forces.
    Free {
        /// Inertia, above 0.
        inertia: f64,
        /// Viscous friction, force per velocity.
        viscous: f64,
    },
}

/// A proportional position loop over a velocity loop: `F = K_v (K_p (r - u) - u')`, cut off at a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionLoop {
    /// `K_p`, 1/s.
    pub position_gain: f64,
    /// `K_v`, input per velocity.
    pub velocity_gain: f64,
    /// Largest output; infinite where there is none.
    pub limit: f64,
    /// Period of the controller, s. At its ticks it reads the position, computes the velocity by a backward
    /// difference and sets its output, which is then held. 0 for a continuous loop.
    pub sample_time: f64,
    /// Time of the difference for the velocity of a sampled loop, s: a whole number of periods, at least one.
    pub velocity_span: f64,
}

/// The linear chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// The motor side.
    pub motor: MotorSide,
    /// Inertia and ground damping of the link, if there is one.
    pub link: Option<(f64, f64)>,
    /// Whether the input is the link's position; the chain then gives the force that holds it there.
    pub link_is_input: bool,
    /// Inertia that such an input must accelerate, too.
    pub held_inertia: f64,
    /// Stiffness of the transmission in the equation's unit of force.
    pub stiffness: f64,
    /// Damping across the transmission.
    pub damping: f64,
    /// Force on the motor side for one unit of input.
    pub motor_gain: f64,
    /// Force on the link for one unit of input.
    pub link_gain: f64,
    /// The loop that computes the drive's input, if the input is a reference.
    pub position_loop: Option<PositionLoop>,
    /// A law's force of 1 in the equation's unit.
    pub unit_force: f64,
}

impl Linear {
    /// A chain without moving parts, as the base of the kinds.
    pub const NONE: Self = Self {
        motor: MotorSide::Fixed,
        link: None,
        link_is_input: false,
        held_inertia: 0.0,
        stiffness: 0.0,
        damping: 0.0,
        motor_gain: 0.0,
        link_gain: 0.0,
        position_loop: None,
        unit_force: 1.0,
    };

    /// What laws see of the chain at rest.
    pub fn at_rest(&self) -> Motion {
        let inertia = match (self.link, self.motor) {
            (Some((inertia, _)), _) | (None, MotorSide::Free { inertia, .. }) => inertia,
            (None, _) => 0.0,
        };
        Motion {
            stiffness: self.stiffness / self.unit_force,
            damping: self.damping / self.unit_force,
            inertia: inertia / self.unit_force,
            ..Motion::default()
        }
    }

    /// Attachment of a force at a place; a missing body is replaced by its neighbour.
    #[inline(always)]
    pub fn attachment(&self, place: Place) -> Attachment {
        match (place, self.link.is_some()) {
            (_, false) => Attachment::Motor,
            // A spring to ground: transmission and drive both act on the link.
            _ if self.motor == MotorSide::Fixed => Attachment::Link,
            (Place::Drive, _) => Attachment::Motor,
            (Place::Transmission, _) => Attachment::Across,
            _ => Attachment::Link,
        }
    }
}
