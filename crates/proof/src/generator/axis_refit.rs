//! Whether each of several effects of a driven axis shows beside the others.

use super::axis::{Axis, Command, Driven};
use super::axis_effects::{Entry, Forces};
use super::integrate::{STATES, integrate};
use super::refit::solved;
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
    /// Whether none of several is hidden by a refit of mass, damping and position with the others in it, of any
    /// size, that is driven by the recorded force.
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
        // Logarithms of mass, damping and the sizes of the others.
        let mut factors = vec![0.0; 2 + others.len()];
        let mut best = self.predicted(others, &factors);
        let mut left = rms(&self.residual(&best));
        for _ in 0..ITERATIONS {
            let step = self.newton(others, &factors, &best);
            let better = [1.0, 0.3, 0.1].into_iter().find_map(|share| {
                let trial = factors.iter().zip(&step).map(|(f, s)| f + share * s);
                let trial: Vec<f64> = trial.collect();
                let predicted = self.predicted(others, &trial);
                let now = rms(&self.residual(&predicted));
                (now < left * (1.0 - 1e-4)).then_some((trial, predicted, now))
            });
            let Some(better) = better else {
                break;
            };
            (factors, best, left) = better;
        }
        left
    }

    fn predicted(&self, others: &[Hidden], factors: &[f64]) -> Vec<f64> {
        let mut axis = Axis {
            mass: self.plain.mass * factors[0].exp(),
            viscous: self.plain.viscous * factors[1].exp(),
            ..self.plain.clone()
        };
        for (other, factor) in others.iter().zip(&factors[2..]) {
            (other.entry.2)(
                &mut axis,
                self.forces,
                other.share * factor.exp(),
                other.shape,
            );
        }
        let (force, cycle) = self.told;
        let driven = Driven {
            axis: &axis,
            command: Command::Told(force, cycle),
            shows_impulse: false,
        };
        let step = (0.25 * cycle).min(axis.laws.longest_step());
        integrate(&driven, [0.0; STATES], step, &[], self.stamps)
    }

    fn newton(&self, others: &[Hidden], factors: &[f64], predicted: &[f64]) -> Vec<f64> {
        const SMALL: f64 = 1e-3;
        let column = |index: usize| {
            let mut moved = factors.to_vec();
            moved[index] += SMALL;
            let moved = self.predicted(others, &moved);
            let difference = moved.iter().zip(predicted);
            difference.map(|(a, b)| (a - b) / SMALL).collect()
        };
        let columns: Vec<Vec<f64>> = (0..factors.len()).map(column).collect();
        match solved(&columns, &self.residual(predicted)) {
            Some(step) => step
                .iter()
                .take(factors.len())
                .map(|s| s.clamp(-1.0, 1.0))
                .collect(),
            None => vec![0.0; factors.len()],
        }
    }

    /// Positions less predicted ones, without their mean.
    fn residual(&self, predicted: &[f64]) -> Vec<f64> {
        let left: Vec<f64> = self
            .positions
            .iter()
            .zip(predicted)
            .map(|(a, b)| a - b)
            .collect();
        let mean = left.iter().sum::<f64>() / left.len().max(1) as f64;
        left.into_iter().map(|left| left - mean).collect()
    }
}

fn rms(values: &[f64]) -> f64 {
    let squares = values.iter().map(|value| value * value).sum::<f64>();
    (squares / values.len().max(1) as f64).sqrt()
}
