//! Where the commands of a joint may be: the last gate before the robot.
//!
//! Every plan was checked before. A command that is beyond all the same is not sent, nor any after it, until the
//! joint is commanded anew: it holds what it was sent last.

use quell_trajectories::Limits;

use crate::service::between::inexact;

/// Where the commands of a joint may be. No allocation.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    range: [f64; 2],
    /// The range, and where the joint was when its plan began: it may come back from beyond.
    allowed: [f64; 2],
    /// How far a command may be beyond them, rad.
    inexact: f64,
    left: bool,
}

impl Default for Reach {
    fn default() -> Self {
        let range = [f64::NEG_INFINITY, f64::INFINITY];
        Self {
            range,
            allowed: range,
            inexact: 0.0,
            left: false,
        }
    }
}

impl Reach {
    /// A range (rad) for commands within limits every `period` (s).
    pub fn new(range: [f64; 2], limits: Limits, period: f64) -> Self {
        Self {
            range,
            allowed: range,
            inexact: inexact(limits, period),
            left: false,
        }
    }

    /// A plan begins while the command is at this position; returns where commands may be from now on.
    pub fn begin(&mut self, position: f64) -> [f64; 2] {
        let [low, high] = self.range;
        self.allowed = [low.min(position), high.max(position)];
        self.allowed
    }

    /// The joint is commanded anew.
    pub fn restart(&mut self, position: f64) {
        self.left = false;
        self.begin(position);
    }

    /// Whether a command may be sent: no command since the joint is commanded was beyond.
    pub fn admits(&mut self, position: f64) -> bool {
        let [low, high] = self.allowed;
        let within = low - self.inexact..=high + self.inexact;
        self.left |= !within.contains(&position);
        !self.left
    }
}
