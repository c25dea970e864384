//! The axis as a chain: motor side, transmission, link, with laws at their places.
//!
//! ```text
//! J_m u'' = g_m F - B_m u' + k d + c d' - drive forces + transmission forces
//! J_l y'' = g_l F - B_l y' - k d - c d' - link forces  - transmission forces,     d = y - u
//! ```
//!
//! A motor side that an encoder has measured is prescribed; one that stands still is fixed; an axis
//! without a spring has no link.

use crate::effects::{Force, Friction, Inertia, Memory, Motion, Place, Resonance};

/// What the motor side does.
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
    /// What a law's force of 1 is in the equation's unit.
    pub unit_force: f64,
}

impl Linear {
    /// Nothing that moves: what a kind starts from.
    pub const NONE: Self = Self {
        motor: MotorSide::Fixed,
        link: None,
        link_is_input: false,
        stiffness: 0.0,
        damping: 0.0,
        motor_gain: 0.0,
        link_gain: 0.0,
        position_loop: None,
        unit_force: 1.0,
    };
}

/// A force law at a place, and its memory.
pub struct ForceElement {
    /// Where it acts.
    pub place: Place,
    /// What it does.
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
    /// Changes of the link's inertia.
    pub inertias: Vec<Box<dyn Inertia>>,
    /// Further modes.
    pub resonances: Vec<Resonance>,
    /// Transmission errors.
    pub kinematics: Vec<Box<dyn Fn(f64) -> [f64; 2] + Send + Sync>>,
    /// Static maps of the drive inside the loop.
    pub maps: Vec<Box<dyn crate::effects::Drive>>,
}

/// Most further modes of a chain.
pub const RESONANCES: usize = 2;

/// Position and velocity of motor side, link, further modes.
pub type State = [f64; 4 + 2 * RESONANCES];

/// All that follows from a state at an instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// Where everything is.
    pub motion: Motion,
    /// Acceleration of the motor side.
    pub motor: f64,
    /// Acceleration of the link.
    pub link: f64,
    /// Accelerations of further modes.
    pub modes: [f64; RESONANCES],
    /// Force that the drive makes.
    pub drive: f64,
}

impl Chain {
    /// The linear chain alone.
    pub fn new(linear: Linear) -> Self {
        Self {
            linear,
            forces: Vec::new(),
            frictions: Vec::new(),
            inertias: Vec::new(),
            resonances: Vec::new(),
            kinematics: Vec::new(),
            maps: Vec::new(),
        }
    }

    /// Motion of the chain for an input (value, rate, second derivative) at a time.
    pub fn motion(&self, time: f64, state: &State, input: [f64; 3]) -> (Motion, f64) {
        let linear = &self.linear;
        let (motor, acceleration) = match linear.motor {
            MotorSide::Prescribed => self.kinematic(input),
            MotorSide::Fixed => ([0.0; 2], 0.0),
            MotorSide::Free { .. } => ([state[0], state[1]], 0.0),
        };
        let link = match linear.link {
            Some(_) => [state[2], state[3]],
            None => motor,
        };
        let motion = Motion {
            time,
            motor,
            link,
            stiffness: linear.stiffness / linear.unit_force,
            damping: linear.damping / linear.unit_force,
        };
        (motion, acceleration)
    }

    fn kinematic(&self, input: [f64; 3]) -> ([f64; 2], f64) {
        let [mut u, mut rate, mut acceleration] = input;
        for error in &self.kinematics {
            let [value, slope] = error(u);
            (u, rate) = (u + value, rate * (1.0 + slope));
            acceleration *= 1.0 + slope;
        }
        ([u, rate], acceleration)
    }

    /// Accelerations at a state, friction as it presently slides or sticks.
    #[inline]
    pub fn instant(&self, time: f64, state: &State, input: [f64; 3]) -> Instant {
        let linear = &self.linear;
        let (motion, prescribed) = self.motion(time, state, input);
        let [d, rate] = motion.deformation();
        let elastic = linear.stiffness * d + linear.damping * rate;
        let drive = self.drive(&motion, input[0]);
        let mut on_motor = linear.motor_gain * drive + elastic;
        let mut on_link = linear.link_gain * drive - elastic;
        for element in &self.forces {
            let [x, v] = coordinate(element.place, &motion);
            let force = linear.unit_force * element.law.force(&motion, x, v, &element.memory);
            apply(element.place, force, &mut on_motor, &mut on_link);
        }
        let mut bodies = Bodies::new(linear, &motion, prescribed, on_motor, on_link);
        if !self.inertias.is_empty() {
            bodies.reshape(&self.inertias, &motion);
        }
        for _ in 0..self.sweeps() {
            for element in &self.frictions {
                bodies.resist(element, &motion, linear.unit_force);
            }
        }
        let mut instant = Instant {
            motor: bodies.motor_acceleration(),
            link: bodies.link_acceleration(),
            motion,
            modes: [0.0; RESONANCES],
            drive,
        };
        for (k, mode) in self.resonances.iter().take(RESONANCES).enumerate() {
            let (x, v) = (state[4 + 2 * k], state[5 + 2 * k]);
            instant.modes[k] = self.further(mode, &motion, drive, x, v);
        }
        instant
    }

    /// Two frictions that stick share a load: a few sweeps settle it; one needs none.
    fn sweeps(&self) -> usize {
        match self.frictions.len() {
            0 => 0,
            1 => 1,
            _ => 4,
        }
    }

