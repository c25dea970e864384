//! The axis of a printer that a file belongs to.

use crate::identification::output_only::Vibration;
use crate::recording::Role;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// A recording of a printer's axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Printer {
    /// `x`, `y` or `z`.
    pub axis: char,
}

/// The axis of a printer that a file belongs to: Klipper's raw data or RepRapFirmware's, recognised by its
/// lines; `None` for any other file.
pub fn of(path: &Path, vibration: &Vibration) -> Option<Printer> {
    let axes = axes_of_printer(path).filter(|_| vibration.role == Role::TipAcceleration)?;
    let name = path.file_name()?.to_string_lossy().to_lowercase();
    let named = ["x", "y", "z"].into_iter().find(|axis| {
        let parts = name.split(['_', '-', '.']);
        parts.clone().any(|part| part == *axis)
    });
    let energy = |axis: &Vec<f64>| {
        let mean = axis.iter().sum::<f64>() / axis.len() as f64;
        axis.iter().map(|value| (value - mean).powi(2)).sum::<f64>()
    };
    let strongest = || {
        let energies = vibration.axes.iter().map(energy).enumerate();
        let place = energies
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |most| most.0);
        axes.get(place).copied()
    };
    let axis = named
        .and_then(|axis| axis.chars().next())
        .or_else(strongest)?;
    Some(Printer { axis })
}

/// The axes in the first line of Klipper's raw data or of RepRapFirmware's; `None` for any other file.
fn axes_of_printer(path: &Path) -> Option<Vec<char>> {
    let mut line = String::new();
    let read = File::open(path).map(|file| BufReader::new(file).read_line(&mut line));
    let line = line.trim().trim_start_matches('#').to_lowercase();
    let is_one = line == "time,accel_x,accel_y,accel_z"
        || line.starts_with("sample,x")
        || line.starts_with("sample,y");
    let last = |name: &str| name.chars().last();
    let axes = line.split(',').skip(1).filter_map(last).collect();
    (matches!(read, Ok(Ok(_))) && is_one).then_some(axes)
}
