//! Jerk-limited moves from rest to rest, shaped or not.

use quell_shapers::{GridTrain, Setpoint, ShapingFilter, UncertainMode};
use quell_trajectories::SampledTrajectory;

use super::Args;
use super::motion::{Knot, Leg, Motion, rounding};
use super::setup::Setup;
use crate::cli::{CliError, effort::affordable, shaping};
use crate::controller::{SlowedPlan, setpoint};
use crate::tolerance::{self, Moving, Tolerance};

/// Rest before the first move, s: it records the sensors of a joint at rest.
const REST: f64 = 0.5;

/// The moves of the arguments, one after the other, with rest before and after each.
pub fn plan(args: &Args, setup: &Setup) -> Result<Motion, CliError> {
    let start = setup.pose[setup.joint];
    let train = train(args, setup)?;
    let limits = setup.robot.joints[setup.joint].limits;
    let mut writer = Writer::new(start, &train, setup)?;
    writer.rest(REST)?;
    let (mut at, mut speed) = (start, 1.0_f64);
    for target in targets(args, setup)? {
        let target = start + target;
        let planned = match shaping::tolerance(args.residual, args.deviation) {
            None => shaping::plan([at, target], limits, &train)?,
            Some(tolerance) => fastest(setup, [at, target], tolerance)?,
        };
        writer.leg(&planned.plan)?;
        writer.rest(setup.dwell(args))?;
        (at, speed) = (target, speed.min(planned.speed));
    }
    let slowed = args.shaper.filter(|_| speed < 1.0);
    let slowed = slowed.map(|shaper| shaping::slowed(shaper.name(), speed));
    Ok(Motion {
        resolution: rounding(&writer.knots),
        knots: writer.knots,
        legs: writer.legs,
        added_delay: train.duration(),
        stamp: 0.0,
        remarks: slowed.into_iter().collect(),
    })
}

/// The fastest move within a tolerance, for the believed modes.
fn fastest(setup: &Setup, ends: [f64; 2], tolerance: Tolerance) -> Result<SlowedPlan, CliError> {
    let arc = setup.robot.chain.arc(&setup.pose, setup.joint);
    let modes = setup.belief.iter().copied().map(UncertainMode::believed);
    let moving = Moving {
        ends,
        limits: setup.robot.joints[setup.joint].limits,
        modes: modes.collect(),
        lever: arc.map_err(CliError::input)?.radius(),
    };
    let found = tolerance::fastest(&[moving], tolerance, 1.0 / setup.robot.control_rate);
    let plan = found.map_err(CliError::input)?.plans.remove(0);
    Ok(SlowedPlan::at_full_speed(plan))
}

/// Targets relative to the initial position, rad.
fn targets(args: &Args, setup: &Setup) -> Result<Vec<f64>, CliError> {
    if args.target.is_empty() {
        return Ok(vec![setup.robot.default_move.target]);
    }
    let mut at = 0.0;
    for &target in &args.target {
        if target == at {
            return Err(CliError::input(format!(
                "--target {target}: the joint stands there already"
            )));
        }
        at = target;
    }
    Ok(args.target.iter().map(|deg| deg.to_radians()).collect())
}

/// The shaper's taps for all believed modes.
fn train(args: &Args, setup: &Setup) -> Result<GridTrain, CliError> {
    let sample_time = 1.0 / setup.robot.control_rate;
    let Some(shaper) = args.shaper else {
        return GridTrain::identity(sample_time).map_err(CliError::input);
    };
    if setup.belief.is_empty() {
        let (name, joint, robot) = (shaper.name(), setup.joint + 1, &setup.robot.name);
        let text = format!("--shaper {name}: joint {joint} of {robot} has no mode to shape for");
        return Err(CliError::input(text).with_help("give one: --belief 8.12,0.084"));
    }
    let belief = setup.belief.iter().copied().map(UncertainMode::believed);
    shaping::train(shaper, belief, sample_time).map_err(CliError::input)
}

/// Sends setpoints through the shaper and records its output, tick by tick.
struct Writer<'a> {
    setup: &'a Setup,
    filter: ShapingFilter,
    train_ticks: usize,
    knots: Vec<Knot>,
    legs: Vec<Leg>,
}

impl<'a> Writer<'a> {
    fn new(start: f64, train: &GridTrain, setup: &'a Setup) -> Result<Self, CliError> {
        let mut filter = ShapingFilter::new(train.sample_time(), train.duration_in_ticks());
        filter.install(train).map_err(CliError::input)?;
        filter.reset(start);
        let mut writer = Self {
            setup,
            filter,
            train_ticks: train.duration_in_ticks(),
            knots: Vec::new(),
            legs: Vec::new(),
        };
        writer.tick(Setpoint::at_rest(start));
        Ok(writer)
    }

    fn tick(&mut self, planned: Setpoint) {
        let Setpoint {
            position, velocity, ..
        } = self.filter.step(planned);
        self.knots.push(Knot {
            time: self.knots.len() as f64 / self.setup.robot.control_rate,
            position,
            velocity,
        });
    }

    fn last(&self) -> Knot {
        self.knots[self.knots.len() - 1]
    }

    /// Refuses a command that would become too long by `duration` (s).
    fn affordable(&self, duration: f64) -> Result<(), CliError> {
        let Setup { robot, modes, .. } = self.setup;
        affordable(self.last().time + duration, robot, modes)
    }

    fn rest(&mut self, duration: f64) -> Result<(), CliError> {
        self.affordable(duration)?;
        let at = Setpoint::at_rest(self.last().position);
        let ticks = (duration * self.setup.robot.control_rate).ceil() as usize;
        (0..ticks).for_each(|_| self.tick(at));
        Ok(())
    }

    /// One move until its shaped command has ended. The plan's first sample is the present position.
    fn leg(&mut self, plan: &SampledTrajectory) -> Result<(), CliError> {
        let Knot { time, position, .. } = self.last();
        let ticks = plan.samples() + self.train_ticks;
        let duration = ticks as f64 * plan.period();
        self.affordable(duration)?;
        for tick in 1..ticks {
            if let Some(state) = plan.state(0, tick) {
                self.tick(setpoint(state));
            }
        }
        self.legs.push(Leg {
            from: time,
            until: self.last().time,
            start: position,
            target: self.last().position,
        });
        Ok(())
    }
}
