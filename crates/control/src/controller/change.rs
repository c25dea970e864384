//! What may be changed about an axis between two ticks.

use quell_shapers::{GridTrain, Shaper, ShaperError, UncertainMode};

use super::Controller;
use super::axis::Axis;
use quell_signal::DeformationSensor;

impl Controller {
    /// Whether the train of an axis follows the estimate from now on. Nothing happens where there is
    /// no such axis. No allocation.
    pub fn set_adaptive(&mut self, axis: usize, adaptive: bool) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.settings.adaptive = adaptive;
        }
    }

    /// Shapes for another mode or by another rule: `train`, designed by `shaper` (none for a plan sent as it
    /// is) for the mode `known`, takes over once the command of the axis stands still. No allocation.
    ///
    /// # Errors
    /// [`ShaperError`] where the train is for another period, or too long; nothing has changed then.
    pub fn set_train(
        &mut self,
        axis: usize,
        shaper: Option<&'static dyn Shaper>,
        known: &UncertainMode,
        train: &GridTrain,
    ) -> Result<(), ShaperError> {
        match self.axes.get_mut(axis) {
            Some(axis) => axis.set_train(shaper, known, train),
            None => Ok(()),
        }
    }

    /// Whether a train waits for an axis to stand still.
    pub fn is_train_waiting(&self, axis: usize) -> bool {
        self.axes.get(axis).is_some_and(Axis::is_train_waiting)
    }

    /// Forgets what the estimator of an axis has seen, as after a fault of its sensor. No allocation.
    pub fn restart_estimation(&mut self, axis: usize) {
        if let Some(axis) = self.axes.get_mut(axis) {
            axis.restart_estimation();
        }
    }

    /// Replaces the sensor of an axis, as after a registration, and gives the old one back, to be
    /// dropped off the tick.
    pub fn replace_sensor(
        &mut self,
        axis: usize,
        sensor: DeformationSensor,
    ) -> Option<DeformationSensor> {
        let axis = self.axes.get_mut(axis)?;
        Some(axis.replace_sensor(sensor))
    }
}
