//! Modes of a recording without a known input: an accelerometer, or any channel of a free vibration.

use super::axis::{self, Printer};
use super::words;
use crate::cli::CliError;
use crate::identification::output_only::{
    Excitation, FoundMode, OutputOnly, Vibration, output_only_until, vibration,
};
use crate::identification::stop::Stop;
use crate::page::{columns, decimals_beside, fixed};
use crate::recording::{Recording, Role};
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
    /// The modes.
    pub found: OutputOnly,
    /// The recommended shaper; `None` if no shaper can be designed for these modes.
    pub advice: Option<Recommendation>,
    /// The axis of a printer, if it is one.
    pub printer: Option<Printer>,
}

/// Whether the recording has no moving input, so that its modes come from the output alone.
pub fn is_alone(recording: &Recording) -> bool {
    let varies = |role: Role| {
        recording
            .channel(role)
            .is_some_and(|channel| channel.varies())
    };
    let told = [Role::Deformation, Role::LinkPosition, Role::TipPosition];
    let sensors = [
        "tip_acceleration",
        "link_acceleration",
        "link_velocity",
        "torque",
    ];
    let others = sensors.iter().filter_map(|name| Role::from_name(name));
    let vibrates = told.into_iter().chain(others).any(varies);
    let driven = varies(Role::MotorPosition)
        && told
            .into_iter()
            .any(|role| recording.channel(role).is_some());
    vibrates && !driven
}

/// Whether `quell identify` can be applied to the recording.
pub fn can(recording: &Recording) -> bool {
    let has = |role: Role| recording.channel(role).is_some();
    let told = [Role::Deformation, Role::LinkPosition, Role::TipPosition];
    is_alone(recording) || (has(Role::MotorPosition) && told.into_iter().any(has))
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
        let vibration = vibration(recording)?;
        let found = output_only_until(&vibration, stop)?;
        let advice = advice(&found.modes)?;
        let printer = axis::of(path, &vibration);
        Ok(Self {
            recording: recording.name.clone(),
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
        if let Some(advice) = &self.advice {
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
        format!(
            "{}, which adds {:.4} s and leaves at most {:.1} % within two standard deviations.",
            best.shaper.name(),
            best.delay,
            100.0 * best.worst_95
        )
    }

    /// The modes that the shaper is for.
    pub fn shaped_for(&self) -> Vec<UncertainMode> {
        shaped_for(&self.found.modes)
    }

    /// Remarks on facts that the table does not show.
    pub fn remarks(&self) -> Vec<String> {
        let found = &self.found;
        let [from, until] = found.stretches[0];
        let more = match found.stretches.len() {
            1 => String::new(),
            n => format!(" and in {} more like it", n - 1),
        };
        let role = self.vibration.role;
        let percent = 100.0 * found.explained;
        let mut remarks = vec![match found.excitation {
            Excitation::Decay => format!(
                "{role} decays freely from {from:.3} s to {until:.3} s{more}; the modes are {percent:.1} % of its variance there."
            ),
            Excitation::Sweep { from, to } => format!(
                "{role} was excited by a sweep from {from:.1} to {to:.1} Hz; the modes explain {percent:.1} % of how its \
                 spectrum varies."
            ),
            Excitation::Work => format!(
                "{role} vibrates throughout, as of a machine at work: the excitation is taken as broad; the modes explain \
                 {percent:.1} % of how its spectrum varies."
            ),
        }];
        if self.vibration.used < 1.0 {
            remarks.push(format!(
                "Only the longest stretch without a hole is used, {:.0} % of the samples.",
                100.0 * self.vibration.used
            ));
        }
        remarks.extend(found.modes.iter().filter_map(dependence));
        let slowest = found.modes.first().map(|mode| mode.known.mode.hertz());
        remarks.extend(slowest.and_then(words::slow));
        remarks
    }
}

/// A sentence on a mode whose frequency depends on the amplitude.
fn dependence(mode: &FoundMode) -> Option<String> {
    let shift = mode.frequency_shift;
    // Two standard deviations: 5 % by chance.
    if shift == 0.0 || shift.abs() < 2.0 * mode.frequency_shift_std {
        return None;
    }
    let hertz = mode.known.mode.hertz();
    let ratio = mode.known.mode.damping_ratio();
    Some(format!(
        "The frequency depends on the amplitude: {:.3} Hz at the start of the decay and {hertz:.3} Hz at its end; the \
         damping ratio goes from {:.4} to {ratio:.4}. It is one mode.",
        hertz * (1.0 + shift),
        ratio + mode.damping_shift,
    ))
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
