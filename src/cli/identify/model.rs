//! `model.toml` from an identification.

use crate::cli::next;
use quell_shapers::UncertainMode;
use std::fmt::Write;
use std::path::Path;

const TAU: f64 = core::f64::consts::TAU;

/// The text of a model with the first mode; comments list the others.
pub fn text(modes: &[UncertainMode]) -> String {
    let mut text = String::from("# Identified by `quell identify`.\nkind = \"flexible_joint\"\n");
    for (k, known) in modes.iter().enumerate() {
        let hertz = known.mode.hertz();
        let values = [
            (
                "natural_frequency_hz",
                hertz,
                known.natural_frequency_std / TAU,
            ),
            (
                "damping_ratio",
                known.mode.damping_ratio(),
                known.damping_ratio_std,
            ),
        ];
        let mark = match k {
            0 => "",
            _ => "# a further mode: ",
        };
        for (key, value, std) in values {
            let _ = match std.is_finite() && std > 0.0 {
                true => writeln!(
                    text,
                    "{mark}{key} = {{ value = {value:.6}, std = {std:.2e} }}"
                ),
                false => writeln!(text, "{mark}{key} = {value:.6}"),
            };
        }
    }
    text
}

/// The next command: for one mode with the model in this file, for several with all of them.
pub fn next(modes: &[UncertainMode], file: &Path) -> String {
    let modes: Vec<_> = modes.iter().map(|known| known.mode).collect();
    let mut words: Vec<String> = vec!["compare".into()];
    match modes.len() {
        0 | 1 => words.extend(["--model".into(), file.display().to_string()]),
        _ => words.extend(next::modes(&modes)),
    }
    words.extend(["--rate".into(), "1000".into()]);
    next::command(words)
}
