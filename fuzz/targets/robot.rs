//! A robot description, and the arm that it describes for one control period.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::plant::{ArmSimulation, Command, Robot, SimulationOptions};
use std::path::Path;

fuzz_target!(|text: &str| {
    // A URDF file is another input.
    if text.contains("urdf") {
        return;
    }
    let robot = match Robot::from_toml(text, Path::new("robot.toml")) {
        Ok(robot) => robot,
        Err(error) => return assert!(error.to_string().starts_with("robot.toml: ")),
    };
    assert!(robot.home().iter().all(|position| position.is_finite()));
    let joint = robot.default_move.joint;
    let _ = robot.arc(&robot.home(), joint);
    let _ = robot.deformation_sensor(&robot.home(), joint);
    let Ok(mut arm) = ArmSimulation::new(&robot, joint, &SimulationOptions::default()) else {
        return;
    };
    // At most as many samples as the fastest sensor has in a tenth of a millisecond.
    let period = (1.0 / robot.control_rate).min(1e-4);
    arm.step(
        Command {
            position: robot.default_move.target,
            velocity: None,
        },
        period,
    );
});
