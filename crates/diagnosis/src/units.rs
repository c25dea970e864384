//! Units of a model's forces and positions in reports.

use super::point::Point;
use super::problem::Problem;
use quell_model::effects::{Parameter, ParameterRole, Units};
use quell_model::{Experiment, Output};
use quell_recording::Role;
use std::f64::consts::TAU;

/// Units of force, position, the drive's input and the reference. Where forces are divided by a stiffness they are
/// positions; within a position loop the drive is given a force.
pub fn units(problem: &Problem, point: &Point) -> Units {
    let experiment = &problem.experiments[0];
    let linear = (problem.kind.linear)(&point.keys, experiment.input);
    let force = match problem.kind.normalised {
        true => &experiment.position_unit,
        false => &experiment.force_unit,
    };
    Units {
        input: match linear.position_loop {
            Some(_) => force.clone(),
            None => experiment.input_unit.clone(),
        },
        position: experiment.position_unit.clone(),
        force: force.clone(),
        reference: experiment.input_unit.clone(),
    }
}

/// Factor and unit of a parameter for people. A mode is told in hertz, as everywhere outside of the equations.
pub fn told_in(parameter: &Parameter, units: &Units) -> (f64, String) {
    match parameter.role {
        ParameterRole::Frequency => (TAU.recip(), "Hz".into()),
        _ => (1.0, parameter.quantity.unit(units)),
    }
}

/// Unit of an output's values and residuals; errors may be reported in another one.
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

/// Unit of an acceleration, from that of the position.
pub fn over_seconds_squared(unit: &str) -> String {
    format!("{unit}/s^2")
}
