//! Proposed manifests for CSV files without one: guesses on their columns, from form, names and numbers.

mod alike;
mod cells;
mod clock;
mod column;
mod columns;
mod content;
mod drives;
#[cfg(test)]
mod exports;
mod form;
mod gyroscope;
mod inertial;
mod joint;
mod joint_states;
mod name;
mod pairs;
mod preamble;
mod read;
mod render;
mod response;
mod restarts;
mod robots;
mod roles;
mod siemens;
mod split_stamps;
mod stand_in;
mod theta;
mod titles;
mod toml_text;
mod tool;
mod units;
mod unreadable;
mod usual_unit;
mod words;
mod wraps;

pub(super) use joint::distinct;

use super::error::{Problem, RecordingError};
use super::table::parquet;
use super::{MANIFEST, foreign};
use content::Content;
use std::path::{Path, PathBuf};

/// What stands in a proposed manifest between a guessed value and the reason.
pub const GUESSED: &str = "  # guessed: ";
/// The line of a proposed manifest for a rate that nothing in the file says, without its comment.
pub const NO_RATE: &str = "# rate_hz = ";

/// Endings of files that are read as text with columns.
const ENDINGS: &[&str] = &["csv", "tsv", "txt", "dat", "asc", "log", "lvm", "prn", "gz"];

/// A proposed manifest.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposed {
    /// Its file name.
    pub name: String,
    /// Its text; guessed lines are marked.
    pub text: String,
}

/// Proposal for CSV files.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Proposal {
    /// One manifest for each recording: a file may have several tests, and a folder several runs.
    pub manifests: Vec<Proposed>,
    /// Open questions that matter: a role, a unit of time, a rate. One sentence each, without a full stop.
    pub open: Vec<String>,
    /// Joints, by the numbers in the names of their columns; none where the names tell one joint.
    pub joints: Vec<String>,
    /// What is taken as certain though nothing in the file says it, and changes the samples: a counter of time that begins again.
    /// One sentence each, without a full stop.
    pub taken: Vec<String>,
}

/// A value that may be a guess.
#[derive(Clone, Debug)]
struct Guess<T> {
    value: T,
    /// The reason for a guess; `None` if the value is in the file.
    why: Option<String>,
}

impl<T> Guess<T> {
    fn known(value: T) -> Self {
        Self { value, why: None }
    }

    fn guessed(value: T, why: impl Into<String>) -> Self {
        let why = Some(why.into());
        Self { value, why }
    }
}

/// Whether a file contains columns of text, by its extension; a Parquet file counts, too, if this build reads it.
pub fn is_csv(path: &Path) -> bool {
    if parquet::is_called(path) {
        return true;
    }
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ENDINGS.contains(&ending.to_ascii_lowercase().as_str()))
}

/// Proposes manifests for a CSV file, or for all CSV files of a folder.
///
/// # Errors
/// [`RecordingError`] where a file cannot be read as text, or has no numbers.
///
/// # Example
/// ```
/// let folder = tempfile::tempdir().unwrap();
/// let file = folder.path().join("decay.csv");
/// std::fs::write(&file, "t [ms];accel_x [g]\n0,0;0,11\n0,5;-0,02\n1,0;0,07\n").unwrap();
/// let proposal = quell_recording::propose(&file).unwrap();
/// let text = &proposal.manifests[0].text;
/// assert!(text.contains("decimal = \",\"") && text.contains("time_unit = \"ms\""));
/// assert!(proposal.open.is_empty());
/// ```
pub fn propose(path: &Path) -> Result<Proposal, RecordingError> {
    let files = match path.is_dir() {
        true => csv_files(path)?,
        false => vec![path.to_path_buf()],
    };
    let mut contents = Vec::new();
    for file in &files {
        if let Some(format) = foreign::by_ending(file) {
            return Err(Problem::Foreign(format).in_file(file));
        }
        contents.push(Content::read(file)?);
    }
    if contents.is_empty() {
        return Err(Problem::NoManifest.in_file(path));
    }
    Ok(render::proposal(path, &contents))
}

/// The manifest of an unambiguous CSV file.
pub(super) fn certain(path: &Path) -> Result<String, RecordingError> {
    let mut proposal = match Content::known(path)? {
        Some(content) => render::proposal(path, &[content]),
        None => propose(path)?,
    };
    let several = proposal.manifests.len();
    if several > 1 {
        proposal.open.insert(0, format!("it has {several} tests"));
    }
    if let ([first, _, ..], false) = (&*proposal.joints, proposal.open.is_empty()) {
        let joints = proposal.joints.join(", ");
        proposal.open.push(format!(
            "it has the joints {joints}: take one as {MANIFEST}#{first} once the manifest is there"
        ));
    }
    match proposal.open.is_empty() {
        true => {
            for taken in &proposal.taken {
                tracing::warn!("{}: {taken}", path.display());
            }
            Ok(proposal.manifests.swap_remove(0).text)
        }
        false => {
            let open = proposal.open.join("; ");
            Err(Problem::Uncertain { open }.in_file(path))
        }
    }
}

/// The axes in names of columns, if each has one of its own.
pub(super) fn axes(names: &[String]) -> Option<Vec<&'static str>> {
    let axis = |own: &String| Some(["x", "y", "z"][name::parse(own).axis()?]);
    let axes: Vec<&str> = names.iter().map(axis).collect::<Option<_>>()?;
    let is_one = |k: usize| !axes[..k].contains(&axes[k]);
    (0..axes.len()).all(is_one).then_some(axes)
}

/// CSV files of a folder, by their names.
fn csv_files(folder: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let entries = std::fs::read_dir(folder).map_err(|error| RecordingError::io(folder, &error))?;
    let files = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<PathBuf> = files.filter(|file| is_csv(file)).collect();
    files.sort();
    Ok(files)
}

/// The name of the manifest of one recording of several; of the only one it is [`MANIFEST`].
fn manifest_name(only: bool, stem: &str) -> String {
    let safe = |letter: char| match letter.is_alphanumeric() || "-_.".contains(letter) {
        true => letter,
        false => '_',
    };
    match only {
        true => MANIFEST.into(),
        false => format!("{}.toml", stem.chars().map(safe).collect::<String>()),
    }
}
