//! The circle in a tracker's radial coordinate: its centre, its radius, and whether that is the lever arm.

use nalgebra::{Matrix3, Vector2, Vector3};

/// Blocks of time for the radius' standard deviation: with 19 degrees of freedom its own uncertainty hardly
/// matters.
const BLOCKS: usize = 20;
/// Relative uncertainty of a lever arm that is not an exact number: a millimetre in a metre.
const KNOWN_TO: f64 = 1e-3;
/// Odds by which a lever arm is taken for exact ("strong", Kass and Raftery 1995).
const ODDS: f64 = 20.0;

/// A radius, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radius {
    /// As the tracker shows it.
    pub seen: f64,
    /// Its standard deviation, by a jackknife over blocks of time, which is valid for noise of any colour.
    pub std: f64,
}

/// The circle of a tip about its joint: `r = R + c_x cos(angle) + c_y sin(angle) + noise`.
pub(super) struct Circle {
    sums: Sums,
    arm: f64,
    /// The radius `R` from the radial coordinate.
    pub(super) radius: Radius,
}

impl Circle {
    /// A circle from angles (rad) and radii (m) about the assumed centre; `None` where the arc is too short.
    pub(super) fn new(angle: &[f64], radius: &[f64], arm: f64) -> Option<Self> {
        let block = |k: usize| k * BLOCKS / angle.len().max(1);
        let mut blocks = [Sums::default(); BLOCKS];
        for (k, (angle, radius)) in angle.iter().zip(radius).enumerate() {
            blocks[block(k)].add(*angle, (radius - arm) / arm);
        }
        let sums = blocks
            .iter()
            .fold(Sums::default(), |all, one| all.and(one, 1.0));
        let solved = sums.solved()?;
        let mut left_out = Vec::with_capacity(BLOCKS);
        for block in &blocks {
            left_out.push(sums.and(block, -1.0).solved()?[0]);
        }
        let count = BLOCKS as f64;
        let mean = left_out.iter().sum::<f64>() / count;
        let scatter: f64 = left_out.iter().map(|one| (one - mean).powi(2)).sum();
        let radius = Radius {
            seen: arm * (1.0 + solved[0]),
            std: arm * (scatter * (count - 1.0) / count).sqrt(),
        };
        Some(Self { sums, arm, radius })
    }

    /// Whether the radius supports an exact lever arm against one that is off by a millimetre in a metre.
    fn arm_is_exact(&self) -> bool {
        let off = (self.radius.seen - self.arm) / self.radius.std;
        let loose = (KNOWN_TO * self.arm).hypot(self.radius.std) / self.radius.std;
        loose * (-0.5 * off * off).exp() > ODDS
    }

    /// Knowledge of (offset, `c_x / R`, `c_y / R`), as rows of a least-squares problem.
    pub(super) fn witness(&self) -> Vec<(Vec<f64>, f64)> {
        let normal = self.sums.normal;
        let exact = self.arm_is_exact();
        // If R is free, its row and column are eliminated.
        let schur = |i: usize, j: usize| match exact {
            true => normal[(i, j)],
            false => normal[(i, j)] - normal[(i, 0)] * normal[(0, j)] / normal[(0, 0)],
        };
        let right = |i: usize| match exact {
            true => self.sums.right[i],
            false => self.sums.right[i] - normal[(i, 0)] * self.sums.right[0] / normal[(0, 0)],
        };
        let normal = nalgebra::Matrix2::new(schur(1, 1), schur(1, 2), schur(2, 1), schur(2, 2));
        let Some(inverse) = normal.try_inverse() else {
            return Vec::new();
        };
        let centre = inverse * Vector2::new(right(1), right(2));
        let Some(variance) = self.sums.variance() else {
            return Vec::new();
        };
        let Some(root) = (normal / variance).cholesky() else {
            return Vec::new();
        };
        let l = root.l().transpose();
        let row = |i: usize| {
            let value = l[(i, 0)] * centre.x + l[(i, 1)] * centre.y;
            (vec![0.0, l[(i, 0)], l[(i, 1)]], value)
        };
        (0..2).map(row).collect()
    }
}

/// Normal equations of a circle, its radius in units of the lever arm.
#[derive(Clone, Copy)]
struct Sums {
    normal: Matrix3<f64>,
    right: Vector3<f64>,
    square: f64,
}

impl Default for Sums {
    fn default() -> Self {
        Self {
            normal: Matrix3::zeros(),
            right: Vector3::zeros(),
            square: 0.0,
        }
    }
}

impl Sums {
    fn add(&mut self, angle: f64, value: f64) {
        let row = Vector3::new(1.0, angle.cos(), angle.sin());
        self.normal += row * row.transpose();
        self.right += row * value;
        self.square += value * value;
    }

    fn and(&self, other: &Self, sign: f64) -> Self {
        Self {
            normal: self.normal + other.normal * sign,
            right: self.right + other.right * sign,
            square: self.square + sign * other.square,
        }
    }

    /// `(R / arm - 1, c_x / arm, c_y / arm)`.
    fn solved(&self) -> Option<Vector3<f64>> {
        Some(self.normal.cholesky()?.solve(&self.right))
    }

    /// Variance of the radial coordinate, in units of the lever arm.
    fn variance(&self) -> Option<f64> {
        let left = self.square - self.right.dot(&self.solved()?);
        Some((left / (self.normal[(0, 0)] - 3.0)).max(f64::MIN_POSITIVE))
    }
}

/// The unknowns of the frame along the arc: the angle of its zero, and the circle's centre.
pub(super) fn frame_columns(angle: &[f64]) -> Vec<Vec<f64>> {
    let sine = angle.iter().map(|a| -a.sin()).collect();
    let cosine = angle.iter().map(|a| a.cos()).collect();
    vec![vec![1.0; angle.len()], sine, cosine]
}
