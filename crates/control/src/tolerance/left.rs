//! What a move leaves, over what is allowed.

use quell_trajectories::SampledTrajectory;

use super::known::Known;
use super::{Bounds, Fastest, Tolerance};

/// What a move leaves.
#[derive(Clone, Copy)]
pub struct Left {
    pub bounds: Bounds,
    /// The largest amplitude of a joint over the allowed one: at most 1 within the tolerance.
    pub excess: f64,
}

/// A move that was tried: within the tolerance, or what it leaves; nothing where it cannot be made.
pub type Tried = Result<Fastest, Option<Left>>;

impl Left {
    /// From the amplitude of each joint (rad) and the departure from the path (m).
    pub fn new<'a>(joints: impl Iterator<Item = (&'a Known, f64)>, departure: f64) -> Self {
        let (mut residual, mut vibration, mut excess): (f64, f64, f64) = (0.0, 0.0, 0.0);
        for (known, left) in joints {
            if left > 0.0 {
                excess = excess.max(left / known.allowed);
                residual = residual.max(left / known.unshaped);
            }
            vibration = vibration.max(left * known.lever);
        }
        let bounds = Bounds {
            residual,
            vibration,
            departure,
        };
        Self { bounds, excess }
    }

    /// The move, if that is within the tolerance.
    pub fn within(self, plans: impl FnOnce() -> Option<Vec<SampledTrajectory>>) -> Tried {
        if self.excess > 1.0 {
            return Err(Some(self));
        }
        let Self { bounds, .. } = self;
        plans().map(|plans| Fastest { plans, bounds }).ok_or(None)
    }

    /// A tolerance that the move is within, where it is not within this one.
    pub fn needed(&self, tolerance: Tolerance) -> Tolerance {
        let Bounds {
            residual,
            vibration,
            ..
        } = self.bounds;
        Tolerance {
            residual: tolerance.residual.map(|allowed| allowed.max(residual)),
            deviation: tolerance.deviation.map(|allowed| allowed.max(vibration)),
        }
    }
}

/// What the better of two moves leaves.
pub fn least(one: Option<Left>, other: Option<Left>) -> Option<Left> {
    let both = one.into_iter().chain(other);
    both.min_by(|one, other| one.excess.total_cmp(&other.excess))
}
