//! The linear part of a chain: what the keys of a model say.

use super::attachment::Attachment;
use crate::effects::Place;

/// The motion of the motor side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotorSide {
    /// Its position is the input.
    Prescribed,
    /// It stands still.
    Fixed,
    /// It has an inertia and moves as the forces make it.
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
    /// Period of the controller, s: it reads the position at its ticks, takes the backward difference
    /// for the velocity and holds its output. 0 for a loop that never sleeps.
    pub sample_time: f64,
    /// Time over which a sampled loop takes the difference for the velocity, s: a whole number of periods,
    /// at least one.
    pub velocity_span: f64,
}

/// The linear chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear {
    /// The motor side.
    pub motor: MotorSide,
    /// Inertia and ground damping of the link, if there is one.
    pub link: Option<(f64, f64)>,
    /// Whether the input is the link's position; the chain then says what force holds it there.
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
    /// The loop that makes the input, if the input is a reference.
    pub position_loop: Option<PositionLoop>,
    /// A law's force of 1 in the equation's unit.
    pub unit_force: f64,
}

impl Linear {
    /// Nothing that moves: what a kind starts from.
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

    /// Where a force at a place acts: one that is missing is where its neighbour is.
    #[inline(always)]
    pub fn attachment(&self, place: Place) -> Attachment {
        match (place, self.link.is_some()) {
            (_, false) => Attachment::Motor,
            // A spring to ground: what is across it is at the link, and so is the drive.
            _ if self.motor == MotorSide::Fixed => Attachment::Link,
            (Place::Drive, _) => Attachment::Motor,
            (Place::Transmission, _) => Attachment::Across,
            _ => Attachment::Link,
        }
    }
}