    fn drive(&self, motion: &Motion, input: f64) -> f64 {
        let Some(position_loop) = self.linear.position_loop else {
            return input;
        };
        let PositionLoop {
            position_gain,
            velocity_gain,
            limit,
            ..
        } = position_loop;
        let wanted = velocity_gain * (position_gain * (input - motion.motor[0]) - motion.motor[1]);
        let wanted = wanted.clamp(-limit, limit);
        self.maps.iter().fold(wanted, |value, map| map.map(value))
    }

    fn further(&self, mode: &Resonance, motion: &Motion, drive: f64, x: f64, v: f64) -> f64 {
        let (w, xi) = (mode.natural_frequency, mode.damping_ratio);
        let u = motion.motor;
        w * w * (u[0] - x) + 2.0 * xi * w * (u[1] - v) + self.linear.link_gain * drive
    }

    /// Force that a sticking friction would need so that nothing slips, in the law's unit.
    pub fn holding_force(&self, element: usize, time: f64, state: &State, input: [f64; 3]) -> f64 {
        let linear = &self.linear;
        let (motion, prescribed) = self.motion(time, state, input);
        let [d, rate] = motion.deformation();
        let elastic = linear.stiffness * d + linear.damping * rate;
        let drive = self.drive(&motion, input[0]);
        let mut on_motor = linear.motor_gain * drive + elastic;
        let mut on_link = linear.link_gain * drive - elastic;
        for force in &self.forces {
            let [x, v] = coordinate(force.place, &motion);
            let value = linear.unit_force * force.law.force(&motion, x, v, &force.memory);
            apply(force.place, value, &mut on_motor, &mut on_link);
        }
        let mut bodies = Bodies::new(linear, &motion, prescribed, on_motor, on_link);
        bodies.reshape(&self.inertias, &motion);
        for (index, other) in self.frictions.iter().enumerate() {
            if index != element {
                bodies.resist(other, &motion, linear.unit_force);
            }
        }
        bodies.holding(self.frictions[element].place) / linear.unit_force
    }
}

/// The coordinate on which a place acts.
pub fn coordinate(place: Place, motion: &Motion) -> [f64; 2] {
    match place {
        Place::Drive => motion.motor,
        Place::Transmission => motion.deformation(),
        _ => motion.link,
    }
}

fn apply(place: Place, force: f64, on_motor: &mut f64, on_link: &mut f64) {
    match place {
        Place::Drive => *on_motor -= force,
        Place::Transmission => {
            *on_link -= force;
            *on_motor += force;
        }
        _ => *on_link -= force,
    }
}

/// Forces and mobilities of the two bodies at one instant. A mobility of 0 is a prescribed motion.
struct Bodies {
    force: [f64; 2],
    mobility: [f64; 2],
    bias: [f64; 2],
}

impl Bodies {
    fn new(linear: &Linear, motion: &Motion, prescribed: f64, motor: f64, link: f64) -> Self {
        let (mobility, bias, viscous) = match linear.motor {
            MotorSide::Free { inertia, viscous } => (1.0 / inertia, 0.0, viscous),
            _ => (0.0, prescribed, 0.0),
        };
        let (link_mobility, ground) = match linear.link {
            Some((inertia, viscous)) => (1.0 / inertia, viscous),
            None => (0.0, 0.0),
        };
        Self {
            force: [
                motor - viscous * motion.motor[1],
                link - ground * motion.link[1],
            ],
            mobility: [mobility, link_mobility],
            bias: [bias, 0.0],
        }
    }

    fn reshape(&mut self, inertias: &[Box<dyn Inertia>], motion: &Motion) {
        for inertia in inertias {
            let [y, v] = motion.link;
            let factor = inertia.factor(motion.time, y);
            self.mobility[1] /= factor;
            self.bias[1] -= 0.5 * inertia.slope(motion.time, y) * v * v / factor;
        }
    }

    fn motor_acceleration(&self) -> f64 {
        self.bias[0] + self.mobility[0] * self.force[0]
    }

    fn link_acceleration(&self) -> f64 {
        self.bias[1] + self.mobility[1] * self.force[1]
    }

    /// Force at a place that brings its slip acceleration to zero.
    fn holding(&self, place: Place) -> f64 {
        let (slip, mobility) = match place {
            Place::Drive => (self.motor_acceleration(), self.mobility[0]),
            Place::Transmission => (
                self.link_acceleration() - self.motor_acceleration(),
                self.mobility[0] + self.mobility[1],
            ),
            _ => (self.link_acceleration(), self.mobility[1]),
        };
        if mobility > 0.0 { slip / mobility } else { 0.0 }
    }

    fn resist(&mut self, element: &FrictionElement, motion: &Motion, unit: f64) {
        let force = match element.slides {
            0.0 => self.holding(element.place),
            sign => {
                let speed = coordinate(element.place, motion)[1].abs();
                sign * unit * sliding_force(&element.law, sign, speed)
            }
        };
        let [motor, link] = &mut self.force;
        apply(element.place, force, motor, link);
    }
}

/// `F_c + (F_s - F_c) exp(-(v / v_s)^2)` in the direction of `sign`.
pub fn sliding_force(law: &Friction, sign: f64, speed: f64) -> f64 {
    let side = usize::from(sign < 0.0);
    let (kinetic, breakaway) = (law.kinetic[side], law.breakaway[side]);
    if breakaway == kinetic {
        return kinetic;
    }
    kinetic + (breakaway - kinetic) * (-(speed / law.stribeck_velocity).powi(2)).exp()
}
