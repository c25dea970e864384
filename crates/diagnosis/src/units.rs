//! Units in which a model's forces and positions are told.

use super::point::Point;
use super::problem::Problem;
use quell_model::effects::Units;
use quell_model::{Experiment, Output};
use quell_recording::{Role, Unit};

/// Units of force, position and the drive's input. Where forces are divided by a stiffness they are
/// positions; within a position loop the drive is given a force; where nobody said what force a volt or an ampere
/// makes, forces are volts or amperes.
pub fn units(problem: &Problem, point: &Point) -> Units {
    let experiment = &problem.experiments[0];
    let linear = (problem.kind.linear)(&point.keys, experiment.input);
    let force = force(problem, experiment, linear.motor_gain);
    Units {
        input: match linear.position_loop {
            Some(_) => force.clone(),
            None => experiment.input_unit.clone(),
        },
        position: experiment.position_unit.clone(),
        force,
    }
}

fn force(problem: &Problem, experiment: &Experiment, gain: f64) -> String {
    let position = &experiment.position_unit;
    if problem.kind.normalised {
        return position.clone();
    }
    let mut outputs = experiment.outputs.iter();
    let output = outputs.find(|output| output.role == Role::Force);
    match (experiment.input, output) {
        (Role::Force | Role::Torque, _) => experiment.input_unit.clone(),
        (_, Some(output)) => output.unit.clone(),
        // A gain of 1 is that of nobody's knowledge: no drive makes 1 N of 1 V.
        (Role::MotorVoltage | Role::MotorCurrent, None) if gain == 1.0 => {
            experiment.input_unit.clone()
        }
        _ if Unit::from_name(position).is_some_and(|unit| unit.si == "rad") => "N.m".into(),
        _ => "N".into(),
    }
}

/// Unit of an output's values, in which residuals are; errors may be told in another one.
pub fn of_values(experiment: &Experiment, output: &Output) -> String {
    match output.role {
        Role::LinkPosition | Role::MotorPosition | Role::Deformation => {
            experiment.position_unit.clone()
        }
        Role::MotorVelocity | Role::LinkVelocity => format!("{}/s", experiment.position_unit),
        Role::LinkAcceleration => over_seconds_squared(&experiment.position_unit),
        _ => output.unit.clone(),
    }
}

/// Of an acceleration, of which this is the position.
pub fn over_seconds_squared(unit: &str) -> String {
    format!("{unit}/s^2")
}
