//! Modes of a recording without a known input: an accelerometer, or any channel of a free vibration.

use super::axis::{self, Printer};
use super::refused::of_recording;
use super::sole;
use crate::cli::CliError;
use crate::identification::output_only::{
    FoundMode, OutputOnly, Vibration, output_only_within, vibration,
};
use crate::identification::stop::Stop;
use crate::identification::{motor_side, rests};
use crate::page::{columns, decimals_beside, fixed};
use crate::recording::health::{at_limit, clipped_axes, clock, mixed_rates};
use crate::recording::{Channel, Recording, Role, axis_names};
use quell_shapers::{
    Criterion, Recommendation, Requirements, Shaper, ShaperError, UncertainMode, design_for_all,
    recommend,
};
use std::path::Path;

const TAU: f64 = core::f64::consts::TAU;
/// Residual vibration that is small enough; a mode with a smaller share needs no shaper.
pub const ACCEPTABLE: f64 = 0.05;

/// The findings in one recording.
pub struct Alone {
    /// Its name.
    pub recording: String,
    /// The vibrating channel.
    pub vibration: Vibration,
    /// What its axes are called.
    pub axes: Vec<&'static str>,
    /// A remark on the stamps of its channel, if they mix rates.
    pub mixed_rates: Option<String>,
    /// Where an axis of an accelerometer is at the limit of its range, in a clause.
    pub clipped: Option<String>,
    /// The modes.
    pub found: OutputOnly,
    /// The recommended shaper; `None` if no shaper can be designed for these modes.
    pub advice: Option<Recommendation>,
    /// The axis of a printer, if it is one.
    pub printer: Option<Printer>,
}

/// Channels of the link from which, with the motor side's motion, a mode is told.
const LINK: [Role; 3] = [Role::Deformation, Role::LinkPosition, Role::TipPosition];
/// Channels that vibrate with the link.
const VIBRATING: [Role; 3] = [
    Role::TipAcceleration,
    Role::LinkAcceleration,
    Role::LinkVelocity,
];
/// Inputs of an axis.
const INPUTS: [Role; 5] = [
    Role::Torque,
    Role::Force,
    Role::MotorCurrent,
    Role::MotorVoltage,
    Role::CommandPosition,
];

fn varies(recording: &Recording, role: Role) -> bool {
    recording.channel(role).is_some_and(Channel::varies)
}

/// Whether something of the link is measured.
fn has_link(recording: &Recording) -> bool {
    let mut roles = LINK.into_iter().chain(VIBRATING);
    roles.any(|role| varies(recording, role))
}

/// Whether the recording has no known input whose response is measured, so that its modes come from the output
/// alone.
pub fn is_alone(recording: &Recording) -> bool {
    let has = |role: Role| recording.channel(role).is_some();
    let moves = motor_side(recording).is_some_and(Channel::varies);
    let driven = moves && LINK.into_iter().any(has);
    let torque = !moves && varies(recording, Role::Torque);
    // Of a link that does not vary it says that, and does not ask for a motor side.
    let only = motor_side(recording).is_none() && LINK.into_iter().chain(VIBRATING).any(has);
    (has_link(recording) || torque || only || sole::role(recording).is_some()) && !driven
}

/// The input of an axis of which nothing beyond the motor side is measured, which this verb can tell nothing of.
fn rigid(recording: &Recording) -> Option<Role> {
    let measured = [Role::MotorPosition, Role::MotorVelocity];
    let moves = measured.into_iter().any(|role| varies(recording, role));
    let is_told = |role: &Role| recording.channel(*role).is_some();
    let bare = moves && !has_link(recording) && !LINK.iter().any(is_told);
    let mut inputs = INPUTS.into_iter().filter(|role| varies(recording, *role));
    inputs.next().filter(|_| bare)
}

/// Refuses a recording of a motor side and its input alone.
///
/// # Errors
/// [`CliError::Input`] with the verb that such a recording is for.
pub fn refuse_rigid(recording: &Recording) -> Result<(), CliError> {
    let refused = |input: Role| {
        CliError::input(format!(
            "{}: {input} is what drives the motor side, and no channel tells how a link vibrates. Record \
             link_position, deformation or tip_acceleration beside it; or compare the axis with a model of it, \
             MODEL.toml with the lines kind = \"rigid_axis\" and mass = a number (kg; kg.m^2 where it turns): \
             quell diagnose --model MODEL.toml",
            recording.name
        ))
    };
    rigid(recording).map_or(Ok(()), |input| Err(refused(input)))
}

/// Whether `quell identify` can be applied to the recording.
pub fn can(recording: &Recording) -> bool {
    let has = |role: Role| recording.channel(role).is_some();
    is_alone(recording) || (motor_side(recording).is_some() && LINK.into_iter().any(has))
}

/// Whether `quell identify` needs a model for the recording: its lever arm makes an angle of what is in metres.
pub fn needs_model(recording: &Recording) -> bool {
    let is_angle = match recording.channel(Role::Deformation) {
        Some(channel) => channel.unit != "m",
        None => recording.channel(Role::LinkPosition).is_some(),
    };
    !is_alone(recording) && !is_angle
}

