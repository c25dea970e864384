//! The axis as a chain: motor side, transmission, link, with laws at their places.
//!
//! ```text
//! J_m u'' = g_m F - B_m u' + k d + c d' - drive forces + transmission forces
//! J_l y'' = g_l F - B_l y' - k d - c d' - link forces  - transmission forces,     d = y - u
//! ```
//!
//! A motor side whose motion was measured by an encoder is prescribed; one that stands still is fixed; an axis
//! without a spring has no link.

use super::attachment::Attachment;
use super::bodies::Bodies;
use super::coupling::Pull;
pub use super::linear::{Linear, MotorSide, PositionLoop};
use crate::effects::{Force, Friction, Impulse, Inertia, Memory, Motion, Place};

/// A force law at a place, and its memory.
pub struct ForceElement {
    /// Where it acts.
    pub place: Place,
    /// Its law.
    pub law: Box<dyn Force>,
    /// Its memory.
    pub memory: Memory,
}

/// Dry friction at a place, and whether it sticks.
pub struct FrictionElement {
    /// Where it acts.
    pub place: Place,
    /// Its force.
    pub law: Friction,
    /// 0 sticks, otherwise the sign of the slip velocity.
    pub slides: f64,
}

/// Chain and laws.
pub struct Chain {
    /// The linear part.
    pub linear: Linear,
    /// Forces.
    pub forces: Vec<ForceElement>,
    /// Dry friction.
    pub frictions: Vec<FrictionElement>,
    /// Changes of the link's inertia; the motor side's where there is no link.
    pub inertias: Vec<Box<dyn Inertia>>,
    /// Impulses that last.
    pub impulses: Vec<Impulse>,
    /// Transmission errors.
    pub kinematics: Vec<Box<dyn Fn(f64) -> [f64; 2] + Send + Sync>>,
    /// Static maps of the drive inside the loop.
    pub maps: Vec<Box<dyn crate::effects::Drive>>,
    /// The output of a sampled loop since its last tick.
    pub held: Option<f64>,
    /// Coupling of a free motor side to its measured motion.
    pub pull: Option<Pull>,
}

/// Position and velocity of motor side and link.
pub type State = [f64; 4];

/// Quantities of the chain at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// Positions and velocities; the motor side as the transmission sees it.
    pub motion: Motion,
    /// Position and velocity of the motor side, as an encoder sees it.
    pub encoder: [f64; 2],
    /// Acceleration of the motor side.
    pub motor: f64,
    /// Acceleration of the link.
    pub link: f64,
    /// Force of the drive on the motor side; where the link's position is the input, the force that holds it
    /// there. In the equation's unit.
    pub force: f64,
    /// Forces of sticking friction at each attachment, in the equation's unit.
    pub holding: [f64; 3],
}

impl Chain {
    /// The linear chain alone.
    pub fn new(linear: Linear) -> Self {
        Self {
            linear,
            forces: Vec::new(),
            frictions: Vec::new(),
            inertias: Vec::new(),
            impulses: Vec::new(),
            kinematics: Vec::new(),
            maps: Vec::new(),
            held: None,
            pull: None,
        }
    }

    /// Whether there is nothing but the linear chain.
    pub(super) fn is_linear(&self) -> bool {
        self.forces.is_empty()
            && self.frictions.is_empty()
            && self.inertias.is_empty()
            && self.impulses.is_empty()
            && self.kinematics.is_empty()
            && self.linear.position_loop.is_none()
    }

    /// Motion of the chain for an input (value, rate, second derivative) at a time, and the prescribed
    /// acceleration of the motor side.
    pub fn motion(&self, time: f64, state: &State, input: [f64; 3]) -> (Motion, f64) {
        let constants = Constants::new(&self.linear);
        let found = self.position::<true>(&constants, time, state, input);
        (found.motion, found.bias[0])
    }

    /// Accelerations at a state, friction as it presently slides or sticks.
    pub fn instant(&self, time: f64, state: &State, input: [f64; 3]) -> Instant {
        let constants = Constants::new(&self.linear);
        self.evaluate::<true>(&constants, time, state, input)
    }

