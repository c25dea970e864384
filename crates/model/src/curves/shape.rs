//! The known properties of a learned curve.

use super::{Curve, Estimate, energy};
use crate::effects::Slot;
use nalgebra::{DMatrix, DVector};

/// The direction of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trend {
    /// It rises, and does not fall anywhere.
    Rises,
    /// It falls, and does not rise anywhere.
    Falls,
    /// It does both.
    Both,
}

/// Growth by a power law: `|f| ~ |x|^n` between two distances from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// The exponent `n`.
    pub exponent: Estimate,
    /// The two distances.
    pub between: (f64, f64),
}

/// Properties of a curve that are known at 95 %; others are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Share of the odd part in the energy `int f^2 dx`, over the widest range about 0: 1 is odd, 0 even.
    pub odd: Option<f64>,
    /// Jump at 0, for a law over the velocity.
    pub jump: Option<Estimate>,
    /// Slope at 0; for a law over the velocity the mean of the slopes at rest in both directions.
    pub slope: Option<Estimate>,
    /// How it grows away from 0.
    pub growth: Option<Growth>,
    /// Whether it rises or falls.
    pub trend: Option<Trend>,
    /// Dissipation: for friction a force, for damping the coefficient, for a hysteresis the energy of the
    /// largest loop.
    pub dissipated: Option<Estimate>,
}

/// Least share of the range on the shorter side of 0 for a separation of odd and even parts.
const BOTH_SIDES: f64 = 0.2;

/// Distances between which growth is measured, as shares of the distance from 0 to the end of the range.
const GROWTH: (f64, f64) = (0.35, 0.95);

/// Share of the energy below which a part is small: a third of the amplitude.
const SMALL: f64 = 0.1;

/// Largest useful half width of an exponent's 95 % interval: it separates 1 from 2.
const VAGUE: f64 = 0.5;

/// Number of points over which a rise or a fall is tested: about a knot.
const STRIDE: usize = 10;

impl Curve {
    /// The properties that are known at 95 %.
    pub fn shape(&self) -> Shape {
        let halves = self.halves();
        let odd = halves.as_ref().and_then(|halves| self.odd(halves));
        Shape {
            odd,
            jump: self.jump().and_then(Estimate::significant),
            slope: self.slope().and_then(Estimate::significant),
            growth: halves.and_then(|halves| self.growth(&halves, odd)),
            trend: self.trend(),
            dissipated: energy::dissipated(self).and_then(Estimate::significant),
        }
    }

    /// Weights of the odd and of the even part at distances from 0 that are visited on both sides; `None` where
    /// one side is hardly visited.
    fn halves(&self) -> Option<Halves> {
        let last = *self.points.last()?;
        let reach = last.min(-self.points[0]);
        let range = last - self.points[0];
        if reach <= BOTH_SIDES * range || self.slot == Slot::Hysteresis {
            return None;
        }
        let count = self.points.len() / 2;
        let distance = |k: usize| reach * (k as f64 + 0.5) / count as f64;
        let distances: Vec<f64> = (0..count).map(distance).collect();
        let mut parts = [0, 1].map(|_| DMatrix::zeros(count, self.points.len()));
        for (row, &x) in distances.iter().enumerate() {
            for (part, sign) in parts.iter_mut().zip([-1.0, 1.0]) {
                let at = self.interpolation(x) + sign * self.interpolation(-x);
                part.set_row(row, &(0.5 * at).transpose());
            }
        }
        let [odd, even] = parts;
        Some(Halves {
            distances,
            odd,
            even,
        })
    }

    /// Weights of the value at a coordinate: straight lines between the points.
    fn interpolation(&self, x: f64) -> DVector<f64> {
        let mut weights = DVector::zeros(self.points.len());
        let after = self.index(x).max(1);
        let (low, high) = (self.points[after - 1], self.points[after]);
        let part = ((x - low) / (high - low)).clamp(0.0, 1.0);
        weights[after - 1] = 1.0 - part;
        weights[after] = part;
        weights
    }

    /// Share of the odd part, if at least one part is significant, and the other one is significant or known to
    /// be small.
    fn odd(&self, halves: &Halves) -> Option<f64> {
        let [odd, even] = [&halves.odd, &halves.even].map(|part| self.energy(part));
        let small = |part: &Energy, other: &Energy| part.most < SMALL * other.found;
        match (odd.seen, even.seen) {
            (true, true) => Some(odd.found / (odd.found + even.found)),
            (true, false) if small(&even, &odd) => Some(1.0),
            (false, true) if small(&odd, &even) => Some(0.0),
            _ => None,
        }
    }

