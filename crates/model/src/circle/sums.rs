//! Sums over the radial coordinate: the normal equations of its circle, in blocks of time.

use nalgebra::{SMatrix, SVector, Vector3};

/// Blocks of time for the radius' standard deviation.
const BLOCKS: usize = 20;

/// Unknowns of a circle: three of its own, then those that are eliminated.
pub const UNKNOWNS: usize = 7;

/// Normal equations of a circle in blocks of time, its radius in units of the lever arm.
pub struct Blocks(Vec<Sums<UNKNOWNS>>);

impl Blocks {
    /// Of rows and values, each of which is worth so many independent ones. An unknown whose column is 0 throughout is none.
    pub fn new(rows: &[[f64; UNKNOWNS]], values: &[[f64; 1]], worth: &[f64]) -> Self {
        let mut blocks = vec![Sums::default(); BLOCKS];
        for (k, (row, [value])) in rows.iter().zip(values).enumerate() {
            blocks[k * BLOCKS / values.len()].add((*row).into(), *value, worth[k]);
        }
        Self(blocks)
    }

    fn all(&self) -> Sums<UNKNOWNS> {
        let first = Sums::default();
        self.0.iter().fold(first, |all, one| all.and(one, 1.0))
    }

    /// The sums of radius and centre alone.
    pub fn sums(&self) -> Option<Sums<3>> {
        self.all().eliminated()
    }

    /// The same, and `R / arm - 1` without each of the blocks with the variance that white noise of unit variance adds to it
    /// thereby.
    pub fn told(&self) -> Option<(Sums<3>, Vec<[f64; 2]>)> {
        let all = self.all();
        let whole = all.eliminated()?;
        let variance = |own: &Sums<3>| Some(own.normal.try_inverse()?[(0, 0)]);
        let known = variance(&whole)?;
        let without = |block| {
            let left = all.and(block, -1.0).eliminated()?;
            Some([left.solved()?[0], variance(&left)? - known])
        };
        let left_out: Option<Vec<[f64; 2]>> = self.0.iter().map(without).collect();
        Some((whole, left_out?))
    }
}

/// Normal equations.
#[derive(Clone, Copy)]
pub struct Sums<const N: usize> {
    pub normal: SMatrix<f64, N, N>,
    pub right: SVector<f64, N>,
    square: f64,
    count: f64,
}

impl<const N: usize> Default for Sums<N> {
    fn default() -> Self {
        Self {
            normal: SMatrix::zeros(),
            right: SVector::zeros(),
            square: 0.0,
            count: 0.0,
        }
    }
}

impl<const N: usize> Sums<N> {
    fn add(&mut self, row: SVector<f64, N>, value: f64, worth: f64) {
        self.normal += row * row.transpose();
        self.right += row * value;
        self.square += value * value;
        self.count += worth;
    }

    fn and(&self, other: &Self, sign: f64) -> Self {
        Self {
            normal: self.normal + other.normal * sign,
            right: self.right + other.right * sign,
            square: self.square + sign * other.square,
            count: self.count + sign * other.count,
        }
    }

    /// The normal equations of the first three unknowns, the others eliminated.
    fn eliminated(&self) -> Option<Sums<3>> {
        let (mut normal, mut right, mut square) = (self.normal, self.right, self.square);
        let is_free = |unknown: &usize| self.normal[(*unknown, *unknown)] > 0.0;
        for last in (3..N).rev().filter(is_free) {
            let pivot = normal[(last, last)];
            if pivot <= f64::EPSILON * self.normal[(last, last)] {
                return None;
            }
            let (column, value) = (normal.column(last).into_owned(), right[last]);
            normal -= column * column.transpose() / pivot;
            right -= column * (value / pivot);
            square -= value * value / pivot;
        }
        Some(Sums {
            normal: normal.fixed_view::<3, 3>(0, 0).into_owned(),
            right: right.fixed_rows::<3>(0).into_owned(),
            square,
            count: self.count,
        })
    }
}

impl Sums<3> {
    /// `(R / arm - 1, c_x / arm, c_y / arm)`.
    pub fn solved(&self) -> Option<Vector3<f64>> {
        Some(self.normal.cholesky()?.solve(&self.right))
    }

    /// Variance of the radial coordinate, in units of the lever arm.
    pub fn variance(&self) -> Option<f64> {
        let left = self.square - self.right.dot(&self.solved()?);
        Some((left / (self.count - 3.0)).max(f64::MIN_POSITIVE))
    }

    /// Bayesian information criterion, with so many unknowns more.
    pub fn criterion(&self, more: usize) -> Option<f64> {
        Some(self.count * self.variance()?.ln() + more as f64 * self.count.ln())
    }
}
