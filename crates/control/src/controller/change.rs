//! Changes of a controller between two ticks.

use quell_shapers::{GridTrain, Refusal, RetuneOutcome, Shaper, ShaperError, UncertainMode};

use super::Controller;
use super::ahead::Ahead;
use crate::learning::Hold;
use quell_signal::DeformationSensor;

impl Controller {
    /// Sets whether the train follows the estimate. No allocation.
    pub fn set_adaptive(&mut self, adaptive: bool) {
        self.axis.settings.adaptive = adaptive;
    }

    /// Keeps up to so many samples of a move for a [`crate::learning::Learner`]. Allocates.
    pub fn keep_samples(&mut self, count: usize) {
        self.axis.keep_samples(count);
    }

    /// Clears the samples, for a caller that stores them itself. No allocation.
    pub fn clear_samples(&mut self) {
        self.axis.clear_samples();
    }

    /// Sets the reason not to follow the estimate, from [`crate::learning::Learner::prescribe`]; `None` allows
    /// following. No allocation.
    pub fn hold(&mut self, hold: Option<Hold>) {
        self.axis.hold = hold;
    }

    /// Shapes for another mode or by another rule: `train`, designed by `shaper` (none for a plan sent as it
    /// is) for the mode `known`, takes over once the command stands still. No allocation.
    ///
    /// # Errors
    /// [`ShaperError`] where the train is for another period, or too long; nothing has changed then.
    pub fn set_train(
        &mut self,
        shaper: Option<&'static dyn Shaper>,
        known: &UncertainMode,
        train: &GridTrain,
    ) -> Result<(), ShaperError> {
        self.axis.set_train(shaper, known, train)
    }

    /// Goes over to `train` in motion, and cancels what the one in force has left of one to three modes, as
    /// [`quell_shapers::AdaptiveFilter::retune`] does: within the limits, to the exact end, and only if that
    /// leaves less. `known` is the mode to be reported for the train. No allocation; the cost is that of a
    /// retune by an estimate.
    ///
    /// A refusal changes nothing. At rest a retune is refused, too: [`Self::set_train`] moves nothing.
    pub fn retune(
        &mut self,
        train: &GridTrain,
        known: &UncertainMode,
        modes: &[UncertainMode],
    ) -> RetuneOutcome {
        if self.is_settled() {
            return RetuneOutcome::Refused(Refusal::NotWorth(0.0));
        }
        let ahead = Ahead::new(self.plan.as_ref(), self.cursor, self.planned);
        self.axis.retune(train, known, modes, &ahead)
    }

    /// Whether a train waits for the command to stand still.
    pub fn is_train_waiting(&self) -> bool {
        self.axis.is_train_waiting()
    }

    /// Whether a correction in motion is under way.
    pub fn is_correcting(&self) -> bool {
        self.axis.filter.is_correcting()
    }

    /// Discards the estimator's samples, for example after a fault of the sensor. No allocation.
    pub fn restart_estimation(&mut self) {
        self.axis.restart_estimation();
    }

    /// Replaces the sensor, as after a registration, and gives the old one back, to be dropped off the
    /// tick.
    pub fn replace_sensor(&mut self, sensor: DeformationSensor) -> DeformationSensor {
        self.axis.replace_sensor(sensor)
    }
}
