//! Laws: the few ways in which physics enters the chain of an axis.

use super::{Friction, Zone};

/// Motion of the chain at one instant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Motion {
    /// Time, s.
    pub time: f64,
    /// Position and velocity of the motor side.
    pub motor: [f64; 2],
    /// Position and velocity of the link.
    pub link: [f64; 2],
    /// Stiffness of the transmission, force per position (1 where forces are divided by it).
    pub stiffness: f64,
    /// Damping across the transmission, force per velocity.
    pub damping: f64,
    /// Inertia of the link (of the motor side where there is no link), force per acceleration.
    pub inertia: f64,
}

impl Motion {
    /// Link minus motor side, and its rate.
    pub fn deformation(&self) -> [f64; 2] {
        [self.link[0] - self.motor[0], self.link[1] - self.motor[1]]
    }
}

/// The memory of a law: its state at the start of the present step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Memory {
    /// Time at the start of the step, s.
    pub time: f64,
    /// Coordinate at the start of the step.
    pub position: f64,
    /// The law's own state at the start of the step, such as a bristle's deflection.
    pub state: f64,
    /// The states of a law that has several, such as the deflections of elements in parallel.
    pub states: [f64; STATES],
}

/// Most further states of a law.
pub const STATES: usize = 8;

/// A force that opposes the coordinate of its place: positive resists positive motion.
///
/// The coordinate `x` and its rate `v` are those of the place: the motor side's for `Drive`, the
/// deformation for `Transmission`, the link's for `Link`, `Base` and `Environment`. At the
/// transmission the force acts on the link and, with the other sign, on the motor side.
pub trait Force: Send + Sync {
    /// The force at `x`, `v`, for a memory written at the start of the step.
    fn force(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> f64;

    /// The force, and the inertia that a load adds to the body at a place that is attached to ground, force per
    /// acceleration.
    fn load(&self, motion: &Motion, x: f64, v: f64, memory: &Memory) -> [f64; 2] {
        [self.force(motion, x, v, memory), 0.0]
    }

    /// The state at the end of a step that leads to this motion, `x` and `v`. It is also called once at the
    /// start of the motion. The step does not cross a zero of [`Force::switch`].
    fn advance(&self, _motion: &Motion, _x: f64, _v: f64, memory: &Memory) -> f64 {
        memory.state
    }

    /// Updates the memory to the end of the step. A law of one state implements [`Force::advance`] instead.
    fn remember(&self, motion: &Motion, x: f64, v: f64, memory: &mut Memory) {
        memory.state = self.advance(motion, x, v, memory);
        (memory.position, memory.time) = (x, motion.time);
    }

    /// A function whose change of sign marks a corner of the force; the integrator ends a step there, on the
    /// far side. A force that jumps stores its branch in its state, so that it is smooth within a step.
    fn switch(&self, _motion: &Motion, _x: f64, _v: f64, _memory: &Memory) -> Option<f64> {
        None
    }

    /// Slope of the force over the position, force per position, where the motion goes on with the rate `v`: the integrator
    /// makes steps that are short for the vibration on it. 0 of a law that is no stiffer than the transmission.
    fn stiffness(&self, _v: f64, _memory: &Memory) -> f64 {
        0.0
    }

    /// Speeds at which the force follows a curve over the speed: the integrator makes short steps there.
    fn zone(&self) -> Option<Zone> {
        None
    }

    /// Instants at which the force jumps: the integrator ends a step there.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// The drive's output for an input (a force, a current or a commanded position).
pub trait Drive: Send + Sync {
    /// Static map of one value.
    fn map(&self, value: f64) -> f64 {
        value
    }

    /// The whole series, in place; `time` is strictly increasing.
    fn run(&self, _time: &[f64], values: &mut [f64]) {
        values.iter_mut().for_each(|v| *v = self.map(*v));
    }

    /// Whether [`Drive::map`] is the whole effect, so that it can act inside a position loop.
    fn is_static(&self) -> bool {
        true
    }
}

/// The link's inertia relative to the nominal one, which may change with time and pose.
pub trait Inertia: Send + Sync {
    /// Factor on the inertia, above 0.
    fn factor(&self, time: f64, position: f64) -> f64;

    /// Derivative of the factor with respect to the position: it couples the velocity,
    /// `m y'' + m' y'^2 / 2 = F`.
    fn slope(&self, _time: f64, _position: f64) -> f64 {
        0.0
    }

    /// Instants at which the factor jumps.
    fn breaks(&self) -> Vec<f64> {
        Vec::new()
    }
}

/// A further mode: `eta'' + 2 xi w eta' + 2 g w d' + w^2 eta` is driven as the first mode is, `d` being the deformation of
/// the joint. If the motor side drives the
/// chain, the sensor sees `(1 - share) first + share eta`, since a sensor on an inertia stands still at
/// infinite frequency. If a force drives it, the sensor sees `first + share eta`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Natural frequency, rad/s, above 0.
    pub natural_frequency: f64,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Share of what the sensor sees; 0 is neutral.
    pub share: f64,
    /// `g`: what the damper of the joint does to this mode. 0 for dampers in the proportion of the springs.
    ///
    /// Dampers in any other proportion couple the modes (Caughey and O'Kelly, ASME J. Applied Mechanics 32, 1965). The
    /// first mode is the larger one, so that what the further one does to it is of second order.
    pub damping_coupling: f64,
}

/// The motion that a sensor sees at one stamp.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// True time, s.
    pub time: f64,
    /// Measured quantity, noise-free.
    pub value: f64,
    /// Motor side position.
    pub motor: f64,
    /// Whether the quantity is the angle of a tip, which a tracker follows in a frame of its own.
    pub tracked: bool,
}