    /// Energy of a part, less that of its noise.
    fn energy(&self, part: &DMatrix<f64>) -> Energy {
        let own = part * &self.values;
        let covariance = part * &self.covariance * part.transpose();
        let (mean, spread) = (covariance.trace(), covariance.norm_squared());
        // A sum of squares is nearly a multiple of chi squared with these degrees of freedom (Satterthwaite, Biometrics
        // Bulletin 2, 1946), whose quantile is nearly that of a cube (Wilson and Hilferty, PNAS 17, 1931).
        let freedom = mean * mean / spread;
        let width = 2.0 / (9.0 * freedom);
        let noise = mean * (1.0 - width + ONE_SIDED * width.sqrt()).powi(3);
        let found = own.norm_squared() - mean;
        let std = (2.0 * spread + 4.0 * own.dot(&(&covariance * &own))).sqrt();
        Energy {
            found,
            most: found + ONE_SIDED * std,
            seen: found > 0.0 && (mean == 0.0 || found + mean > noise),
        }
    }

    fn jump(&self) -> Option<Estimate> {
        let mut weights = DVector::zeros(self.points.len());
        let after = self.rest()?;
        (weights[after], weights[after - 1]) = (1.0, -1.0);
        Some(self.estimate(&weights))
    }

    /// Index of the first point of positive velocity.
    fn rest(&self) -> Option<usize> {
        (self.slot == Slot::Friction).then_some(self.points.len() / 2)
    }

    fn slope(&self) -> Option<Estimate> {
        let chord = |from: usize, to: usize| {
            let mut weights = DVector::zeros(self.points.len());
            let width = self.points[to] - self.points[from];
            (weights[to], weights[from]) = (1.0 / width, -1.0 / width);
            weights
        };
        if let Some(after) = self.rest() {
            let both = chord(after, after + 1) + chord(after - 2, after - 1);
            return Some(self.estimate(&(0.5 * both)));
        }
        let inside = self.points[0] <= 0.0 && 0.0 <= *self.points.last()?;
        let after = self.index(0.0).clamp(1, self.points.len() - 2);
        inside.then_some(self.estimate(&chord(after - 1, after + 1)))
    }

    /// The exponent of the part that has more of the energy.
    fn growth(&self, halves: &Halves, odd: Option<f64>) -> Option<Growth> {
        let part = if odd? >= 0.5 {
            &halves.odd
        } else {
            &halves.even
        };
        let reach = *halves.distances.last()?;
        let row = |share: f64| {
            let at = halves.distances.partition_point(|x| *x < share * reach);
            at.min(halves.distances.len() - 1)
        };
        let (near, far) = (row(GROWTH.0), row(GROWTH.1));
        let between = (halves.distances[near], halves.distances[far]);
        let weights = [near, far].map(|row| part.row(row).transpose());
        let [first, last] = [0, 1].map(|k: usize| self.estimate(&weights[k]));
        let (a, b) = (first.significant()?.value, last.significant()?.value);
        let way = (between.1 / between.0).ln();
        // d ln(b / a) = db / b - da / a.
        let change = self.estimate(&(&weights[1] / b - &weights[0] / a));
        let exponent = Estimate {
            value: (b / a).ln() / way,
            std: change.std / way,
        };
        // With different signs there is no power law: the logarithm is NaN.
        let clear = exponent.value.is_finite() && exponent.band() < VAGUE;
        clear.then_some(Growth { exponent, between })
    }

    /// Rises and falls over about a knot that are beyond noise, allowing for the number of tests.
    fn trend(&self) -> Option<Trend> {
        // A jump is reported separately.
        let across = |from: usize| {
            self.rest()
                .is_some_and(|rest| from < rest && rest <= from + STRIDE)
        };
        let starts = (0..self.points.len() - STRIDE).step_by(STRIDE / 2);
        let changes: Vec<Estimate> = starts
            .filter(|&from| !across(from))
            .map(|from| {
                let mut weights = DVector::zeros(self.points.len());
                (weights[from + STRIDE], weights[from]) = (1.0, -1.0);
                self.estimate(&weights)
            })
            .collect();
        let largest = self.values.amax();
        let seen = |sign: f64| {
            let mut changes = changes.iter();
            changes.any(|c| sign * c.value > MANY * c.std + 1e-9 * largest)
        };
        match (seen(1.0), seen(-1.0)) {
            (true, true) => Some(Trend::Both),
            (true, false) => Some(Trend::Rises),
            (false, true) => Some(Trend::Falls),
            (false, false) => None,
        }
    }
}

/// 95 % quantile of the normal distribution.
const ONE_SIDED: f64 = 1.644_853_627;

/// The same for the largest of two dozen values in either direction: 1 - 0.95^(1 / 48) is 0.1 %.
const MANY: f64 = 3.08;

/// Energy of a part of a curve.
struct Energy {
    /// The estimate.
    found: f64,
    /// The upper end of its one-sided interval of 95 %.
    most: f64,
    /// Whether it is more than noise would give once in twenty cases.
    seen: bool,
}

/// Weights of the odd and the even part of a curve.
struct Halves {
    distances: Vec<f64>,
    odd: DMatrix<f64>,
    even: DMatrix<f64>,
}
