//! The methods to determine frame and clock of a tip sensor from a recorded move of one joint.

use nalgebra::Point3;
use quell_shapers::Mode;

use super::{ArcRegistration, CubicSpline, JointArc, SignalError, register_arc, register_icp};

/// Method for frame and clock of a tip sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TipRegistration {
    /// By the plane and the circle of the arc, and the motor side's motion: [`register_arc`].
    Arc,
    /// By iterated closest points: [`register_icp`].
    Icp,
}

impl TipRegistration {
    /// All of them, the best first.
    pub const ALL: &[Self] = &[Self::Arc, Self::Icp];

    /// Name on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Icp => "icp",
        }
    }

    /// Its description, in a line.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Arc => {
                "plane and circle through the points, turned so that nothing deforms at rest"
            }
            Self::Icp => "iterated closest points: the path laid on that of the motor side",
        }
    }

    /// Determines frame and clock.
    ///
    /// # Errors
    /// As [`register_arc`] and [`register_icp`].
    pub fn register(
        self,
        arc: &JointArc,
        motor: &CubicSpline,
        time: &[f64],
        tip: &[Point3<f64>],
        belief: Option<Mode>,
    ) -> Result<ArcRegistration, SignalError> {
        match self {
            Self::Arc => register_arc(arc, motor, time, tip, belief),
            Self::Icp => register_icp(arc, motor, time, tip, belief),
        }
    }
}