impl Alone {
    /// Identifies a recording from this file.
    ///
    /// # Errors
    /// [`CliError::Input`] where nothing vibrates, or no mode stands out.
    pub fn of(path: &Path, recording: &Recording, stop: Stop) -> Result<Self, CliError> {
        let named = |error| of_recording(&recording.name, error);
        let vibration = vibration(recording).map_err(named)?;
        let rests = match sole::role(recording) {
            // The decay is of the motor side itself.
            Some(_) => Vec::new(),
            None => rests(recording).map_err(|error| named(error.into()))?,
        };
        let rests: Vec<[f64; 2]> = rests.iter().map(|p| [p.start, p.end]).collect();
        let found = output_only_within(&vibration, &rests, stop).map_err(named)?;
        sole::refuse_driven(recording, &found)?;
        let advice = advice(&found.modes)?;
        let printer = axis::of(path, &vibration);
        let channel = recording.channel(vibration.role);
        Ok(Self {
            recording: recording.name.clone(),
            axes: axis_names(path, vibration.role, vibration.axes.len()),
            clipped: channel.and_then(clipped),
            mixed_rates: channel.and_then(|own| mixed_rates(&clock(&own.time))),
            vibration,
            found,
            advice,
            printer,
        })
    }

    /// The text that the verb prints.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n\n{}\n", self.recording, table(&self.found.modes));
        for remark in self.remarks() {
            text += &format!("- {remark}\n");
        }
        // A printer's firmware takes none but its own shapers, which are judged below for a frequency that changes.
        if let Some(advice) = self.advice.as_ref().filter(|_| self.printer.is_none()) {
            text += &format!(
                "\nRecommended: {}\n\n{}",
                self.recommended(advice),
                train(advice, &self.shaped_for())
            );
        }
        text
    }

    /// The recommended shaper in a sentence.
    pub fn recommended(&self, advice: &Recommendation) -> String {
        let best = &advice.best;
        let left = match 100.0 * best.worst_95 {
            left if left < 0.05 => "less than 0.1 %".into(),
            left => format!("at most {left:.1} %"),
        };
        format!(
            "{}, which adds {:.4} s and leaves {left} within two standard deviations.",
            best.shaper.name(),
            best.delay,
        )
    }

    /// The axis along which a mode is strongest, if there are several.
    pub fn axis(&self, hertz: f64) -> Option<&'static str> {
        let place = self.vibration.strongest_axis(hertz)?;
        self.axes.get(place).copied()
    }

    /// The modes that the shaper is for.
    pub fn shaped_for(&self) -> Vec<UncertainMode> {
        shaped_for(&self.found.modes)
    }
}

/// A clause on the axis of an accelerometer with the most readings at its limit.
fn clipped(channel: &Channel) -> Option<String> {
    let all = clipped_axes(channel).into_iter();
    let most = all.max_by_key(|clipped| clipped.samples.len())?;
    Some(at_limit(&most, &channel.unit))
}

/// Modes with more than the acceptable residual when unshaped, each with the spread that its amplitude causes.
fn shaped_for(modes: &[FoundMode]) -> Vec<UncertainMode> {
    let known = |mode: &FoundMode| {
        let UncertainMode {
            mode: own,
            natural_frequency_std: std,
            damping_ratio_std,
        } = mode.known;
        let shift = 0.5 * mode.frequency_shift;
        let frequency = own.natural_frequency() * (1.0 + shift);
        // The ends of the shift are two standard deviations.
        let spread = 0.5 * (shift * frequency).abs();
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        Some(UncertainMode {
            mode: quell_shapers::Mode::new(frequency, own.damping_ratio()).ok()?,
            natural_frequency_std: finite(std).hypot(spread),
            damping_ratio_std: finite(damping_ratio_std),
        })
    };
    modes
        .iter()
        .filter(|mode| mode.share > ACCEPTABLE)
        .filter_map(known)
        .collect()
}

fn advice(modes: &[FoundMode]) -> Result<Option<Recommendation>, CliError> {
    let wanted = Requirements {
        longest_delay: f64::INFINITY,
        criterion: Criterion::Worst95,
        acceptable: ACCEPTABLE,
        tolerance: 0.0,
        allow_negative: false,
    };
    match recommend(&shaped_for(modes), &wanted) {
        Ok(found) => Ok(Some(found)),
        Err(ShaperError::NoneFits { .. } | ShaperError::Empty) => Ok(None),
        Err(error) => Err(CliError::input(error)),
    }
}

/// The modes with their standard deviations.
pub fn table(modes: &[FoundMode]) -> String {
    let rows = modes.iter().enumerate().map(|(k, mode)| {
        let known = &mode.known;
        let std = known.natural_frequency_std / TAU;
        [
            (k + 1).to_string(),
            fixed(known.mode.hertz(), decimals_beside(std, 3)),
            fixed(std, decimals_beside(std, 3)),
            fixed(
                known.mode.damping_ratio(),
                decimals_beside(known.damping_ratio_std, 4),
            ),
            fixed(
                known.damping_ratio_std,
                decimals_beside(known.damping_ratio_std, 4),
            ),
            format!("{:.1} %", 100.0 * mode.share),
        ]
    });
    columns(["mode", "f_hz", "std", "xi", "std", "amplitude"], rows)
}

/// The impulses of the recommended shaper.
fn train(advice: &Recommendation, modes: &[UncertainMode]) -> String {
    let impulses = impulses(advice.best.shaper, modes);
    let rows = impulses
        .iter()
        .map(|[time, amplitude]| [format!("{time:.6}"), format!("{amplitude:.6}")]);
    columns(["impulse_s", "amplitude"], rows)
}

/// Instants, s, and amplitudes of a shaper for all modes at once.
pub fn impulses(shaper: &dyn Shaper, modes: &[UncertainMode]) -> Vec<[f64; 2]> {
    let Ok(train) = design_for_all(shaper, modes) else {
        return Vec::new();
    };
    train
        .impulses()
        .iter()
        .map(|impulse| [impulse.time, impulse.amplitude])
        .collect()
}
