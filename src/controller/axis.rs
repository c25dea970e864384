//! One axis at the tick: measurements to estimate, estimate to train, plan to setpoint.

use quell_shapers::{
    GridTrain, ImpulseTrain, Mode, Setpoint, Shaper, ShaperError, ShapingFilter, residual_vibration,
};

use super::settings::{AxisSettings, Retune};
use crate::adaptation::{Adaptation, Decision};
use crate::estimators::{Estimate, Estimator, Sample};
use crate::signal::{DeformationSample, DeformationSensor, Measurement, Motion, RestDetector};

/// What an axis believes and does; plain numbers for logs and displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisStatus {
    /// The estimator's present estimate.
    pub estimate: Option<Estimate>,
    /// What the adaptation said of the last estimate.
    pub decision: Option<Decision>,
    /// The mode that the train in force was designed for.
    pub mode: Mode,
    /// Trains that were changed because of an estimate.
    pub retunes: u32,
    /// Corrections that were refused because no limit-keeping one was found.
    pub refused: u32,
    /// The last deformation sample.
    pub deformation: Option<DeformationSample>,
}

/// One axis of the controller.
pub struct Axis {
    settings: AxisSettings,
    sensor: DeformationSensor,
    rest: RestDetector,
    estimator: Box<dyn Estimator>,
    adaptation: Adaptation,
    filter: ShapingFilter,
    status: AxisStatus,
    fresh: bool,
}

impl Axis {
    /// An axis at rest at `position`; allocates all that it will ever need.
    ///
    /// # Errors
    /// [`quell_shapers::ShaperError`] where the belief cannot be shaped for at this rate.
    pub fn new(settings: AxisSettings, position: f64) -> Result<Self, ShaperError> {
        let capacity = (settings.longest_train / settings.sample_time).ceil() as usize;
        let mut filter = ShapingFilter::new(settings.sample_time, capacity);
        filter.reset(position);
        let train = design(settings.shaper, settings.belief, settings.sample_time)?;
        filter.install(&train)?;
        Ok(Self {
            sensor: settings.sensor.clone(),
            rest: RestDetector::new(settings.rest),
            estimator: (settings.estimator.build)(&settings.estimation),
            adaptation: Adaptation::new(settings.adaptation),
            filter,
            status: AxisStatus {
                estimate: None,
                decision: None,
                mode: settings.belief,
                retunes: 0,
                refused: 0,
                deformation: None,
            },
            fresh: false,
            settings,
        })
    }

    /// What the axis believes and does.
    pub fn status(&self) -> &AxisStatus {
        &self.status
    }

    /// Whether the command is constant and the train has run out.
    pub fn is_settled(&self) -> bool {
        self.filter.is_settled()
    }

    /// A move from rest begins: the mode may have changed since the last one.
    pub(super) fn begin_move(&mut self) {
        self.estimator.restart();
        self.status.estimate = None;
    }

    /// Takes a measurement. No allocation.
    pub(super) fn observe(&mut self, measurement: Measurement) {
        if let Measurement::MotorPosition { time, position } = measurement {
            self.watch(time, position);
        }
        self.sensor.observe(measurement);
        while let Some(sample) = self.sensor.next_sample() {
            self.status.deformation = Some(sample);
            if self.may_use(sample.time) {
                self.estimator.observe(Sample {
                    time: sample.time,
                    motor_position: sample.motor_position,
                    deformation: sample.deformation,
                });
                self.fresh = true;
            }
        }
    }

    /// Begins a new window with each free decay, for estimators that cannot use the motion.
    fn watch(&mut self, time: f64, position: f64) {
        let before = self.rest.motion();
        let now = self.rest.observe(time, position);
        if !self.settings.estimator.uses_motion && before == Motion::Moving && now == Motion::Rest {
            self.estimator.restart();
        }
    }

    fn may_use(&self, time: f64) -> bool {
        let free = self.rest.free_decay_from();
        self.settings.estimator.uses_motion || free.is_some_and(|from| time >= from)
    }

    /// One tick: adapts if there is a new estimate, then shapes `input`. No allocation, no failure.
    pub(super) fn step(&mut self, input: Setpoint, future: impl Fn(usize) -> Setpoint) -> Setpoint {
        if core::mem::take(&mut self.fresh) {
            self.status.estimate = self.estimator.estimate();
            if self.settings.adaptive {
                self.adapt(future);
            }
        }
        self.filter.step(input)
    }
}

impl Axis {
    /// The train in force.
    pub fn train(&self) -> ImpulseTrain {
        self.filter.train().to_impulses()
    }

    fn adapt(&mut self, _future: impl Fn(usize) -> Setpoint) {
        let (Some(estimate), Some(shaper)) = (self.status.estimate, self.settings.shaper) else {
            return;
        };
        let waiting = self
            .filter
            .pending()
            .unwrap_or(self.filter.train())
            .to_impulses();
        let left = |mode: Mode| {
            residual_vibration(&waiting, mode.natural_frequency(), mode.damping_ratio())
        };
        let decision = self.adaptation.consider(&estimate, shaper, left);
        self.status.decision = Some(decision);
        let Decision::Accept(mode) = decision else {
            return;
        };
        if let Ok(train) = shaper.on_grid(mode, self.settings.sample_time)
            && self.filter.install(&train).is_ok()
        {
            self.status.mode = mode;
            self.status.retunes += 1;
        }
    }
}

fn design(
    shaper: Option<&'static dyn Shaper>,
    mode: Mode,
    sample_time: f64,
) -> Result<GridTrain, ShaperError> {
    match shaper {
        Some(shaper) => shaper.on_grid(mode, sample_time),
        None => GridTrain::identity(sample_time),
    }
}
