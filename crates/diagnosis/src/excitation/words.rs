//! Sentences on what was not excited, and what to record.

use crate::figure::figure;
use quell_model::{Experiment, Model};
use quell_recording::{Channel, Role};

/// Ratio of amplitude to noise of a useful motion: a tenth of it is then as large as the noise of one sample.
const WORTH: f64 = 10.0;

/// `motor_position stays at 0 rad and deformation at 0 rad`.
pub fn still<'a>(channels: impl Iterator<Item = &'a Channel>) -> String {
    let at = |channel: &Channel| {
        let values = channel.columns.iter().filter_map(|column| column.first());
        let values: Vec<String> = values.map(|v| figure(*v, &channel.unit)).collect();
        format!("{} stays at {}", channel.role, values.join(", "))
    };
    channels.map(at).collect::<Vec<_>>().join(", ")
}

/// The sentences of the verdict where nothing varies.
pub fn nothing_moved(still: &str, model: &Model) -> String {
    let within = match model.mode() {
        Some((frequency, _)) => format!(" within {:.3} s, a period of the mode,", 1.0 / frequency),
        None => String::new(),
    };
    format!(
        "Nothing moved: {still} throughout, so that nothing can be told of the model. Record a move{within} that \
         the sensors see, and the rest after it."
    )
}

/// What to record: a motion that is well above the noise of this sensor.
pub fn advice(model: &Model, experiment: &Experiment, noise: f64) -> String {
    let (output, unit) = (&experiment.outputs[0], &experiment.position_unit);
    let kinematic = matches!(
        experiment.input,
        Role::MotorPosition | Role::CommandPosition
    );
    let seen = output.role.is_position() || output.role == Role::Deformation;
    match (model.mode(), kinematic && seen) {
        // A move by D within a period has a peak acceleration of at least 2 pi D / T^2, which bends the joint by
        // that over the square of its frequency: D / (2 pi).
        (Some((frequency, _)), true) => format!(
            "Record a move of at least {} within {:.3} s, a period of the mode, and the rest after it.",
            figure(WORTH * std::f64::consts::TAU * noise, unit),
            1.0 / frequency
        ),
        _ => format!(
            "Record a motion in which {} changes by at least {}.",
            output.channel,
            figure(WORTH * noise * output.scale, &output.unit)
        ),
    }
}
