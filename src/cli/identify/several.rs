//! `quell identify` for recordings without a known input: text, JSON and page.

use super::alone::{self, Alone};
use super::printer::{self, Tuned};
use crate::cli::CliError;
use crate::identification::output_only::{Excitation, FoundMode, LeftOut, Reason};
use crate::identification::stop::Stop;
use crate::recording::Recording;
use serde_json::{Value, json};
use std::path::PathBuf;

const TAU: f64 = core::f64::consts::TAU;

/// Identifies each recording.
///
/// # Errors
/// [`CliError::Input`] where one of several has a known input, or one has no mode.
pub fn identified(recordings: &[(PathBuf, Recording)], stop: Stop) -> Result<Vec<Alone>, CliError> {
    let mut all = Vec::new();
    for (path, recording) in recordings {
        if !alone::is_alone(recording) && recordings.len() > 1 {
            let called = match path.as_os_str().is_empty() {
                true => recording.name.clone(),
                false => path.display().to_string(),
            };
            let text = format!("{called}: it has a known input: identify it by itself");
            return Err(CliError::input(text));
        }
        all.push(Alone::of(path, recording, stop)?);
    }
    Ok(all)
}

/// The tables that the verb prints, and the lines for a printer.
pub fn text(all: &[Alone], tuned: &[Tuned]) -> String {
    let mut tables: Vec<String> = all.iter().map(Alone::text).collect();
    tables.extend(tuned.iter().map(printer::table));
    if !tuned.is_empty() {
        let lines = printer::lines(tuned);
        tables.push(lines.trim_end_matches('\n').to_string() + "\n");
    }
    tables.join("\n")
}

/// The JSON document.
pub fn document(all: &[Alone], tuned: &[Tuned]) -> Value {
    let recording = |one: &Alone| {
        let (kind, sweep) = match one.found.excitation {
            Excitation::Decay => ("decay", None),
            Excitation::Sweep { from, to } => ("sweep", Some([from, to])),
            Excitation::Work => ("work", None),
        };
        let advice = one.advice.as_ref().map(|advice| {
            json!({
                "shaper": advice.best.shaper.name(),
                "delay_s": advice.best.delay,
                "residual_vibration_95": advice.best.worst_95,
                "impulses": alone::impulses(advice.best.shaper, &one.shaped_for()),
            })
        });
        json!({
            "name": one.recording,
            "channel": one.vibration.role.name(),
            "rate_hz": one.vibration.rate,
            "excitation": kind,
            "sweep_hz": sweep,
            "stretches_s": one.found.stretches,
            "explained": one.found.explained,
            "modes": one.found.modes.iter().map(mode_document).collect::<Vec<_>>(),
            "left_out": one.found.left_out.iter().map(left_out_document).collect::<Vec<_>>(),
            "recommended": advice,
            "remarks": one.remarks(),
        })
    };
    let axis = |tuned: &Tuned| {
        let setting = |one: &crate::identification::printer::Setting| {
            json!({
                "shaper": one.shaper.name(),
                "frequency_hz": one.mode.hertz(),
                "damping_ratio": one.mode.damping_ratio(),
                "residual_vibration": one.residual,
                "smoothing_mm": one.smoothing,
                "max_accel_mm_s2": one.acceleration,
            })
        };
        json!({
            "axis": tuned.axis,
            "recommended": tuned.settings.get(tuned.best).map(setting),
            "shapers": tuned.settings.iter().map(setting).collect::<Vec<_>>(),
        })
    };
    json!({
        "recordings": all.iter().map(recording).collect::<Vec<_>>(),
        "printer": tuned.iter().map(axis).collect::<Vec<_>>(),
        "lines": (!tuned.is_empty()).then(|| printer::lines(tuned)),
    })
}

fn mode_document(mode: &FoundMode) -> Value {
    json!({
        "frequency_hz": mode.known.mode.hertz(),
        "frequency_std_hz": mode.known.natural_frequency_std / TAU,
        "damping_ratio": mode.known.mode.damping_ratio(),
        "damping_std": mode.known.damping_ratio_std,
        "amplitude_share": mode.share,
        "frequency_shift": mode.frequency_shift,
        "frequency_shift_std": mode.frequency_shift_std,
        "damping_shift": mode.damping_shift,
    })
}

fn left_out_document(one: &LeftOut) -> Value {
    let (reason, order, of) = match one.reason {
        Reason::Distortion { order, of } => ("distortion", Some(order), Some(of)),
        Reason::Beside { of } => ("beside", None, Some(of)),
        Reason::Undamped => ("undamped", None, None),
    };
    json!({
        "frequency_hz": one.hertz,
        "amplitude_share": one.share,
        "reason": reason,
        "order": order,
        "of_hz": of,
    })
}
