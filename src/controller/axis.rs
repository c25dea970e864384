//! One axis at the tick: measurements to estimate, estimate to train, plan to setpoint.

use quell_shapers::{
    AdaptiveFilter, Correction, GridTrain, ImpulseTrain, Mode, Retune, RetuneOutcome, Setpoint,
    Shaper, ShaperError, residual_vibration,
};

use super::ahead::Ahead;
use super::settings::{AxisSettings, RetunePolicy, motion_limits};
use crate::adaptation::{Adaptation, Decision};
use crate::estimators::{Estimate, Estimator, Sample};
use crate::signal::{DeformationSample, DeformationSensor, Measurement, Motion, RestDetector};

/// Length of the shortest correction, periods: five smooth steps of a quarter period.
const SHORTEST_CORRECTION: f64 = 1.25;

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
    /// Corrections sent; a correction need not change the train.
    pub corrections: u32,
    /// The last correction in motion.
    pub correction: Option<Correction>,
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
    filter: AdaptiveFilter,
    time: f64,
    since_plan_end: f64,
    last_forecast: f64,
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
        let horizon = (settings.longest_move / settings.sample_time).ceil() as usize;
        let mut filter = AdaptiveFilter::new(settings.sample_time, capacity, horizon);
        filter.reset(position);
        let train = design(settings.shaper, settings.belief, settings.sample_time)?;
        filter.install(&train)?;
        Ok(Self {
            sensor: settings.sensor.clone(),
            rest: RestDetector::new(settings.rest),
            estimator: (settings.estimator.build)(&settings.estimation),
            adaptation: Adaptation::new(settings.adaptation),
            filter,
            time: 0.0,
            since_plan_end: f64::INFINITY,
            last_forecast: f64::NEG_INFINITY,
            status: AxisStatus {
                estimate: None,
                decision: None,
                mode: settings.belief,
                retunes: 0,
                refused: 0,
                corrections: 0,
                correction: None,
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
        self.filter.step(ahead.setpoint(0))
    }
}

impl Axis {
    /// The train in force, or the one that is fading in.
    pub fn train(&self) -> ImpulseTrain {
        self.filter.train().to_impulses()
    }

    /// The train that the next move from rest will meet.
    pub fn next_train(&self) -> &GridTrain {
        self.filter.pending().unwrap_or(self.filter.train())
    }

    fn adapt(&mut self, ahead: &Ahead<'_>) {
        let (Some(mut estimate), Some(shaper)) = (self.status.estimate, self.settings.shaper)
        else {
            return;
        };
        // Once the plan has ended there is little more to learn: what is certain enough for the
        // adaptation is used then, settled or not.
        estimate.converged |= self.settings.estimator.states_error && ahead.remaining() == 0;
        let decision = match self.settings.retune {
            RetunePolicy::InMotion if self.is_ringing(estimate.mode) => {
                // The steps of a correction are a quarter period apart: more often gains nothing.
                // Counted by the axis' own time, since a frozen estimate does not advance.
                let pause = 0.25 * estimate.mode.damped_period();
                if estimate.converged && self.time - self.last_forecast < pause {
                    return;
                }
                if estimate.converged {
                    self.last_forecast = self.time;
                }
                self.consider_in_motion(&estimate, shaper, ahead)
            }
            _ => self.consider_at_rest(&estimate, shaper),
        };
        self.status.decision = Some(decision);
    }

    /// Whether anything is moving, or may still ring: five time constants of the envelope leave
    /// less than the dead band of 1 %.
    fn is_ringing(&self, mode: Mode) -> bool {
        !self.filter.is_settled() || self.since_plan_end * mode.decay_rate() < 5.0
    }

    fn consider_at_rest(&mut self, estimate: &Estimate, shaper: &dyn Shaper) -> Decision {
        let (waiting, tick) = (self.next_train().to_impulses(), self.settings.sample_time);
        let excess = |mode| excess_of(&waiting, shaper, mode, tick);
        let decision = self
            .adaptation
            .consider(estimate, self.time, shaper, excess);
        if let Decision::Accept(mode) = decision
            && let Ok(train) = shaper.on_grid(mode, tick)
        {
            self.install(&train, mode);
        }
        decision
    }

    fn consider_in_motion(
        &mut self,
        estimate: &Estimate,
        shaper: &dyn Shaper,
        ahead: &Ahead<'_>,
    ) -> Decision {
        let (remaining, planned) = (ahead.remaining(), |k: usize| ahead.setpoint(k - 1));
        let tick = self.settings.sample_time;
        let train = self.filter.train().duration();
        let since_end = match remaining {
            0 => self.since_plan_end,
            ticks => -(ticks as f64) * tick,
        };
        let filter = &mut self.filter;
        // A correction can leave nothing, but not before it is over: what is left is seen there.
        let excess = |mode: Mode| match filter.forecast(mode, remaining, planned) {
            Ok(residual) => {
                let soonest = since_end + SHORTEST_CORRECTION * mode.damped_period();
                residual.ratio() * (-mode.decay_rate() * train.max(soonest)).exp()
            }
            Err(_) => f64::INFINITY,
        };
        let decision = self
            .adaptation
            .consider(estimate, self.time, shaper, excess);
        if let Decision::Accept(mode) = decision
            && let Ok(train) = shaper.on_grid(mode, tick)
        {
            self.correct(&train, mode, shaper, remaining, planned);
        }
        decision
    }

    /// Cancels what the present command would leave, and goes over to a train for the mode if the
    /// one in force is worse by more than the dead band. Where no correction keeps the limits, the
    /// train waits for rest.
    fn correct(
        &mut self,
        designed: &GridTrain,
        mode: Mode,
        shaper: &dyn Shaper,
        remaining: usize,
        planned: impl Fn(usize) -> Setpoint,
    ) {
        let present = self.next_train();
        let tick = self.settings.sample_time;
        let excess = excess_of(&present.to_impulses(), shaper, mode, tick);
        let changes = excess >= self.settings.adaptation.dead_band;
        let train = if changes {
            designed.clone()
        } else {
            present.clone()
        };
        let request = Retune {
            train: &train,
            modes: &[mode],
            limits: motion_limits(self.settings.limits),
        };
        match self.filter.retune(&request, remaining, planned) {
            RetuneOutcome::Refused(_) => {
                self.status.refused += 1;
                if changes {
                    self.install(&train, mode);
                }
                return;
            }
            RetuneOutcome::Corrected(correction) => {
                self.status.correction = Some(correction);
                self.status.corrections += 1;
            }
            RetuneOutcome::Installed => {}
        }
        if changes {
            self.changed(mode);
        }
    }

    fn install(&mut self, train: &GridTrain, mode: Mode) {
        if self.filter.install(train).is_ok() {
            self.changed(mode);
        }
    }

    fn changed(&mut self, mode: Mode) {
        self.status.mode = mode;
        self.status.retunes += 1;
    }
}

/// V of a train at a mode beyond that of the train designed for it.
fn excess_of(train: &ImpulseTrain, shaper: &dyn Shaper, mode: Mode, sample_time: f64) -> f64 {
    let left = |train: &ImpulseTrain| {
        residual_vibration(train, mode.natural_frequency(), mode.damping_ratio())
    };
    match shaper.on_grid(mode, sample_time) {
        Ok(best) => left(train) - left(&best.to_impulses()),
        Err(_) => f64::INFINITY,
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
