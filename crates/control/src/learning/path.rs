//! The way of a move in joint space, and a quantity along it.

/// Points of a way at which the map is asked: a parabola goes through them.
pub const NODES: usize = 3;
/// Below this length the pose is one and the same, rad.
const SHORT: f64 = 1e-3;

/// From the first position to the last.
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

    /// Start, middle and end, rad.
    pub fn nodes(&self) -> [f64; NODES] {
        [self.from, 0.5 * (self.from + self.to), self.to]
    }

    /// The value at a position of the parabola through the values at the nodes.
    pub fn value(&self, values: &[f64; NODES], position: f64) -> f64 {
        let length = self.to - self.from;
        if length.abs() < SHORT {
            return values[2];
        }
        // A little beyond the ends, as far as a motor side overshoots.
        let s = ((position - self.from) / length).clamp(-0.1, 1.1);
        values[0] * (2.0 * s - 1.0) * (s - 1.0)
            + values[1] * 4.0 * s * (1.0 - s)
            + values[2] * s * (2.0 * s - 1.0)
    }
}
