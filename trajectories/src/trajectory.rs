//! A planned move of all axes.

use crate::{AxisProfile, AxisState};

/// A planned move of 1 to 7 axes that start and end together.
///
/// Plain data, independent of Ruckig: it may be sent to and shared with other threads.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    pub(crate) axes: Vec<AxisProfile>,
    pub(crate) duration: f64,
}

impl Trajectory {
    /// Duration of the move, s; 0 if it starts at its target.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// Number of axes.
    pub fn degrees_of_freedom(&self) -> usize {
        self.axes.len()
    }

    /// One profile for each axis.
    pub fn axes(&self) -> &[AxisProfile] {
        &self.axes
    }

    /// The state of every axis at `time` (s): the start before 0, exactly the end afterwards.
    ///
    /// Allocates the list; at the tick use [`Trajectory::axes`] and [`AxisProfile::state_at`].
    pub fn state_at(&self, time: f64) -> Vec<AxisState> {
        self.axes.iter().map(|axis| axis.state_at(time)).collect()
    }

    /// The state in which every axis ends.
    pub fn end(&self) -> Vec<AxisState> {
        self.axes.iter().map(AxisProfile::end).collect()
    }
}
