//! One axis at the tick: measurements to estimate, estimate to train, plan to setpoint.

use quell_shapers::{
    AdaptiveFilter, Correction, GridTrain, ImpulseTrain, Setpoint, Shaper, ShaperError,
    UncertainMode,
};

use super::ahead::Ahead;
use super::corrected::Corrected;
use super::path::Lane;
use super::settings::AxisSettings;
use crate::adaptation::{Adaptation, Decision};
use crate::estimators::{Estimate, Estimator, Sample};
use crate::learning::Hold;
use quell_signal::{DeformationSample, DeformationSensor, Measurement, Motion, RestDetector};

/// The state of an axis: belief, train, counts; plain numbers for logs and displays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisStatus {
    /// The estimator's present estimate.
    pub estimate: Option<Estimate>,
    /// The adaptation's answer to the last estimate.
    pub decision: Option<Decision>,
    /// The mode of the train in force, and how well it was known at its design.
    pub shaped_for: UncertainMode,
    /// Trains that were changed because of an estimate.
    pub retunes: u32,
    /// Corrections that were refused because none keeps the limits.
    pub refused: u32,
    /// Corrections sent; a correction need not change the train.
    pub corrections: u32,
    /// The last correction in motion.
    pub correction: Option<Correction>,
    /// The last deformation sample.
    pub deformation: Option<DeformationSample>,
}

/// The axis of a controller.
pub struct Axis {
    pub(super) settings: AxisSettings,
    sensor: DeformationSensor,
    rest: RestDetector,
    pub(super) estimator: Box<dyn Estimator>,
    pub(super) adaptation: Adaptation,
    /// Not used where there is a lane.
    pub(super) filter: AdaptiveFilter,
    /// The trains of all axes, where the path in space is kept.
    pub(super) lane: Option<Lane>,
    pub(super) time: f64,
    pub(super) since_plan_end: f64,
    pub(super) last_considered: f64,
    /// The modes that the last correction was for, and how well they were known.
    pub(super) corrected: Corrected,
    pub(super) status: AxisStatus,
    /// The samples since the start of the last move, or since they were last cleared; limited by the capacity.
    heard: Vec<Sample>,
    /// Why the train is not followed, if it is not.
    pub(super) hold: Option<Hold>,
    /// The largest vibration that the planned input of the move would have left without shaping, rad.
    pub(super) unshaped: f64,
    fresh: bool,
    /// Number of changes of the command other than by the tick: of plan, train, corrections.
    pub(super) changes: u64,
}

impl Axis {
    /// An axis at rest at `position`; allocates all its memory.
    ///
    /// # Errors
    /// [`quell_shapers::ShaperError`] where the belief cannot be shaped for at this rate.
    pub fn new(settings: AxisSettings, position: f64) -> Result<Self, ShaperError> {
        let capacity = (settings.longest_train / settings.sample_time).ceil() as usize;
        let horizon = (settings.longest_move / settings.sample_time).ceil() as usize;
        let mut filter = AdaptiveFilter::new(settings.sample_time, capacity, horizon);
        filter.reset(position);
        let belief = UncertainMode::believed(settings.belief);
        let train = design(settings.shaper, &belief, settings.sample_time)?;
        filter.install(&train)?;
        Ok(Self {
            sensor: settings.sensor.clone(),
            rest: RestDetector::new(settings.rest),
            estimator: (settings.estimator.build)(&settings.estimation),
            adaptation: Adaptation::new(settings.adaptation),
            filter,
            lane: None,
            corrected: Corrected::of(&[belief]),
            time: 0.0,
            since_plan_end: f64::INFINITY,
            last_considered: f64::NEG_INFINITY,
            status: AxisStatus {
                estimate: None,
                decision: None,
                shaped_for: belief,
                retunes: 0,
                refused: 0,
                corrections: 0,
                correction: None,
                deformation: None,
            },
            heard: Vec::new(),
            hold: None,
            unshaped: 0.0,
            fresh: false,
            changes: 0,
            settings,
        })
    }

    /// The state of the axis: estimate, train, counts.
    pub fn status(&self) -> &AxisStatus {
        &self.status
    }

    /// The samples since the last move began, for a [`crate::learning::Learner`]. If they exceed the capacity,
    /// the first ones are kept.
    pub fn heard(&self) -> &[Sample] {
        &self.heard
    }

    /// Reserves memory for so many samples.
    pub(super) fn keep_samples(&mut self, count: usize) {
        self.heard = Vec::with_capacity(count);
    }

    /// Whether the command is constant and the train has run out.
    pub fn is_settled(&self) -> bool {
        self.lane.as_ref().is_none_or(Lane::is_settled) && self.filter.is_settled()
    }

