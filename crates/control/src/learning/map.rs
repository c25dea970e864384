//! A quantity over pose and payload: a Gaussian process fitted to moves.
//!
//! Of a rigid body on a spring `1 / w^2 = J / k`, and `J` is a trigonometric polynomial of second order in the
//! joint positions, linear in the mass of a payload. The process is therefore one of `c = w_ref^2 / w^2`, with
//! ```text
//! k(x, x') = level^2 + pose^2 g(x, x') + load^2 m m' (1 + g(x, x')) / 2,   g = exp(-|q - q'|^2 / (2 l^2))
//! ```
//! The first two terms are [`ALIKE`] times as large where one of two loads that nobody declared has been changed for another.
//! `m` is the mass over the largest declared so far, so that the unit suits any arm. Its effect is learned from
//! moves with a payload: the process is linear in it.
//!
//! The result of a move is a block of information, precision `L` and vector `e`, at the nodes of its way:
//!
//! Source: C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, 2006, ch. 2.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use super::described::Inertia;
use super::path::NODES;

/// Number of moves that are remembered; the oldest is dropped.
const REMEMBERED: usize = 40;
/// Correlation length over the pose, rad: a trigonometric polynomial of second order has wavelengths of pi and
/// more.
const LENGTH: f64 = 1.0;

/// Correlation of the quantity with two loads that nobody declared.
///
/// A gripper is empty or full as likely as not. Full it adds, by mean and standard deviation, 0.5 and 0.25 of the arm's own
/// inertia, as a declared payload does. So the variance over loads is `(0.5^2 + 0.25^2) / 4`, of a level's variance of `0.5^2`.
const ALIKE: f64 = 1.0 - 0.3125;

/// A pose and its payload.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Position of the joint, rad.
    pub position: f64,
    /// Positions of the other joints, rad.
    pub others: Vec<f64>,
    /// Payload as it was declared, kg.
    pub payload: f64,
    /// Number of the load that nobody declared ([`super::loads`]).
    pub load: usize,
    /// `ln J` of a robot's description; 0 without one.
    pub described: f64,
}

impl Place {
    /// A place, with the inertia of a description there.
    pub fn new(position: f64, others: Vec<f64>, payload: f64, inertia: Option<&Inertia>) -> Self {
        Self {
            described: inertia.map_or(0.0, |inertia| inertia.log(position, &others, payload)),
            position,
            others,
            payload,
            load: 0,
        }
    }

    /// The same place with another load that nobody declared.
    pub fn with_load(self, load: usize) -> Self {
        Self { load, ..self }
    }
}

/// Prior of a quantity: its mean and standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Of its level.
    pub level: f64,
    /// Over the pose.
    pub pose: f64,
    /// Increase by the largest declared payload: mean, and standard deviation.
    pub load: (f64, f64),
}

/// Values at the nodes of a way, and their covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// Mean.
    pub mean: SVector<f64, NODES>,
    /// Covariance.
    pub covariance: SMatrix<f64, NODES, NODES>,
}

/// The result of one move.
#[derive(Clone, Debug)]
pub struct Block {
    /// The nodes of its way.
    pub places: [Place; NODES],
    /// Precision `L`.
    pub precision: SMatrix<f64, NODES, NODES>,
    /// `e = L x`.
    pub vector: SVector<f64, NODES>,
}

/// The map of one quantity.
#[derive(Clone, Debug)]
pub struct Map {
    spread: Spread,
    blocks: Vec<Block>,
}

impl Map {
    /// A map without data.
    pub fn new(spread: Spread) -> Self {
        Self {
            spread,
            blocks: Vec::new(),
        }
    }

    /// Adds the result of a move.
    pub fn add(&mut self, block: Block) {
        if self.blocks.len() == REMEMBERED {
            self.blocks.remove(0);
        }
        self.blocks.push(block);
    }

    /// Results of moves, the oldest first.
    pub fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    /// Number of moves in the map.
    pub fn moves(&self) -> usize {
        self.blocks.len()
    }

    /// The largest payload of the moves and of these places, kg.
    fn largest(&self, places: &[Place; NODES]) -> f64 {
        let known = self.blocks.iter().flat_map(|block| &block.places);
        let payloads = known.chain(places).map(|place| place.payload);
        payloads.fold(0.0, f64::max)
    }

    /// Covariance of two places; payloads are relative to the `largest`.
    fn kernel(&self, a: &Place, b: &Place, largest: f64) -> f64 {
        let Spread {
            level, pose, load, ..
        } = self.spread;
        let others = a.others.iter().zip(&b.others);
        let square: f64 =
            (a.position - b.position).powi(2) + others.map(|(x, y)| (x - y).powi(2)).sum::<f64>();
        let near = (-0.5 * square / (LENGTH * LENGTH)).exp();
        let alike = if a.load == b.load { 1.0 } else { ALIKE };
        alike * (level * level + pose * pose * near)
            + load.1 * load.1 * share(a, largest) * share(b, largest) * 0.5 * (1.0 + near)
    }

    /// Prior mean.
    fn mean(&self, places: &[Place; NODES], largest: f64) -> SVector<f64, NODES> {
        let Spread { mean, load, .. } = self.spread;
        SVector::from_fn(|n, _| mean + load.0 * share(&places[n], largest))
    }

    /// Posterior of the quantity at the nodes of a way.
    pub fn predict(&self, places: &[Place; NODES]) -> Predicted {
        let largest = self.largest(places);
        let own = SMatrix::from_fn(|i, j| self.kernel(&places[i], &places[j], largest));
        let mean = self.mean(places, largest);
        let nowhere = Predicted {
            mean,
            covariance: own,
        };
        let known: Vec<&Place> = self.blocks.iter().flat_map(|b| &b.places).collect();
        let n = known.len();
        if n == 0 {
            return nowhere;
        }
        let among = DMatrix::from_fn(n, n, |i, j| self.kernel(known[i], known[j], largest));
        let across = DMatrix::from_fn(NODES, n, |i, j| self.kernel(&places[i], known[j], largest));
        let (mut precision, mut vector) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for (k, block) in self.blocks.iter().enumerate() {
            let at = NODES * k;
            precision
                .fixed_view_mut::<NODES, NODES>(at, at)
                .copy_from(&block.precision);
            let surprise = block.vector - block.precision * self.mean(&block.places, largest);
            vector.fixed_rows_mut::<NODES>(at).copy_from(&surprise);
        }
        let system = DMatrix::identity(n, n) + &precision * &among;
        let right = &precision * across.transpose();
        let factor = system.lu();
        let (Some(weights), Some(gain)) = (factor.solve(&vector), factor.solve(&right)) else {
            return nowhere;
        };
        let (shift, less) = (&across * weights, &across * gain);
        let covariance = own - SMatrix::from_fn(|i, j| 0.5 * (less[(i, j)] + less[(j, i)]));
        Predicted {
            mean: mean + SVector::from_fn(|i, _| shift[i]),
            covariance,
        }
    }
}

/// A payload relative to the largest; 0 without any.
fn share(place: &Place, largest: f64) -> f64 {
    match largest > 0.0 {
        true => place.payload / largest,
        false => 0.0,
    }
}