/// The reading that a sensor makes of the motion.
pub trait Sensor: Send + Sync {
    /// The instant that the sensor shows at this time, for a delay or a clock that runs fast.
    fn instant(&self, time: f64) -> f64 {
        time
    }

    /// Whether [`Sensor::filter`] does anything.
    fn filters(&self) -> bool {
        false
    }

    /// Replaces values and rates at increasing times by the filtered ones. The filter starts at `start`;
    /// without it the input was constant before.
    fn filter(&self, _time: &[f64], _curve: &mut [[f64; 2]], _start: Option<[f64; 2]>) {}

    /// The value that is shown.
    fn read(&self, reading: &Reading) -> f64 {
        reading.value
    }
}

/// An impulse on the link: a parabola of force, or a jump of the velocity where it has no duration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Its middle, s.
    pub time: f64,
    /// Its integral over the inertia without changes of that: the jump of the velocity of the link; of the motor side where
    /// there is no link.
    pub size: f64,
    /// How long it lasts, s.
    pub duration: f64,
}

impl Impulse {
    /// Acceleration at a time: `3 size / (2 d) (1 - (2 (t - t_0) / d)^2)` within half the duration `d` of the middle `t_0`. Its
    /// integral is the size. A step of the integrator over the whole of it is exact for a free mass.
    pub fn acceleration(&self, time: f64) -> f64 {
        let share = 2.0 * (time - self.time) / self.duration;
        match share.abs() < 1.0 {
            true => 1.5 * self.size / self.duration * (1.0 - share * share),
            false => 0.0,
        }
    }
}

/// The way in which an effect enters the chain.
pub enum Law {
    /// A force at the effect's place.
    Force(Box<dyn Force>),
    /// Dry friction at the effect's place.
    Friction(Friction),
    /// A change of the drive's input.
    Drive(Box<dyn Drive>),
    /// Added to the motor side position that the transmission sees: `u -> u + f(u)`, with `f` and its
    /// derivative.
    Kinematic(Box<dyn Fn(f64) -> [f64; 2] + Send + Sync>),
    /// A change of the link's inertia.
    Inertia(Box<dyn Inertia>),
    /// A further mode.
    Resonance(Resonance),
    /// An impulse on the link.
    Impulse(Impulse),
    /// A change of the sensor's reading.
    Sensor(Box<dyn Sensor>),
}