    /// Positions at a state. A linear chain evaluates no laws.
    #[inline(always)]
    pub(super) fn position<const LAWS: bool>(
        &self,
        constants: &Constants,
        time: f64,
        state: &State,
        input: [f64; 3],
    ) -> Position {
        let linear = &self.linear;
        let (encoder, prescribed) = match linear.motor {
            MotorSide::Prescribed => ([input[0], input[1]], input[2]),
            MotorSide::Fixed => ([0.0; 2], 0.0),
            MotorSide::Free { .. } => {
                let own = [state[0], state[1]];
                let pulled = |pull: &Pull| pull.acceleration(time, own);
                (own, self.pull.as_ref().map_or(0.0, pulled))
            }
        };
        let (mut motor, mut ratio) = (encoder, 1.0);
        if LAWS {
            for error in &self.kinematics {
                let [value, slope] = error(motor[0]);
                motor = [motor[0] + value, motor[1] * (1.0 + slope)];
                ratio *= 1.0 + slope;
            }
        }
        let (link, bias) = match linear.link {
            None => (motor, 0.0),
            Some(_) if linear.link_is_input => ([input[0], input[1]], input[2]),
            Some(_) => ([state[2], state[3]], 0.0),
        };
        Position {
            motion: Motion {
                time,
                motor,
                link,
                ..constants.at_rest
            },
            encoder,
            ratio,
            bias: [prescribed * ratio, bias],
        }
    }

    /// The quantities of a state; `constants` do not change during the motion.
    #[inline(always)]
    pub(super) fn evaluate<const LAWS: bool>(
        &self,
        constants: &Constants,
        time: f64,
        state: &State,
        input: [f64; 3],
    ) -> Instant {
        let linear = &self.linear;
        let Position {
            motion,
            encoder,
            ratio,
            bias,
        } = self.position::<LAWS>(constants, time, state, input);
        let link = motion.link;
        let [d, rate] = motion.deformation();
        let elastic = linear.stiffness * d + linear.damping * rate;
        let drive = if LAWS {
            self.drive(encoder, input[0])
        } else {
            input[0]
        };
        let mut bodies = Bodies {
            force: [
                linear.motor_gain * drive - constants.viscous[0] * encoder[1],
                linear.link_gain * drive - constants.viscous[1] * link[1],
            ],
            mobility: constants.mobility,
            bias,
        };
        bodies.resist(Attachment::Across, elastic, ratio);
        let mut instant = Instant {
            motion,
            encoder,
            force: linear.motor_gain * drive,
            ..Instant::default()
        };
        if LAWS {
            instant.holding = self.resist(&motion, ratio, &mut bodies);
        }
        if linear.link_is_input {
            instant.force = -bodies.force[1];
            if linear.held_inertia > 0.0 {
                instant.force += linear.held_inertia * self.reshaped(&motion, bias[1]);
            }
        }
        instant.motor = bodies.acceleration(0);
        instant.link = bodies.acceleration(1);
        instant
    }

    /// Adds the forces of the laws to the bodies; returns the forces of sticking friction.
    #[inline(always)]
    fn resist(&self, motion: &Motion, ratio: f64, bodies: &mut Bodies) -> [f64; 3] {
        let unit = self.linear.unit_force;
        let body = usize::from(self.linear.link.is_some());
        // Before laws change the inertia, which the size of an impulse is told without.
        if bodies.mobility[body] > 0.0 {
            let each = self
                .impulses
                .iter()
                .map(|own| own.acceleration(motion.time));
            bodies.force[body] += each.sum::<f64>() / bodies.mobility[body];
        }
        for element in &self.forces {
            let attachment = self.attachment(element.place);
            let [x, v] = coordinate(attachment, motion);
            let [force, inertia] = element.law.load(motion, x, v, &element.memory);
            bodies.resist(attachment, unit * force, ratio);
            if inertia != 0.0 {
                bodies.load(attachment, unit * inertia);
            }
        }
        for inertia in &self.inertias {
            bodies.reshape(inertia.as_ref(), motion, body);
        }
        if self.frictions.is_empty() {
            return [0.0; 3];
        }
        let mut sticks = [false; 3];
        for element in &self.frictions {
            let attachment = self.attachment(element.place);
            if element.slides == 0.0 {
                sticks[attachment as usize] = true;
            } else {
                // Negative within a step that ends at a stop: the level continues without a corner.
                let speed = element.slides * coordinate(attachment, motion)[1];
                let force = element
                    .law
                    .level(element.slides, position(attachment, motion), speed);
                bodies.resist(attachment, unit * element.slides * force, ratio);
            }
        }
        // Sticking friction holds against forces. The coupling is no force and must not break it away.
        if sticks[Attachment::Motor as usize] && self.pull.is_some() {
            bodies.bias[0] = 0.0;
        }
        bodies.hold(sticks)
    }

