//! From a recording to the aligned series for the identification.

use core::f64::consts::{PI, TAU};

use super::error::IdentificationError;
use super::motor_side;
use super::nominal_model::NominalModel;
use quell_control::estimators::Sample;
use quell_model::unify_gain;
use quell_recording::health::quantum;
use quell_recording::{Recording, Role};
use quell_signal::{
    ArcRegistration, Contradiction, Hangs, JointArc, TipRegistration, recorded_deformation,
};

/// An aligned series, and how it was obtained.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Samples on the deformation sensor's stamps, rad (deformation in the sensor's own unit where
    /// it measures that directly and no lever arm is known).
    pub samples: Vec<Sample>,
    /// Frame and clock of a tip sensor.
    pub registration: Option<ArcRegistration>,
    /// Lever arm, where the model gives one, m.
    pub lever_arm: Option<f64>,
    /// Whether the deformation has a sensor of its own.
    pub scale_is_open: bool,
    /// What tells the motor side's motion: its position, or its velocity or its command where the recording has no
    /// position.
    pub motor_side: Role,
    /// Stretches that are left out, as a sensor hung in them.
    pub hangs: Option<Hangs>,
    /// Range that the rounding of the sensors alone gives the deformation of a rigid joint, in its unit: a step of each
    /// sensor that it is made of. 0 where no steps are seen.
    pub rounding: f64,
}

/// Aligns a recording, which is consumed: a velocity of the motor side is integrated, or its command taken for its
/// position, where it has no position; angles are unwrapped, a tip sensor is registered with the model's
/// lever arm, in the requested way. Where a sensor hangs ([`Hangs`]), the longest stretch without that is used.
///
/// # Errors
/// [`IdentificationError::Signal`].
pub fn prepare(
    mut recording: Recording,
    model: Option<&NominalModel>,
    registration: TipRegistration,
) -> Result<Series, IdentificationError> {
    let hangs = Hangs::of(&recording);
    if let Some(hangs) = &hangs {
        recording = recording.within(hangs.intact(&recording));
    }
    if let Some(mistake) = Contradiction::of(&recording) {
        return Err(IdentificationError::Contradiction(mistake.words));
    }
    let motor_side = motor_side::provide(&mut recording)?;
    for channel in &mut recording.channels {
        let angle = matches!(channel.role, Role::MotorPosition | Role::LinkPosition);
        if angle && channel.unit == "rad" {
            channel.columns.iter_mut().for_each(|column| unwrap(column));
        }
    }
    carries(&recording)?;
    let rounding = rounding(&recording);
    // The remaining gain between raw counts is the static gain of the methods.
    let _ = unify_gain(&mut recording);
    let lever_arm = model.and_then(|model| model.lever_arm);
    let arc = match (lever_arm, model) {
        (Some(lever_arm), Some(model)) => {
            Some(JointArc::from_lever_arm(lever_arm, model.tip_height)?)
        }
        _ => None,
    };
    let belief = model.map(|model| model.mode);
    let deformation = recorded_deformation(&recording, arc.as_ref(), belief, registration)?;
    Ok(Series {
        samples: deformation
            .samples
            .into_iter()
            .map(|s| Sample {
                time: s.time,
                motor_position: s.motor_position,
                deformation: s.deformation,
            })
            .collect(),
        registration: deformation.registration,
        lever_arm,
        scale_is_open: recording.channel(Role::Deformation).is_some(),
        motor_side: motor_side.unwrap_or(Role::MotorPosition),
        hangs,
        rounding,
    })
}

/// Checks that the signals of the used sensors can be a motion.
fn carries(recording: &Recording) -> Result<(), IdentificationError> {
    let roles = [Role::Deformation, Role::LinkPosition, Role::TipPosition];
    let sensor = roles.iter().find_map(|role| recording.channel(*role));
    let Some((motor, sensor)) = recording.channel(Role::MotorPosition).zip(sensor) else {
        return Ok(());
    };
    for channel in [motor, sensor] {
        if let Some(value) = channel.impossible() {
            return Err(IdentificationError::NoMeasurement {
                channel: channel.role,
                value,
                unit: channel.unit.clone(),
            });
        }
    }
    // A single sample cannot vary; too few samples are reported elsewhere.
    if sensor.varies() || sensor.time.len() < 2 {
        return Ok(());
    }
    Err(match motor.varies() {
        false => IdentificationError::Still,
        true => IdentificationError::Dead {
            channel: sensor.role,
            value: sensor.columns[0][0],
            unit: sensor.unit.clone(),
            by: motor.travel(),
        },
    })
}

/// The step of a deformation sensor, or the sum of those of two positions.
fn rounding(recording: &Recording) -> f64 {
    let step = |role| {
        let channel = recording.channel(role)?;
        channel.columns.first().and_then(|column| quantum(column))
    };
    match recording.channel(Role::Deformation) {
        Some(_) => step(Role::Deformation).unwrap_or(0.0),
        None => {
            let both = [Role::MotorPosition, Role::LinkPosition].map(step);
            both.into_iter().flatten().sum()
        }
    }
}

/// Removes whole turns from an angle that jumps by more than half a turn between samples.
fn unwrap(angle: &mut [f64]) {
    let mut turns = 0.0;
    let mut last = angle.first().copied().unwrap_or(0.0);
    for value in angle {
        let step = *value - last;
        last = *value;
        if step.abs() > PI {
            turns -= (step / TAU).round();
        }
        *value += turns * TAU;
    }
}
