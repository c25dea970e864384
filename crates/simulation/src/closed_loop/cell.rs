//! A simulated arm and the controller that commands it, tick by tick.

use quell_shapers::{Mode, Shaper};
use quell_trajectories::{Limits, Planner, SampledTrajectory};

use super::commissioning::commission;
use super::{ClosedLoopError, MoveTrace, Tick};
use crate::plant::{ArmSimulation, Command, MeasurementLog, Robot, SimulationOptions};
use quell_control::adaptation::AdaptationSettings;
use quell_control::controller::{
    AxisSettings, AxisStatus, Controller, RetunePolicy, Setpoint, SlowedPlan, plan_shaped,
};
use quell_control::estimators::{EstimatorEntry, Settings};
use quell_control::learning::{Learner, LearnerSettings, Prescription, Surroundings};
use quell_signal::{ArcRegistration, DeformationSensor, Measurement, RestRule};

/// Time for which the arm is observed after its command has ended, in periods of the believed mode.
const WATCHED_PERIODS: f64 = 12.0;
/// Longest duration of a move, s; sizes the buffers.
const LONGEST_MOVE: f64 = 20.0;

/// Distance of the tip from its target below which the motor side has followed, m: a tenth of the tracker's
/// noise. The rest of its motion causes a deformation of that size.
const FOLLOWED: f64 = 1e-6;
/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;

/// Settings of a cell.
#[derive(Clone)]
pub struct CellSettings {
    /// The robot.
    pub robot: Robot,
    /// Moved joint, counted from 0.
    pub joint: usize,
    /// How it is simulated.
    pub simulation: SimulationOptions,
    /// Displacement of the commissioning move, rad.
    pub displacement: f64,
    /// Limits of the moves.
    pub limits: Limits,
    /// The rule that designs trains; `None` sends plans unshaped.
    pub shaper: Option<&'static dyn Shaper>,
    /// The mode that is shaped for until a better one is known.
    pub belief: Mode,
    /// Whether the train follows the estimate.
    pub adaptive: bool,
    /// When a new train takes effect.
    pub retune: RetunePolicy,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
}

/// A move that is under way.
pub(super) struct Running {
    target: f64,
    planned_end: f64,
    slowed_to: Option<f64>,
    /// Length of the move's train, s.
    train: f64,
    /// The axis before the move.
    before: AxisStatus,
    ticks: Vec<Tick>,
    /// Time since the command has ended, s.
    quiet: f64,
    log: MeasurementLog,
}

/// A plan, unless its shaped command exceeds the limits at every tried speed.
///
/// # Errors
/// [`ClosedLoopError::Limits`].
pub(super) fn within_limits(slowed: SlowedPlan) -> Result<SlowedPlan, ClosedLoopError> {
    match slowed.peaks.worst() {
        ratio if ratio > 1.0 + ROUNDING => Err(ClosedLoopError::Limits {
            ratio,
            percent: slowed.speed * 100.0,
        }),
        _ => Ok(slowed),
    }
}

/// A simulated arm and its controller.
pub struct Cell {
    arm: ArmSimulation,
    controller: Controller,
    planner: Planner,
    limits: Limits,
    registration: ArcRegistration,
    watch: f64,
    inbox: Vec<Measurement>,
    /// Learns from move to move, if the train follows the estimate.
    learner: Option<Learner>,
    /// The prescription for the last move.
    prescribed: Option<Prescription>,
    shaper: Option<&'static dyn Shaper>,
}

