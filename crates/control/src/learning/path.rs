//! The way of a move in joint space, and a quantity along it.

use quell_trajectories::SampledTrajectory;

/// Number of points of a way at which the map is evaluated: a cubic goes through them.
pub const NODES: usize = 4;
/// Length below which the pose counts as constant, rad.
const SHORT: f64 = 1e-3;

/// A way from the first position to the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    from: f64,
    to: f64,
}

impl Way {
    /// The way of a joint between two positions, rad.
    pub fn new(from: f64, to: f64) -> Self {
        Self { from, to }
    }

    /// The way of a plan of one joint.
    pub fn of(plan: &SampledTrajectory) -> Self {
        let positions = plan.positions(0);
        let end = |position: Option<&f64>| position.copied().unwrap_or_default();
        Self::new(end(positions.first()), end(positions.last()))
    }

    /// Evenly spaced positions from start to end, rad.
    pub fn nodes(&self) -> [f64; NODES] {
        let step = (self.to - self.from) / (NODES - 1) as f64;
        core::array::from_fn(|n| self.from + step * n as f64)
    }

    /// The value at a position of the polynomial through the values at the nodes (Lagrange).
    pub fn value(&self, values: &[f64; NODES], position: f64) -> f64 {
        let length = self.to - self.from;
        if length.abs() < SHORT {
            return values[NODES - 1];
        }
        // A little beyond the ends, for an overshoot of the motor side.
        let s = ((position - self.from) / length).clamp(-0.1, 1.1) * (NODES - 1) as f64;
        let basis = |n: usize| -> f64 {
            let others = (0..NODES).filter(|m| *m != n);
            others
                .map(|m| (s - m as f64) / (n as f64 - m as f64))
                .product()
        };
        values.iter().enumerate().map(|(n, v)| v * basis(n)).sum()
    }
}
