//! `model.toml` from an identification.

use super::alone::{ACCEPTABLE, Alone};
use crate::cli::next;
use crate::identification::Recommended;
use crate::identification::output_only::FoundMode;
use crate::recording::Role;
use quell_shapers::UncertainMode;
use std::fmt::Write;
use std::path::{Path, PathBuf};

const TAU: f64 = core::f64::consts::TAU;
/// Share of a further mode that the recording does not tell, as the catalogue's typical one.
const SHARE: f64 = 0.1;

/// A mode in the file.
struct Line {
    known: UncertainMode,
    /// Its share of what the sensor sees, with what tells it.
    share: (f64, &'static str),
    /// The axis of the sensor along which it is strongest, of several.
    axis: Option<&'static str>,
}

/// The text for the recommended modes of a joint with a known input, with a sentence on what they are.
pub fn of_driven(recording: &str, best: &Recommended, what: Option<&str>) -> String {
    let share = match best.further_share {
        Some(share) => (share, "by the motion"),
        None => (SHARE, "guessed: a decay does not tell it"),
    };
    let line = |known| Line {
        known,
        share,
        axis: None,
    };
    let lines: Vec<Line> = best.modes().map(line).collect();
    let mut text = text(recording, &lines);
    if let Some((head, what)) = text.find('\n').zip(what) {
        text.insert_str(head, &format!("\n# {what}"));
    }
    text
}

/// The text for a recording without a known input: the modes to shape for, and as comments the smaller ones.
pub fn of_alone(one: &Alone) -> String {
    let known = one.shaped_for();
    let power = match one.vibration.role {
        role if role.is_acceleration() => 2,
        Role::LinkVelocity => 1,
        _ => 0,
    };
    // Amplitudes of a position are those of its derivatives over a power of the frequency.
    let found = one.found.modes.iter();
    let amplitudes = found.map(|mode| mode.share / mode.known.mode.natural_frequency().powi(power));
    let amplitudes: Vec<f64> = amplitudes.take(known.len()).collect();
    let sum: f64 = amplitudes.iter().sum();
    let lines = known.into_iter().zip(amplitudes).map(|(known, own)| Line {
        known,
        share: (own / sum, "by the amplitudes, which do not tell its sign"),
        axis: one.axis(known.mode.hertz()),
    });
    let mut text = text(&one.recording, &lines.collect::<Vec<_>>());
    let is_small = |mode: &&FoundMode| mode.share <= ACCEPTABLE;
    for mode in one.found.modes.iter().filter(is_small) {
        let (own, percent) = (mode.known.mode, 100.0 * mode.share);
        let _ = writeln!(
            text,
            "# Not shaped for: {:.6} Hz with a damping ratio of {:.6}, {percent:.1} % of the amplitude.",
            own.hertz(),
            own.damping_ratio()
        );
    }
    text
}

/// The text of a model; each mode after the first is an effect.
fn text(recording: &str, lines: &[Line]) -> String {
    let recording = recording.replace(['\n', '\r'], " ");
    let mut text = format!("# Identified by `quell identify` from {recording}.\n");
    for (k, line) in lines.iter().enumerate() {
        let UncertainMode {
            mode,
            natural_frequency_std,
            damping_ratio_std,
        } = line.known;
        let axis = line.axis.map(|axis| format!("  # strongest along {axis}"));
        let axis = axis.unwrap_or_default();
        let damping = value(mode.damping_ratio(), damping_ratio_std);
        text += &match k {
            0 => format!(
                "kind = \"flexible_joint\"\nnatural_frequency_hz = {}{axis}\ndamping_ratio = {damping}\n",
                value(mode.hertz(), natural_frequency_std / TAU)
            ),
            _ => format!(
                "\n[[effect]]\nname = \"second_mode\"{axis}\n[effect.parameters]\nshare = {:.4}  # {}\n\
                 natural_frequency = {}  # rad/s: {:.4} Hz\ndamping_ratio = {damping}\n",
                line.share.0,
                line.share.1,
                value(mode.natural_frequency(), natural_frequency_std),
                mode.hertz()
            ),
        };
    }
    text
}

/// A number with its standard deviation, where there is one.
fn value(value: f64, std: f64) -> String {
    match std.is_finite() && std > 0.0 {
        true => format!("{{ value = {value:.6}, std = {std:.2e} }}"),
        false => format!("{value:.6}"),
    }
}

/// The names of the models of these recordings: `model.toml` of one, and of several one for each.
pub fn names(recordings: &[PathBuf]) -> Vec<String> {
    let several = |(k, path): (usize, &PathBuf)| {
        let is_manifest = path.extension().is_some_and(|ending| ending == "toml");
        let named = match path.file_stem().filter(|stem| *stem == "recording") {
            Some(_) if is_manifest => path.parent().and_then(Path::file_name),
            _ => path.file_stem(),
        };
        let named = named.unwrap_or_default().to_string_lossy();
        let safe = |letter: char| letter.is_alphanumeric() || "-_".contains(letter);
        let named: String = named.chars().filter(|letter| safe(*letter)).collect();
        format!("model_{}_{named}.toml", k + 1)
    };
    match recordings {
        [_] => vec![super::MODEL.into()],
        all => all.iter().enumerate().map(several).collect(),
    }
}

/// The next command, with the model in this file.
pub fn next(file: &Path) -> String {
    let file = file.display().to_string();
    next::command(["compare", "--model", &file, "--rate", "1000"])
}