    /// The force, divided by the nominal inertia, that accelerates a held link: `m y'' + m' y'^2 / 2`.
    fn reshaped(&self, motion: &Motion, acceleration: f64) -> f64 {
        let (time, [y, v]) = (motion.time, motion.link);
        let (mut factor, mut slope) = (1.0, 0.0);
        for inertia in &self.inertias {
            let own = inertia.factor(time, y);
            slope = slope * own + factor * inertia.slope(time, y);
            factor *= own;
        }
        factor * acceleration + 0.5 * slope * v * v
    }

    /// Attachment of a place in this chain.
    #[inline(always)]
    pub(super) fn attachment(&self, place: Place) -> Attachment {
        self.linear.attachment(place)
    }

    fn drive(&self, encoder: [f64; 2], input: f64) -> f64 {
        match (self.linear.position_loop, self.held) {
            (None, _) => input,
            (Some(_), Some(held)) => held,
            (Some(position_loop), None) => self.put_out(&position_loop, input, encoder),
        }
    }

    /// The loop's output for a reference, a position and its velocity.
    pub(super) fn put_out(&self, position_loop: &PositionLoop, r: f64, [u, v]: [f64; 2]) -> f64 {
        let &PositionLoop {
            position_gain,
            velocity_gain,
            limit,
            ..
        } = position_loop;
        let wanted = velocity_gain * (position_gain * (r - u) - v);
        let wanted = wanted.clamp(-limit, limit);
        self.maps.iter().fold(wanted, |value, map| map.map(value))
    }
}

/// Positions and velocities.
pub(super) struct Position {
    pub motion: Motion,
    /// Position and velocity of the motor side, as an encoder sees it.
    encoder: [f64; 2],
    /// Velocity at the transmission for a unit velocity of the motor side.
    ratio: f64,
    /// Prescribed accelerations of motor side and link.
    bias: [f64; 2],
}

/// The quantities that do not change during the motion.
pub(super) struct Constants {
    mobility: [f64; 2],
    viscous: [f64; 2],
    at_rest: Motion,
}

impl Constants {
    pub(super) fn new(linear: &Linear) -> Self {
        let (motor, drag) = match linear.motor {
            MotorSide::Free { inertia, viscous } => (1.0 / inertia, viscous),
            _ => (0.0, 0.0),
        };
        let (link, ground) = match linear.link {
            Some((_, viscous)) if linear.link_is_input => (0.0, viscous),
            Some((inertia, viscous)) => (1.0 / inertia, viscous),
            None => (0.0, 0.0),
        };
        Self {
            mobility: [motor, link],
            viscous: [drag, ground],
            at_rest: linear.at_rest(),
        }
    }

    /// Slip acceleration for a unit force at an attachment; 0 where motion is prescribed.
    pub(super) fn mobility(&self, attachment: Attachment) -> f64 {
        match attachment {
            Attachment::Motor => self.mobility[0],
            Attachment::Across => self.mobility[0] + self.mobility[1],
            Attachment::Link => self.mobility[1],
        }
    }
}

/// Position of the axis on which friction at an attachment may depend: of the link where that slides, else of the motor side.
#[inline(always)]
pub(super) fn position(attachment: Attachment, motion: &Motion) -> f64 {
    match attachment {
        Attachment::Motor | Attachment::Across => motion.motor[0],
        Attachment::Link => motion.link[0],
    }
}

/// Position and velocity on which a force at an attachment acts.
#[inline(always)]
pub(super) fn coordinate(attachment: Attachment, motion: &Motion) -> [f64; 2] {
    match attachment {
        Attachment::Motor => motion.motor,
        Attachment::Across => motion.deformation(),
        Attachment::Link => motion.link,
    }
}
