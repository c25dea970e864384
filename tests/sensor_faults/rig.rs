//! Arms and the service's tick in a loop, without its clock: as much time goes by as is asked for.

use quell::closed_loop::ClosedLoopError;
use quell::estimators::EstimatorEntry;
use quell::plant::{Damping, Robot};
use quell_shapers::{Mode, Shaper};
use quell_trajectories::Planner;

use super::fault::{Fault, Sensor};
use super::joint::Joint;

/// A joint and what is believed of it.
#[derive(Clone)]
pub struct JointCase {
    pub truth: Mode,
    pub damping: Damping,
    pub belief: Mode,
    pub shaper: &'static dyn Shaper,
    pub estimator: &'static EstimatorEntry,
    pub sensor: Sensor,
    /// Targets, rad.
    pub targets: Vec<f64>,
    /// How long the arm is watched after each, s.
    pub rest: f64,
    pub seed: u64,
}

/// The outcome of one move of one joint.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Peak deformation after the motor side has followed, m.
    pub residual: f64,
    /// When it ended, s.
    pub end: f64,
    /// Distance of the last command from the target, rad.
    pub missed: f64,
}

/// The outcome for one joint.
pub struct Ran {
    pub moves: Vec<Moved>,
    /// Largest peak of the command over its limit.
    pub peak: f64,
    /// Samples refused, and whether the adaptation waited or a sensor was silent at any tick.
    pub refused: u64,
    pub frozen: bool,
    pub silent: bool,
    /// The mode that is shaped for at the end, and whether it was ever changed.
    pub mode: Mode,
    pub retunes: u32,
}

/// Runs joints side by side, their sensors failing as `fault` says; unshaped and blind where not
/// `shaped`.
pub fn run(
    robot: &Robot,
    cases: &[JointCase],
    mut fault: Option<Fault>,
    shaped: bool,
) -> Result<Vec<Ran>, ClosedLoopError> {
    let planner = Planner::new(1)?;
    let joints = cases.iter().enumerate();
    let made = joints.map(|(index, case)| Joint::new(robot, index, case, shaped));
    let mut joints = made.collect::<Result<Vec<_>, _>>()?;
    let period = 1.0 / robot.control_rate;
    let start = joints
        .iter()
        .map(|joint| joint.arm.time())
        .fold(0.0, f64::max);
    joints
        .iter_mut()
        .for_each(|joint| joint.wait_until(start, period));
    let mut measured = Vec::new();
    let mut tick = 0;
    while !joints.iter().all(Joint::is_done) {
        let time = tick as f64 * period;
        for (index, joint) in joints.iter_mut().enumerate() {
            joint.advance(index, time, period, &mut measured);
        }
        if let Some(fault) = &mut fault {
            fault.act(time, &mut measured);
        }
        for mut sample in measured.drain(..) {
            joints[sample.joint].tick.measure(&mut sample);
        }
        for joint in &mut joints {
            joint.command(&planner, tick, time, period)?;
        }
        tick += 1;
    }
    Ok(joints
        .into_iter()
        .map(|joint| joint.finish(tick as f64 * period, period))
        .collect())
}
