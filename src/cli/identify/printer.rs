//! A printer's axes: the shaper of each, and the lines to paste into its firmware.

use crate::cli::CliError;
use crate::identification::output_only::FoundMode;
use crate::identification::printer::{Setting, best, settings};
use crate::page::columns;
use std::fmt::Write;

use super::alone::{ACCEPTABLE, Alone};
use super::axis::Printer;

/// A firmware, its names of the shapers, and its line for an axis.
struct Firmware {
    name: &'static str,
    /// Quell's name and the firmware's, for the shapers that the firmware has.
    shapers: &'static [(&'static str, &'static str)],
    line: fn(char, &str, &Setting) -> String,
}

/// Firmwares, as their documentation of today has them.
const FIRMWARES: &[Firmware] = &[
    Firmware {
        name: "Klipper, in printer.cfg",
        shapers: &[
            ("zv", "zv"),
            ("mzv", "mzv"),
            ("zvd", "zvd"),
            ("ei", "ei"),
            ("ei2", "2hump_ei"),
            ("ei3", "3hump_ei"),
        ],
        line: |axis, name, s| {
            let (hertz, ratio) = (s.mode.hertz(), s.mode.damping_ratio());
            format!(
                "shaper_type_{axis}: {name}\nshaper_freq_{axis}: {hertz:.1}\ndamping_ratio_{axis}: {ratio:.3}"
            )
        },
    },
    Firmware {
        name: "Marlin, which has ZV",
        shapers: &[("zv", "")],
        line: |axis, _, s| {
            let (hertz, ratio) = (s.mode.hertz(), s.mode.damping_ratio());
            format!("M593 {} F{hertz:.1} D{ratio:.3}", axis.to_ascii_uppercase())
        },
    },
    Firmware {
        name: "RepRapFirmware, which has one shaper for all axes",
        shapers: &[
            ("mzv", "mzv"),
            ("zvd", "zvd"),
            ("ei2", "ei2"),
            ("ei3", "ei3"),
        ],
        line: |_, name, s| {
            let (hertz, ratio) = (s.mode.hertz(), s.mode.damping_ratio());
            format!("M593 P\"{name}\" F{hertz:.1} S{ratio:.3}")
        },
    },
];

/// The recommendation for one axis, from all its recordings.
pub struct Tuned {
    /// The axis.
    pub axis: char,
    /// The best frequency of each type.
    pub settings: Vec<Setting>,
    /// Which of them is recommended.
    pub best: usize,
}

/// The settings of each recorded axis of a printer.
///
/// # Errors
/// [`CliError::Input`] where no shaper can be designed.
pub fn tune(all: &[Alone]) -> Result<Vec<Tuned>, CliError> {
    let mut axes: Vec<char> = all
        .iter()
        .filter_map(|one| Some(one.printer?.axis))
        .collect();
    axes.sort_unstable();
    axes.dedup();
    let of = |axis: char| {
        let own = all
            .iter()
            .filter(|one| one.printer == Some(Printer { axis }));
        let recordings: Vec<Vec<FoundMode>> = own.map(|one| one.found.modes.clone()).collect();
        let settings = settings(&recordings).map_err(CliError::input)?;
        let name = best(settings.iter(), ACCEPTABLE).map(|one| one.shaper.name());
        let best = settings
            .iter()
            .position(|one| Some(one.shaper.name()) == name)
            .unwrap_or(0);
        Ok(Tuned {
            axis,
            settings,
            best,
        })
    };
    axes.into_iter().map(of).collect()
}

/// The table of an axis.
pub fn table(tuned: &Tuned) -> String {
    let rows = tuned.settings.iter().enumerate().map(|(k, one)| {
        [
            one.shaper.name().to_string(),
            format!("{:.1}", one.mode.hertz()),
            format!("{:.1} %", 100.0 * one.residual),
            format!("{:.3}", one.smoothing),
            format!("{:.0}", 100.0 * (one.acceleration / 100.0).round()),
            if k == tuned.best {
                "recommended".into()
            } else {
                String::new()
            },
        ]
    });
    let heads = ["shaper", "f_hz", "left", "smoothing_mm", "max_accel", ""];
    format!("Axis {}:\n\n{}", tuned.axis, columns(heads, rows))
}

/// The lines to paste, of every firmware.
pub fn lines(all: &[Tuned]) -> String {
    let mut text = String::new();
    for firmware in FIRMWARES {
        let _ = writeln!(text, "{}:", firmware.name);
        if firmware.name.starts_with("Klipper") {
            text += "    [input_shaper]\n";
        }
        for tuned in all {
            let has = |setting: &&Setting| {
                firmware
                    .shapers
                    .iter()
                    .any(|own| own.0 == setting.shaper.name())
            };
            let own = tuned.settings.iter().filter(has);
            let Some(setting) = best(own, ACCEPTABLE) else {
                continue;
            };
            let name = firmware
                .shapers
                .iter()
                .find(|own| own.0 == setting.shaper.name());
            let line = (firmware.line)(tuned.axis, name.map_or("", |own| own.1), setting);
            let left = format!(
                "  ; axis {}, leaves {:.1} %",
                tuned.axis,
                100.0 * setting.residual
            );
            let comment = if firmware.name.starts_with("Klipper") {
                ""
            } else {
                left.as_str()
            };
            for line in line.lines() {
                let _ = writeln!(text, "    {line}{comment}");
            }
        }
        text.push('\n');
    }
    text
}
