//! `quell identify` of recordings of what vibrates alone: text, JSON and page.

use super::alone::{self, Alone};
use super::alone_page::page;
use super::printer::{self, Tuned};
use super::{Args, REPORT, model};
use crate::cli::CliError;
use crate::cli::out::Out;
use crate::cli::output;
use crate::identification::output_only::{Excitation, FoundMode};
use crate::recording::Recording;
use quell_shapers::UncertainMode;
use serde_json::{Value, json};
use std::path::Path;

const TAU: f64 = core::f64::consts::TAU;
/// Identifies, prints and writes the page.
///
/// # Errors
/// [`CliError::Input`] where one of the recordings has a known input, or no mode.
pub fn run(
    args: &Args,
    (out, file): (Out, &str),
    recordings: &[Recording],
) -> Result<(), CliError> {
    let mut all = Vec::new();
    for (path, recording) in args.recording.iter().zip(recordings) {
        if !alone::is_alone(recording) && recordings.len() > 1 {
            let text = format!(
                "{}: it has a known input: identify it by itself",
                path.display()
            );
            return Err(CliError::input(text));
        }
        all.push(Alone::of(path, recording)?);
    }
    let tuned = printer::tune(&all)?;
    let stage = out.stage()?;
    stage.file(REPORT, page(&all, &tuned).render())?;
    let known: Vec<_> = all[0].found.modes.iter().map(|mode| mode.known).collect();
    stage.file(file, model::text(&known))?;
    stage.put()?;
    let report = args.out.join(REPORT);
    if args.json {
        return output::json(&document(&all, &tuned));
    }
    let mut text: String = all.iter().map(|one| one.text() + "\n").collect();
    for axis in &tuned {
        text += &(printer::table(axis) + "\n");
    }
    if !tuned.is_empty() {
        text += &printer::lines(&tuned);
    }
    output::text(&format!(
        "{text}Report: {}\n{}",
        report.display(),
        next(&all, &args.out.join(file))
    ))
}

/// The next command; of several modes it names them all.
fn next(all: &[Alone], file: &Path) -> String {
    let modes = all.first().map(Alone::shaped_for).unwrap_or_default();
    if modes.len() < 2 {
        return model::next(file);
    }
    let flag = |mode: &UncertainMode| {
        format!(
            " --mode {:.4},{:.5}",
            mode.mode.hertz(),
            mode.mode.damping_ratio()
        )
    };
    let flags: String = modes.iter().map(flag).collect();
    format!("Next: quell compare{flags} --rate 1000\n")
}

fn document(all: &[Alone], tuned: &[Tuned]) -> Value {
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
