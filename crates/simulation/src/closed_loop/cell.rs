//! A simulated arm and the controller that commands it, tick by tick.

use quell_shapers::{Mode, Shaper};
use quell_trajectories::{Limits, Planner};

use super::commissioning::commission;
use super::{ClosedLoopError, MoveTrace, Tick};
use crate::plant::{ArmSimulation, Command, MeasurementLog, Robot, SimulationOptions};
use quell_control::adaptation::AdaptationSettings;
use quell_control::controller::{AxisSettings, Controller, RetunePolicy, Setpoint, plan_shaped};
use quell_control::estimators::{EstimatorEntry, Settings};
use quell_signal::{ArcRegistration, DeformationSensor, Measurement, RestRule};

/// The arm is watched for this many periods of the believed mode after its command has ended.
const WATCHED_PERIODS: f64 = 12.0;
/// No move lasts longer than this, s; sizes the buffers.
const LONGEST_MOVE: f64 = 20.0;

/// Distance of the tip from its target below which the motor side has followed, m: a tenth of the
/// tracker's noise. What is still to come of its motion forces a deformation of that size.
const FOLLOWED: f64 = 1e-6;
/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;

/// What a cell is made of.
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
    /// The rule that designs trains; `None` sends plans as they are.
    pub shaper: Option<&'static dyn Shaper>,
    /// The mode that is shaped for until a better one is learned.
    pub belief: Mode,
    /// Whether the train follows the estimate.
    pub adaptive: bool,
    /// When a new train takes effect.
    pub retune: RetunePolicy,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
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
                // What may be accepted must be looked for.
                frequency_range: (low, high),
                ..Settings::around(belief, 1.0 / robot.tracker.rate)
            },
            adaptation,
            rest: RestRule::new(0.0, robot.encoder.resolution),
            sensor,
            longest_train: 4.0 * belief.damped_period(),
            longest_move: LONGEST_MOVE,
        };
        Ok(Self {
            controller: Controller::new(axis, arm.true_motor_position())?,
            planner: Planner::new(1)?,
            limits: settings.limits,
            registration,
            watch: WATCHED_PERIODS * belief.damped_period(),
            inbox: Vec::with_capacity(256),
            arm,
        })
    }

    /// The arm, for what only a simulation can tell.
    pub fn arm(&self) -> &ArmSimulation {
        &self.arm
    }

    /// Where the command stands, rad.
    pub fn position(&self) -> f64 {
        self.controller.planned().position
    }

    /// Moves to `target` (rad) and watches the arm ring out.
    ///
    /// # Errors
    /// [`ClosedLoopError::Plan`] where the move cannot be planned; [`ClosedLoopError::Limits`] where a
    /// train with negative impulses exceeds the limits however slow the move.
    pub fn run_move(&mut self, target: f64) -> Result<MoveTrace, ClosedLoopError> {
        let train = self.controller.axis().next_train().clone();
        let ends = [self.position(), target];
        let slowed = plan_shaped(&self.planner, ends, self.limits, &train)?;
        if slowed.peaks.worst() > 1.0 + ROUNDING {
            return Err(ClosedLoopError::Limits {
                ratio: slowed.peaks.worst(),
                percent: slowed.speed * 100.0,
            });
        }
        let sampled = slowed.plan;
        let before_it = train.duration();
        let planned_end = (sampled.samples() - 1) as f64 * sampled.period();
        let before = *self.controller.axis().status();
        self.controller.load(sampled).map_err(|(_, error)| error)?;
        let mut log = MeasurementLog::new();
        let ticks = self.run_until_quiet(&mut log);
        let axis = self.controller.axis();
        let after = axis.status();
        Ok(MoveTrace {
            period: self.controller.sample_time(),
            target,
            planned_end,
            command_end: command_end(&ticks),
            motor_end: motor_end(&ticks, target, FOLLOWED / self.arm.arc().radius()),
            arc: *self.arm.arc(),
            registration: self.registration.clone(),
            train: axis.train(),
            longest_train: axis.next_train().duration().max(before_it),
            slowed_to: (slowed.speed < 1.0).then_some(slowed.speed),
            shaped_for: after.shaped_for,
            retunes: after.retunes - before.retunes,
            refused: after.refused - before.refused,
            corrections: after.corrections - before.corrections,
            ticks,
            recording: log.into_recording(&self.arm.robot().name),
        })
    }

    fn run_until_quiet(&mut self, log: &mut MeasurementLog) -> Vec<Tick> {
        let period = self.controller.sample_time();
        let mut ticks: Vec<Tick> = Vec::new();
        let mut quiet = 0.0;
        while quiet < self.watch && ticks.len() as f64 * period < LONGEST_MOVE {
            let setpoint = self.controller.tick(&self.inbox);
            ticks.push(self.observe(ticks.len() as f64 * period, setpoint));
            self.move_arm(setpoint, period, log);
            quiet = if self.controller.is_settled() {
                quiet + period
            } else {
                0.0
            };
        }
        ticks
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

/// From when on the motor side stays within `tolerance` of the target.
fn motor_end(ticks: &[Tick], target: f64, tolerance: f64) -> f64 {
    let away = |tick: &Tick| (tick.motor_position - target).abs() > tolerance;
    let last = ticks.iter().rposition(away);
    last.map_or(0.0, |last| ticks.get(last + 1).unwrap_or(&ticks[last]).time)
}