impl Cell {
    /// A cell at rest, its tracker registered by a slow commissioning move.
    ///
    /// # Errors
    /// [`ClosedLoopError`] where the robot cannot be simulated, registered or shaped for.
    pub fn new(settings: &CellSettings) -> Result<Self, ClosedLoopError> {
        let mut arm = ArmSimulation::new(&settings.robot, settings.joint, &settings.simulation)?;
        let registration = commission(&mut arm, settings.displacement, settings.limits)?;
        let sensor =
            DeformationSensor::new(*arm.arc(), registration.sensor_to_base, registration.clock);
        let robot = &settings.robot;
        let sample_time = 1.0 / robot.control_rate;
        let belief = settings.belief;
        let adaptation = AdaptationSettings::around(belief);
        let [low, high] = adaptation.natural_frequency;
        let axis = AxisSettings {
            sample_time,
            limits: settings.limits,
            shaper: settings.shaper,
            belief,
            adaptive: settings.adaptive,
            retune: settings.retune,
            estimator: settings.estimator,
            estimation: Settings {
                // Every mode that may be accepted must be in the estimator's range.
                frequency_range: (low, high),
                ..Settings::around(belief, 1.0 / robot.tracker.rate)
            },
            adaptation,
            rest: RestRule::new(0.0, robot.encoder.resolution),
            sensor,
            longest_train: 4.0 * belief.damped_period(),
            longest_move: LONGEST_MOVE,
        };
        let (dead_band, longest_train) = (axis.adaptation.dead_band, axis.longest_train);
        let learns = axis.adaptive && axis.shaper.is_some();
        let samples = (LONGEST_MOVE * robot.tracker.rate) as usize;
        let mut controller = Controller::new(axis, arm.true_motor_position())?;
        if learns {
            controller.keep_samples(samples);
        }
        let learner = || {
            Learner::new(LearnerSettings {
                belief,
                natural_frequency: [low, high],
                dead_band,
                longest_train,
                base: controller.axis().next_train().clone(),
                inertia: None,
            })
        };
        Ok(Self {
            learner: learns.then(learner),
            prescribed: None,
            shaper: settings.shaper,
            controller,
            planner: Planner::new(1)?,
            limits: settings.limits,
            registration,
            watch: WATCHED_PERIODS * belief.damped_period(),
            inbox: Vec::with_capacity(256),
            arm,
        })
    }

    /// The arm, for values that only a simulation knows.
    pub fn arm(&self) -> &ArmSimulation {
        &self.arm
    }

    /// Position of the command, rad.
    pub fn position(&self) -> f64 {
        self.controller.planned().position
    }

    /// Moves to `target` (rad) and observes the arm until its vibration has decayed.
    ///
    /// # Errors
    /// [`ClosedLoopError::Plan`] where the move cannot be planned; [`ClosedLoopError::Limits`] where a train
    /// with negative impulses exceeds the limits at every speed.
    pub fn run_move(&mut self, target: f64) -> Result<MoveTrace, ClosedLoopError> {
        let ends = [self.position(), target];
        let mut slowed = self.plan(ends)?;
        if self.prescribe(&slowed.plan)? {
            slowed = self.plan(ends)?;
        }
        let plan = slowed.plan.clone();
        let mut running = self.begin(slowed, target)?;
        while !self.is_over(&running) {
            self.tick(&mut running);
        }
        if let Some(learner) = &mut self.learner {
            learner.learn(
                self.controller.axis().heard(),
                &plan,
                &Surroundings::default(),
            );
        }
        Ok(self.end(running))
    }

    /// Sends a given plan to `target` (rad), and observes the arm until its vibration has decayed.
    ///
    /// # Errors
    /// [`ClosedLoopError::Load`] where the controller refuses it.
    pub fn run_plan(
        &mut self,
        plan: SampledTrajectory,
        target: f64,
    ) -> Result<MoveTrace, ClosedLoopError> {
        let mut running = self.begin(SlowedPlan::at_full_speed(plan), target)?;
        while !self.is_over(&running) {
            self.tick(&mut running);
        }
        Ok(self.end(running))
    }

    fn plan(&self, ends: [f64; 2]) -> Result<SlowedPlan, ClosedLoopError> {
        let train = self.controller.axis().next_train();
        within_limits(plan_shaped(&self.planner, ends, self.limits, train)?)
    }

    /// Sets the train that was learned from earlier moves for a plan; returns whether it is another one.
    fn prescribe(&mut self, plan: &SampledTrajectory) -> Result<bool, ClosedLoopError> {
        let Some(learner) = &mut self.learner else {
            return Ok(false);
        };
        let in_force = self.controller.axis().next_train();
        let prescribed = learner.prescribe(plan, &Surroundings::default(), in_force);
        self.controller.hold(prescribed.hold);
        let set = prescribed.train.as_ref().zip(prescribed.known.as_ref());
        let changes = set.is_some();
        if let Some((train, known)) = set {
            self.controller.set_train(self.shaper, known, train)?;
        }
        self.prescribed = Some(prescribed);
        Ok(changes)
    }

