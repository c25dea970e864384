//! The command of the joint, instant by instant.

/// The command at an instant; a cubic leads from one to the next.
#[derive(Clone, Copy, Debug)]
pub struct Knot {
    /// Since the start, s.
    pub time: f64,
    /// rad.
    pub position: f64,
    /// rad/s.
    pub velocity: f64,
}

/// One move: the command changes from `from` to `until` (s) and so leads from `start` to `target` (rad).
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// s.
    pub from: f64,
    /// s.
    pub until: f64,
    /// rad.
    pub start: f64,
    /// rad.
    pub target: f64,
}

/// A command from rest, and the moves in it.
#[derive(Debug)]
pub struct Motion {
    /// At least two, the first at time 0 and at rest.
    pub knots: Vec<Knot>,
    /// Moves with rest between them.
    pub legs: Vec<Leg>,
    /// Step of the positions, rad: their last digit, or that of a floating-point number.
    pub resolution: f64,
    /// Delay that shaping adds to the end of a move, s.
    pub added_delay: f64,
    /// Stamp of the first knot on the clock that the command was recorded with, s.
    pub stamp: f64,
    /// Remarks for the user.
    pub remarks: Vec<String>,
}

/// The step of floating-point numbers as large as the positions, with a digit to spare.
pub fn rounding(knots: &[Knot]) -> f64 {
    let largest = knots.iter().map(|knot| knot.position.abs());
    4.0 * f64::EPSILON * largest.fold(0.0, f64::max)
}

impl Motion {
    /// Time until which a leg's vibration is left alone: the next leg's beginning, or the end, s.
    pub fn watched_until(&self, leg: usize) -> f64 {
        let end = self.knots.last().map_or(0.0, |knot| knot.time);
        self.legs.get(leg + 1).map_or(end, |next| next.from)
    }
}
