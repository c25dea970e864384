//! Units in which a model's forces and positions are told.

use crate::model::{Experiment, Kind};
use crate::recording::{Role, Unit};

/// The unit of force and that of position. Where forces are divided by a stiffness they are positions.
pub fn units(kind: &Kind, experiment: &Experiment) -> (String, String) {
    let position = experiment.position_unit.clone();
    if kind.normalised {
        return (position.clone(), position);
    }
    let output = experiment
        .outputs
        .iter()
        .find(|output| output.role == Role::Force);
    let force = match (experiment.input, output) {
        (Role::Force | Role::Torque, _) => experiment.input_unit.clone(),
        (_, Some(output)) => output.unit.clone(),
        _ if Unit::from_name(&position).is_some_and(|unit| unit.si == "rad") => "N.m".into(),
        _ => "N".into(),
    };
    (force, position)
}
