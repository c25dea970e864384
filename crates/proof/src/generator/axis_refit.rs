//! Whether each of several effects of a driven axis shows beside the others.

use super::axis::{Axis, Command, Driven};
use super::axis_effects::{Entry, Forces};
use super::gauss_newton::{Fit, Steps, descend};
use super::integrate::{STATES, integrate};
use super::size::HIDDEN;

/// Iterations of Gauss and Newton; a linear axis needs one.
const ITERATIONS: usize = 5;

/// One hidden effect: its entry, its share of the force and its shape.
#[derive(Clone, Copy)]
pub struct Hidden {
    /// What it is.
    pub entry: &'static Entry,
    /// Its share of the force.
    pub share: f64,
    /// Its shape.
    pub shape: [f64; 3],
}

/// What was recorded, without noise.
pub struct Recorded<'a> {
    /// The axis without anything hidden.
    pub plain: &'a Axis,
    /// Forces of its motion.
    pub forces: &'a Forces,
    /// The force as told, and its cycle, s.
    pub told: (&'a [f64], f64),
    /// Stamps of the positions, s.
    pub stamps: &'a [f64],
    /// The positions.
    pub positions: &'a [f64],
    /// One standard deviation of their noise, m.
    pub noise: f64,
}

impl Recorded<'_> {
    /// Whether each of several effects still shows after a refit of mass, damping and position with the other
    /// effects in it, of any size, driven by the recorded force.
    pub fn all_show(&self, hidden: &[Hidden]) -> bool {
        (0..hidden.len()).all(|own| {
            let mut others = hidden.to_vec();
            others.remove(own);
            self.shows_beside(&others)
        })
    }

    /// Whether something is left where these effects, of any size, are in the axis.
    pub fn shows_beside(&self, others: &[Hidden]) -> bool {
        (self.leftover(others) / self.noise).hypot(1.0) >= HIDDEN
    }

    /// Rms of what the axis with these effects cannot explain, m.
    fn leftover(&self, others: &[Hidden]) -> f64 {
        let count = OWN + others.len();
        let start = Resized {
            recorded: self,
            others,
            factors: vec![0.0; count],
        };
        let steps = Steps {
            small: vec![1e-3; count],
            most: vec![1.0; count],
            count: ITERATIONS,
        };
        let first = start.predict();
        descend(start, first, self.positions, &steps).1
    }
}

/// The axis with other effects in it, of any size.
struct Resized<'a> {
    recorded: &'a Recorded<'a>,
    others: &'a [Hidden],
    /// Logarithms of mass, damping and the sizes of the others.
    factors: Vec<f64>,
}

/// Unknowns of the axis itself: log mass, log damping.
const OWN: usize = 2;

impl Fit for Resized<'_> {
    fn predict(&self) -> Vec<f64> {
        let (recorded, factors) = (self.recorded, &self.factors);
        let mut axis = Axis {
            mass: recorded.plain.mass * factors[0].exp(),
            viscous: recorded.plain.viscous * factors[1].exp(),
            ..recorded.plain.clone()
        };
        for (other, factor) in self.others.iter().zip(&factors[OWN..]) {
            let share = other.share * factor.exp();
            (other.entry.2)(&mut axis, recorded.forces, share, other.shape);
        }
        let (force, cycle) = recorded.told;
        let driven = Driven {
            axis: &axis,
            command: Command::Told(force, cycle),
            shows_impulse: false,
        };
        let step = (0.25 * cycle).min(axis.laws.longest_step());
        integrate(&driven, [0.0; STATES], step, &[], recorded.stamps)
    }

    fn changed(&self, step: &[f64]) -> Self {
        let factors = self.factors.iter().zip(step);
        Self {
            factors: factors.map(|(factor, step)| factor + step).collect(),
            ..*self
        }
    }
}
