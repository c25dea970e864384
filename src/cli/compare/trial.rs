//! The simulation of the robot's own move, with the machine's frequency different from the believed one.

use crate::cli::{CliError, effort::affordable, shaping};
use crate::controller::setpoint;
use crate::plant::{ArmSimulation, Command, ModeOfJoint, Robot, SimulationOptions};
use quell_shapers::{GridTrain, Mode, ShapingFilter};
use quell_trajectories::{AxisState, SampledTrajectory};

/// Observation time after arrival, in periods of the arm's first mode: the greatest deflection of a decaying
/// oscillation lies within the first half.
const WATCHED_PERIODS: f64 = 2.0;
/// Longest time for the servo to follow the command, s.
const FOLLOWING: f64 = 2.0;

/// The robot's move, made by one of its joints with each shaper.
pub struct Trial<'a> {
    robot: &'a Robot,
    joint: usize,
}

/// The result of the move with one shaper.
pub struct Simulated {
    /// Greatest tip deformation after the move, mm, one for each frequency error; NaN if the servo has not
    /// brought the motor side to its target.
    pub residual_mm: Vec<f64>,
    /// Speed of the plan, below 1 where the shaper's negative impulses would exceed the limits.
    pub speed: f64,
}

impl<'a> Trial<'a> {
    /// The displacement of the robot's default move, made by joint `joint` (counted from 0) from
    /// the home pose, within its limits.
    pub fn new(robot: &'a Robot, joint: usize) -> Self {
        Self { robot, joint }
    }

    /// Makes the move shaped by `train`, once for each of the frequency errors.
    ///
    /// # Errors
    /// [`CliError::Input`] where the move cannot be planned within the limits, or takes too long to
    /// simulate.
    pub fn run(&self, train: &GridTrain, errors: &[f64]) -> Result<Simulated, CliError> {
        let joint = &self.robot.joints[self.joint];
        let ends = [joint.home, joint.home + self.robot.default_move.target];
        let planned = shaping::plan(ends, joint.limits, train)?;
        let residual = |error: &f64| Ok(1e3 * self.residual(&planned.plan, train, *error)?);
        Ok(Simulated {
            residual_mm: errors
                .iter()
                .map(residual)
                .collect::<Result<_, CliError>>()?,
            speed: planned.speed,
        })
    }

    /// The greatest deformation at the tip, m, after the end of the command and once the motor side is within
    /// one encoder step of it. The frequencies of all modes are `1 + error` times those of the description. NaN
    /// if the motor side does not come that close.
    fn residual(
        &self,
        plan: &SampledTrajectory,
        train: &GridTrain,
        error: f64,
    ) -> Result<f64, CliError> {
        let period = train.sample_time();
        let modes = self.scaled(error)?;
        let watched = WATCHED_PERIODS * modes.first().map_or(0.0, |mode| mode.mode.damped_period());
        let moving = plan.samples() + train.duration_in_ticks();
        let last = moving + ((FOLLOWING + watched) / period) as usize;
        let mut arm = self.arm(modes, last as f64 * period)?;
        let mut filter = ShapingFilter::new(period, train.duration_in_ticks());
        filter.install(train).map_err(CliError::input)?;
        let target = plan.positions(0)[plan.samples() - 1];
        filter.reset(plan.positions(0)[0]);

        let (mut peak, mut arrived) = (0.0_f64, None);
        for tick in 0..last {
            let planned = plan.state(0, tick).unwrap_or(AxisState::at_rest(target));
            let shaped = filter.step(setpoint(planned));
            let command = Command {
                position: shaped.position,
                velocity: Some(shaped.velocity),
            };
            arm.step(command, period);
            let follows = (arm.true_motor_position() - target).abs() <= self.tolerance();
            if tick >= moving && follows {
                arrived.get_or_insert(arm.time());
            }
            let Some(arrived) = arrived else { continue };
            peak = peak.max(arm.true_tip_deformation().abs());
            if arm.time() - arrived >= watched {
                break;
            }
        }
        Ok(arrived.map_or(f64::NAN, |_| peak))
    }

    /// The arm with these modes, if `duration` (s) of it can be simulated.
    fn arm(&self, modes: Vec<ModeOfJoint>, duration: f64) -> Result<ArmSimulation, CliError> {
        affordable(duration, self.robot, &modes)?;
        let options = SimulationOptions {
            modes: Some(modes),
            ..SimulationOptions::default()
        };
        ArmSimulation::new(self.robot, self.joint, &options).map_err(CliError::input)
    }

    /// One encoder step, or a millionth of a turn with an ideal encoder.
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
