//! The robot's own move, simulated with the machine's frequency beside the believed one.

use crate::cli::CliError;
use crate::plant::{ArmSimulation, Command, ModeOfJoint, Robot, SimulationOptions};
use quell_shapers::{GridTrain, Mode, Setpoint, ShapingFilter};
use quell_trajectories::{AxisState, Limits, Planner};

/// The arm is watched for this many periods of its first mode after it has arrived: the greatest
/// deflection of a decaying oscillation lies within the first half.
const WATCHED_PERIODS: f64 = 2.0;
/// The longest that the servo may take to follow the command, s.
const FOLLOWING: f64 = 2.0;

/// A move to make with each shaper.
pub struct Trial<'a> {
    robot: &'a Robot,
    joint: usize,
    plan: Vec<Setpoint>,
}

impl<'a> Trial<'a> {
    /// The displacement of the robot's default move, made by joint `joint` (counted from 0) from
    /// the home pose, within its limits.
    pub fn new(robot: &'a Robot, joint: usize) -> Result<Self, CliError> {
        let limits = robot.joints[joint].limits;
        let limits = Limits {
            velocity: limits.velocity,
            acceleration: limits.acceleration,
            jerk: limits.jerk,
        };
        let home = robot.joints[joint].home;
        let (from, to) = (home, home + robot.default_move.target);
        let plan = Planner::new(1)
            .and_then(|planner| {
                planner.plan(
                    &[AxisState::at_rest(from)],
                    &[AxisState::at_rest(to)],
                    &[limits],
                )
            })
            .and_then(|trajectory| trajectory.sample(1.0 / robot.control_rate))
            .map_err(CliError::input)?;
        let setpoint = |tick| {
            let state = plan.state(0, tick).unwrap_or(AxisState::at_rest(to));
            let AxisState {
                position,
                velocity,
                acceleration,
            } = state;
            Setpoint {
                position,
                velocity,
                acceleration,
            }
        };
        Ok(Self {
            robot,
            joint,
            plan: (0..plan.samples()).map(setpoint).collect(),
        })
    }

    /// The greatest deformation at the tip, m, once the command has ended and the motor side has
    /// come to within one encoder step of it; the frequencies of all modes are `1 + error` times
    /// those of the description.
    pub fn residual(&self, train: &GridTrain, error: f64) -> Result<f64, CliError> {
        let modes = self.scaled(error)?;
        let first = modes.first().map_or(0.0, |mode| mode.mode.damped_period());
        let options = SimulationOptions {
            modes: Some(modes),
            ..SimulationOptions::default()
        };
        let mut arm =
            ArmSimulation::new(self.robot, self.joint, &options).map_err(CliError::input)?;
        let mut filter = ShapingFilter::new(train.sample_time(), train.duration_in_ticks());
        filter.install(train).map_err(CliError::input)?;
        filter.reset(self.plan[0].position);

        let target = self.plan[self.plan.len() - 1];
        let moving = self.plan.len() + train.duration_in_ticks();
        let watched = (FOLLOWING + WATCHED_PERIODS * first) / train.sample_time();
        let (mut peak, mut left) = (0.0_f64, WATCHED_PERIODS * first);
        for tick in 0..moving + watched as usize {
            let Setpoint {
                position, velocity, ..
            } = filter.step(self.plan.get(tick).copied().unwrap_or(target));
            arm.step(
                Command {
                    position,
                    velocity: Some(velocity),
                },
                train.sample_time(),
            );
            let follows = (arm.true_motor_position() - target.position).abs();
            if tick < moving || (left == WATCHED_PERIODS * first && follows > self.tolerance()) {
                continue;
            }
            peak = peak.max(arm.true_tip_deformation().abs());
            left -= train.sample_time();
            if left <= 0.0 {
                break;
            }
        }
        Ok(peak)
    }

    /// One encoder step, or a millionth of a turn where the encoder is ideal.
    fn tolerance(&self) -> f64 {
        self.robot
            .encoder
            .resolution
            .max(std::f64::consts::TAU * 1e-6)
    }

    fn scaled(&self, error: f64) -> Result<Vec<ModeOfJoint>, CliError> {
        let scale = |entry: &ModeOfJoint| {
            let frequency = (1.0 + error) * entry.mode.natural_frequency();
            let mode = Mode::new(frequency, entry.mode.damping_ratio())?;
            Ok(ModeOfJoint { mode, ..*entry })
        };
        let modes = self.robot.joints[self.joint].modes.iter().map(scale);
        modes
            .collect::<Result<_, quell_shapers::ModeError>>()
            .map_err(CliError::input)
    }
}