    /// From now on the axis runs the trains of all axes in sequence.
    pub(super) fn enter(&mut self, lane: Lane) -> Result<(), ShaperError> {
        self.filter
            .install(&GridTrain::identity(self.settings.sample_time)?)?;
        self.lane = Some(lane);
        Ok(())
    }

    /// As [`super::Controller::set_train`].
    pub(super) fn set_train(
        &mut self,
        shaper: Option<&'static dyn Shaper>,
        known: &UncertainMode,
        train: &GridTrain,
    ) -> Result<(), ShaperError> {
        match &mut self.lane {
            Some(lane) => {
                if !lane.wait_with(train) {
                    let (ticks, capacity) = (train.duration_in_ticks(), lane.capacity());
                    return Err(ShaperError::TooLong { ticks, capacity });
                }
            }
            None => self.filter.install(train)?,
        }
        self.changes += 1;
        self.settings.shaper = shaper;
        self.status.shaped_for = *known;
        Ok(())
    }

    /// Whether a train waits for the axis to stand still.
    pub(super) fn is_train_waiting(&self) -> bool {
        let lane = self.lane.as_ref().is_some_and(Lane::is_train_waiting);
        lane || self.filter.pending().is_some()
    }

    /// Clears the samples for the next move.
    pub(super) fn clear_samples(&mut self) {
        self.heard.clear();
    }

    /// Discards all sensor samples.
    pub(super) fn restart_estimation(&mut self) {
        self.sensor.restart();
        self.rest = RestDetector::new(self.settings.rest);
        self.begin_move();
    }

    /// Replaces the sensor, and gives the old one back.
    pub(super) fn replace_sensor(&mut self, sensor: DeformationSensor) -> DeformationSensor {
        self.begin_move();
        core::mem::replace(&mut self.sensor, sensor)
    }

    /// Begins a move: the estimate of the last move does not hold for it.
    pub(super) fn begin_move(&mut self) {
        self.estimator.restart();
        self.status.estimate = None;
        self.unshaped = 0.0;
        self.heard.clear();
    }

    /// Takes a measurement. No allocation.
    pub(super) fn observe(&mut self, measurement: Measurement) {
        if let Measurement::MotorPosition { time, position } = measurement {
            self.watch(time, position);
        }
        self.sensor.observe(measurement);
        while let Some(sample) = self.sensor.next_sample() {
            self.status.deformation = Some(sample);
            let heard = Sample {
                time: sample.time,
                motor_position: sample.motor_position,
                deformation: sample.deformation,
            };
            if self.heard.len() < self.heard.capacity() {
                self.heard.push(heard);
            }
            if self.may_use(sample.time) {
                self.estimator.observe(heard);
                self.fresh = true;
            }
        }
    }

    /// Begins a new window with each free decay, for estimators that are not valid in motion.
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

    /// One tick: adapts if there is a new estimate, then shapes the first of the setpoints `ahead`.
    /// No allocation, no failure.
    pub(super) fn step(&mut self, ahead: &Ahead<'_>) -> Setpoint {
        if core::mem::take(&mut self.fresh) {
            self.status.estimate = self.estimator.estimate();
            if self.settings.adaptive {
                self.adapt(ahead);
            }
        }
        self.since_plan_end = match ahead.remaining() {
            0 => self.since_plan_end + self.settings.sample_time,
            _ => 0.0,
        };
        self.time += self.settings.sample_time;
        let planned = ahead.setpoint(0);
        let shaped = match &mut self.lane {
            Some(lane) => lane.step(planned),
            None => planned,
        };
        self.filter.step(shaped)
    }

    /// The train in force for this axis' mode, or the one that is fading in.
    pub fn train(&self) -> ImpulseTrain {
        let filter = || self.filter.train();
        self.lane
            .as_ref()
            .map_or_else(filter, Lane::own)
            .to_impulses()
    }

    /// The train for this axis' mode that the next move from rest will meet.
    pub fn next_train(&self) -> &GridTrain {
        waiting(self.lane.as_ref(), &self.filter)
    }
}

/// The train that the next move from rest will meet.
pub(super) fn waiting<'a>(lane: Option<&'a Lane>, filter: &'a AdaptiveFilter) -> &'a GridTrain {
    let own = || filter.pending().unwrap_or(filter.train());
    lane.map_or_else(own, Lane::next_own)
}

fn design(
    shaper: Option<&'static dyn Shaper>,
    known: &UncertainMode,
    sample_time: f64,
) -> Result<GridTrain, ShaperError> {
    match shaper {
        Some(shaper) => shaper.on_grid_for(known, sample_time),
        None => GridTrain::identity(sample_time),
    }
}
