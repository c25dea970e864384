//! A driven axis: a carriage on rails under a position controller.

use super::integrate::{Contact, Plant, STATES, State};
use super::laws::Laws;
use super::programme::Programme;
use super::surfaces::DryFriction;

const POSITION: usize = 0;
const VELOCITY: usize = 1;
const DELIVERED: usize = 2;
const IMPULSE: usize = 3;
/// The first of the sliders.
const SLIDER: usize = 4;

/// The axis with its hidden effects; absent or 0 without one.
#[derive(Clone, Debug, Default)]
pub struct Axis {
    /// Mass, kg.
    pub mass: f64,
    /// Viscous friction, N.s/m.
    pub viscous: f64,
    /// The mass the controller counts with, kg, and its bandwidth, rad/s.
    pub believed_mass: f64,
    /// Bandwidth of the controller, rad/s.
    pub bandwidth: f64,
    /// Friction on the rails.
    pub dry: Option<DryFriction>,
    /// Force that is always there, N.
    pub offset: f64,
    /// Amplitude, N, waves per m and phase of a force that repeats with the position.
    pub cogging: [f64; 3],
    /// Force below which nothing is transmitted, N.
    pub dead_zone: f64,
    /// Largest transmitted force, N; 0 for no limit.
    pub saturation: f64,
    /// Share of the force lost at this force, N.
    pub loss: [f64; 2],
    /// Time constant, s, with which the force follows its command; 0 for none.
    pub lag: f64,
    /// Laws that no textbook names.
    pub laws: Laws,
}

/// Source of the force.
#[derive(Clone, Copy, Debug)]
pub enum Command<'a> {
    /// From a controller that keeps the axis on a programme.
    Controller(&'a Programme),
    /// From a record: the means over cycles of this length, s.
    Told(&'a [f64], f64),
}

/// The axis on its way through a programme.
pub struct Driven<'a> {
    /// The axis.
    pub axis: &'a Axis,
    /// What drives it.
    pub command: Command<'a>,
    /// Whether the impulse of the commanded force is shown, or the position.
    pub shows_impulse: bool,
}

impl Driven<'_> {
    /// The force of the record, or the controller's: feedforward of the believed mass, and a spring and a damper.
    pub fn commanded(&self, time: f64, state: &State) -> f64 {
        let axis = self.axis;
        let programme = match self.command {
            Command::Controller(programme) => programme,
            Command::Told(forces, cycle) => {
                let index = (time / cycle) as usize;
                return forces.get(index).or(forces.last()).copied().unwrap_or(0.0);
            }
        };
        let [r, v, a] = programme.at(time);
        let w = axis.bandwidth;
        let back = w * w * (r - state[POSITION]) + 1.6 * w * (v - state[VELOCITY]);
        axis.believed_mass * (a + back)
    }

    /// The transmitted force for a command.
    fn arriving(&self, command: f64) -> f64 {
        let axis = self.axis;
        let mut force = command.signum() * (command.abs() - axis.dead_zone).max(0.0);
        let [share, reference] = axis.loss;
        if share != 0.0 {
            // Beyond saturation of the iron the force does not fall with more current.
            let peak = reference / (3.0 * share).sqrt();
            force = force.clamp(-peak, peak);
            force *= 1.0 - share * (force / reference).powi(2);
        }
        match axis.saturation {
            0.0 => force,
            most => force.clamp(-most, most),
        }
    }

    /// All forces but dry friction.
    fn push(&self, time: f64, state: &State) -> f64 {
        let axis = self.axis;
        let drive = match axis.lag {
            0.0 => self.arriving(self.commanded(time, state)),
            _ => state[DELIVERED],
        };
        let [size, waves, phase] = axis.cogging;
        let cogging = size * (waves * state[POSITION] + phase).sin();
        let laws = axis.laws.pull(state[POSITION])
            - axis
                .laws
                .against(state[POSITION], state[VELOCITY], &state[SLIDER..]);
        drive + axis.offset + cogging - axis.viscous * state[VELOCITY] + laws
    }
}

impl Plant for Driven<'_> {
    fn rates(&self, time: f64, state: &State, contact: Contact) -> State {
        let axis = self.axis;
        let friction = match (axis.dry, contact) {
            (None, _) => 0.0,
            (Some(_), Contact::Stuck) => -self.push(time, state),
            (Some(dry), Contact::Sliding(sign)) => {
                dry.sliding(sign, (sign * state[VELOCITY]).max(0.0), state[POSITION])
            }
        };
        let mut rates = [0.0; STATES];
        rates[POSITION] = state[VELOCITY];
        rates[VELOCITY] = (self.push(time, state) + friction) / axis.mass;
        if axis.lag > 0.0 {
            let command = self.arriving(self.commanded(time, state));
            rates[DELIVERED] = (command - state[DELIVERED]) / axis.lag;
        }
        rates[IMPULSE] = self.commanded(time, state);
        axis.laws.slide(state[VELOCITY], state, SLIDER, &mut rates);
        rates
    }

    fn slip(&self, _: f64, state: &State) -> Option<f64> {
        self.axis.dry.map(|_| state[VELOCITY])
    }

    fn excess(&self, time: f64, state: &State) -> (f64, f64) {
        let dry = self.axis.dry.as_ref();
        dry.map_or((0.0, 1.0), |dry| {
            dry.excess(-self.push(time, state), state[POSITION])
        })
    }

    fn arrest(&self, _: f64, state: &mut State) {
        state[VELOCITY] = 0.0;
    }

    fn edges(&self, time: f64, state: &State) -> [f64; 4] {
        let axis = self.axis;
        let command = self.commanded(time, state);
        let beyond = |limit: f64| {
            if limit > 0.0 {
                command.abs() - limit
            } else {
                1.0
            }
        };
        [beyond(axis.dead_zone), beyond(axis.saturation), 1.0, 1.0]
    }

    fn shown(&self, _: f64, state: &State, rates: &State) -> [f64; 2] {
        match self.shows_impulse {
            true => [state[IMPULSE], rates[IMPULSE]],
            false => [state[POSITION], state[VELOCITY]],
        }
    }
}