    /// The controller, for moves of several cells together.
    pub(super) fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The same, to join it with others.
    pub(super) fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }

    /// Loads a plan to `target` (rad), which begins with the next tick.
    ///
    /// # Errors
    /// [`ClosedLoopError::Load`] where the controller refuses it.
    pub(super) fn begin(
        &mut self,
        slowed: SlowedPlan,
        target: f64,
    ) -> Result<Running, ClosedLoopError> {
        let plan = slowed.plan;
        let axis = self.controller.axis();
        let running = Running {
            target,
            planned_end: (plan.samples() - 1) as f64 * plan.period(),
            slowed_to: (slowed.speed < 1.0).then_some(slowed.speed),
            train: axis.next_train().duration(),
            before: *axis.status(),
            ticks: Vec::new(),
            quiet: 0.0,
            log: MeasurementLog::new(),
        };
        self.controller.load(plan).map_err(|(_, error)| error)?;
        Ok(running)
    }

    /// Whether the arm has been observed long enough after its command has ended.
    pub(super) fn is_over(&self, running: &Running) -> bool {
        let time = running.ticks.len() as f64 * self.controller.sample_time();
        running.quiet >= self.watch || time >= LONGEST_MOVE
    }

    /// One control period of controller and arm.
    pub(super) fn tick(&mut self, running: &mut Running) {
        let period = self.controller.sample_time();
        let setpoint = self.controller.tick(&self.inbox);
        let time = running.ticks.len() as f64 * period;
        running.ticks.push(self.observe(time, setpoint));
        self.move_arm(setpoint, period, &mut running.log);
        running.quiet = match self.controller.is_settled() {
            true => running.quiet + period,
            false => 0.0,
        };
    }

    /// The trace of a move that is over.
    pub(super) fn end(&self, running: Running) -> MoveTrace {
        let Running { target, ticks, .. } = running;
        let axis = self.controller.axis();
        let (before, after) = (running.before, axis.status());
        MoveTrace {
            period: self.controller.sample_time(),
            target,
            planned_end: running.planned_end,
            command_end: command_end(&ticks),
            motor_end: motor_end(&ticks, target, FOLLOWED / self.arm.arc().radius()),
            arc: *self.arm.arc(),
            registration: self.registration.clone(),
            train: axis.train(),
            longest_train: axis.next_train().duration().max(running.train),
            slowed_to: running.slowed_to,
            shaped_for: after.shaped_for,
            retunes: after.retunes - before.retunes,
            refused: after.refused - before.refused,
            corrections: after.corrections - before.corrections,
            prescribed: self.prescribed.clone(),
            ticks,
            recording: running.log.into_recording(&self.arm.robot().name),
        }
    }

    fn move_arm(&mut self, setpoint: Setpoint, period: f64, log: &mut MeasurementLog) {
        let command = Command {
            position: setpoint.position,
            velocity: Some(setpoint.velocity),
        };
        self.inbox.clear();
        self.inbox
            .extend_from_slice(log.step(&mut self.arm, command, period));
    }

    fn observe(&self, time: f64, setpoint: Setpoint) -> Tick {
        let status = self.controller.axis().status();
        Tick {
            time,
            planned: self.controller.planned().position,
            planned_acceleration: self.controller.planned().acceleration,
            position: setpoint.position,
            velocity: setpoint.velocity,
            acceleration: setpoint.acceleration,
            motor_position: self.arm.true_motor_position(),
            tip_deformation: self.arm.true_tip_deformation(),
            measured: status.deformation.map(|sample| sample.tip_deformation),
            estimate: status.estimate,
        }
    }
}

/// Time of the last change of the command.
fn command_end(ticks: &[Tick]) -> f64 {
    let changed = |pair: &[Tick]| pair[0].position != pair[1].position;
    ticks
        .windows(2)
        .rposition(changed)
        .map_or(0.0, |last| ticks[last + 1].time)
}

/// The time from which the motor side stays within `tolerance` of the target.
fn motor_end(ticks: &[Tick], target: f64, tolerance: f64) -> f64 {
    let away = |tick: &Tick| (tick.motor_position - target).abs() > tolerance;
    let last = ticks.iter().rposition(away);
    last.map_or(0.0, |last| ticks.get(last + 1).unwrap_or(&ticks[last]).time)
}
