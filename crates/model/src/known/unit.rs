//! Units in which a force and an inertia enter a model's equation.

use crate::{ExperimentError, Model};
use quell_recording::{Channel, Recording, Role};

/// The properties that determine the units of an equation.
pub struct Equation<'a> {
    /// The channel that drives it.
    pub input: Role,
    /// Its unit.
    pub input_unit: &'a str,
    /// The unit of positions.
    pub position_unit: &'a str,
}

impl Equation<'_> {
    /// The unit of the equation's forces, if it is a measured unit.
    pub fn force(&self, model: &Model, recording: &Recording) -> String {
        let given = |name: &str| model.kind.key(name).is_some_and(|key| model.given[key]);
        let says_constant = given("force_gain") || given("torque_constant");
        let measured = recording.channel(Role::Force);
        let measured = measured.or_else(|| recording.channel(Role::Torque));
        match (self.input, measured) {
            _ if model.kind.normalised && model.kind.key("gain").is_none() => self.mechanical(),
            (Role::Force | Role::Torque, _) => self.input_unit.into(),
            // An oscillator's gain converts its input to a position, in any unit.
            _ if model.kind.normalised => self.input_unit.into(),
            (Role::MotorCurrent | Role::MotorVoltage, _) if !says_constant => {
                self.input_unit.into()
            }
            (_, Some(output)) => output.unit.clone(),
            _ => self.mechanical(),
        }
    }

    /// N.m for a rotary axis, N for a linear one.
    fn mechanical(&self) -> String {
        if self.position_unit == "rad" {
            "N.m".into()
        } else {
            "N".into()
        }
    }

    /// Refuses a known force whose unit is not that of the model's forces.
    pub fn takes_force(
        &self,
        model: &Model,
        recording: &Recording,
        channel: &Channel,
    ) -> Result<(), ExperimentError> {
        if (model.kind.newton)(&model.keys()).is_none() {
            return Err(no_link_inertia(recording, channel));
        }
        let wanted = self.force(model, recording);
        match wanted == channel.unit {
            true => Ok(()),
            false => Err(other(recording, channel, &wanted)),
        }
    }

    /// Refuses a known inertia that is not above 0, or that the equation does not take in this unit.
    pub fn takes_inertia(
        &self,
        model: &Model,
        recording: &Recording,
        channel: &Channel,
    ) -> Result<(), ExperimentError> {
        let linear = (model.kind.linear)(&model.keys(), self.input);
        if linear.link_is_input && linear.held_inertia == 0.0 {
            return Err(ExperimentError::NoInertia {
                recording: recording.name.clone(),
                kind: model.kind.name,
            });
        }
        let least = channel.columns[0].iter().copied().enumerate();
        if let Some((sample, value)) = least.min_by(|a, b| a.1.total_cmp(&b.1))
            && value <= 0.0
        {
            return Err(ExperimentError::InertiaNotPositive {
                recording: recording.name.clone(),
                time: channel.time[sample],
                value,
                unit: channel.unit.clone(),
            });
        }
        if channel.unit == "1" {
            return Ok(());
        }
        if (model.kind.newton)(&model.keys()).is_none() {
            return Err(no_link_inertia(recording, channel));
        }
        let wanted = match self.force(model, recording).as_str() {
            "N.m" => "kg.m^2",
            "N" => "kg",
            _ => "1",
        };
        match wanted == channel.unit {
            true => Ok(()),
            false => Err(other(recording, channel, wanted)),
        }
    }
}

fn no_link_inertia(recording: &Recording, channel: &Channel) -> ExperimentError {
    ExperimentError::NoLinkInertia {
        recording: recording.name.clone(),
        role: channel.role,
    }
}

fn other(recording: &Recording, channel: &Channel, wanted: &str) -> ExperimentError {
    ExperimentError::OtherUnit {
        recording: recording.name.clone(),
        role: channel.role,
        unit: channel.unit.clone(),
        wanted: wanted.into(),
    }
}
