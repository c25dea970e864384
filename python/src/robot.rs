//! A simulated robot that follows a command.

use super::errors;
use super::model::Model;
use super::recording::Recording;
use super::waiting::{Watch, wait};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use quell::cli::robot_args::RobotArgs;
use quell::cli::{CliError, effort::affordable};
use quell::model::{Model as Chain, believed};
use quell::plant::{ArmSimulation, Command, MeasurementLog, SimulationOptions};
use quell::recording;
use std::path::PathBuf;

type Array<'py> = Bound<'py, PyArray1<f64>>;
/// The recording, the model of the joint, its modes, the true deformation at the tip, m.
type Told<'py> = (Recording, Model, Vec<(f64, f64)>, Array<'py>);

/// What a simulation gives.
struct Followed {
    recording: recording::Recording,
    model: Chain,
    modes: Vec<(f64, f64)>,
    tip: Vec<f64>,
}

/// A joint of a robot (the embedded arm where no file is given) follows positions and velocities at a rate, Hz.
///
/// * `load`: payload, kg; noise of the tracker, m; seed of the noise.
#[pyfunction]
pub fn simulate_robot<'py>(
    py: Python<'py>,
    robot: Option<PathBuf>,
    joint: Option<usize>,
    command: (
        PyReadonlyArray1<'py, f64>,
        Option<PyReadonlyArray1<'py, f64>>,
    ),
    rate: f64,
    load: (f64, Option<f64>, u64),
) -> PyResult<Told<'py>> {
    let positions = command.0.as_slice()?.iter();
    let velocities = command.1.as_ref().map(|one| one.as_slice()).transpose()?;
    let command = positions.enumerate().map(|(tick, &position)| Command {
        position,
        velocity: velocities.and_then(|all| all.get(tick).copied()),
    });
    let command: Vec<Command> = command.collect();
    let options = SimulationOptions {
        payload: load.0,
        tracker_noise: load.1,
        seed: load.2,
        ..SimulationOptions::default()
    };
    let joint = RobotArgs { robot, joint };
    let work = move || follow(&joint, options, &command, 1.0 / rate);
    let followed = wait(py, &Watch::default(), None, work)?;
    let followed = followed.map_err(|error| errors::simulation(&error))?;
    let model = Model {
        model: followed.model,
        file: "believed model".into(),
    };
    let tip = followed.tip.into_pyarray(py);
    Ok((Recording(followed.recording), model, followed.modes, tip))
}

/// From rest at the first position.
fn follow(
    joint: &RobotArgs,
    mut options: SimulationOptions,
    command: &[Command],
    period: f64,
) -> Result<Followed, CliError> {
    let (robot, joint) = joint.resolve()?;
    let modes = &robot.joints[joint].modes;
    affordable(command.len() as f64 * period, &robot, modes)?;
    let mut pose = robot.home();
    pose[joint] = command.first().map_or(pose[joint], |first| first.position);
    options.pose = Some(pose);
    let mut arm = ArmSimulation::new(&robot, joint, &options).map_err(CliError::input)?;
    let believed = arm
        .true_mode()
        .map(|mode| believed::flexible_joint(mode, Some(arm.arc())));
    let Some(model) = believed else {
        return Err(CliError::input(format!("joint {} has no mode", joint + 1)));
    };
    let mut log = MeasurementLog::new();
    let mut tip = Vec::with_capacity(command.len());
    for (tick, &command) in command.iter().enumerate() {
        let time = tick as f64 * period;
        log.push_command(time, command.position);
        if tick > 0 {
            let seen = arm.step(command, time - arm.time());
            seen.iter().for_each(|seen| log.push(seen));
        }
        tip.push(arm.true_tip_deformation());
    }
    let numbers = |mode: quell::shapers::Mode| (mode.hertz(), mode.damping_ratio());
    Ok(Followed {
        recording: log.into_recording(&robot.name),
        model: Chain::from_toml(&model, "believed model").map_err(CliError::input)?,
        modes: arm.true_modes().map(numbers).collect(),
        tip,
    })
}
