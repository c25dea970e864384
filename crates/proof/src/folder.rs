//! Folders of cases: `case-00/model.toml`, `train/`, `test/`, and one `truth.json` beside them.

use super::generator::Case;
use super::truth::Truth;
use quell_recording::{Recording, RecordingError};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// File with what was hidden.
const TRUTH: &str = "truth.json";

/// Why a folder of cases cannot be written or read.
#[derive(Debug, Error)]
pub enum FolderError {
    /// The system refuses a file.
    #[error("{}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A recording is refused.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The truth is not JSON, or does not say what was hidden.
    #[error("{}: {reason}", path.display())]
    Truth {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
    /// There is no case.
    #[error("{}: no folder in it has a model.toml and a train/recording.toml", path.display())]
    Empty {
        /// The folder.
        path: PathBuf,
    },
}

/// A case on disk: the inputs of a diagnosis, and the recording for its score.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SealedCase {
    /// Name of its folder.
    pub name: String,
    /// The nominal model.
    pub model: PathBuf,
    /// The recording to be diagnosed.
    pub train: PathBuf,
    /// Other moves of the same machine.
    pub test: PathBuf,
}

impl SealedCase {
    /// The case in a folder.
    pub fn in_folder(folder: &Path) -> Option<Self> {
        let case = Self {
            name: folder.file_name()?.to_str()?.into(),
            model: folder.join("model.toml"),
            train: folder.join("train"),
            test: folder.join("test"),
        };
        let whole = case.model.is_file() && case.train.join("recording.toml").is_file();
        whole.then_some(case)
    }
}

/// Writes one case as the folder `case-<number>` in `folder`, without its truth.
///
/// # Errors
/// [`FolderError`] where a file cannot be written.
pub fn write_case(folder: &Path, number: usize, case: &Case) -> Result<SealedCase, FolderError> {
    let sealed = write_model(folder, number, case)?;
    let named = |recording: &Recording, part: &str| Recording {
        name: format!("{}/{part}", sealed.name),
        ..recording.clone()
    };
    named(&case.train, "train").write(&sealed.train, true)?;
    named(&case.test, "test").write(&sealed.test, true)?;
    Ok(sealed)
}

/// Writes only the nominal model of a case.
///
/// # Errors
/// [`FolderError`] where it cannot be written.
pub(super) fn write_model(
    folder: &Path,
    number: usize,
    case: &Case,
) -> Result<SealedCase, FolderError> {
    let name = format!("case-{number:02}");
    let inside = folder.join(&name);
    let sealed = SealedCase {
        model: inside.join("model.toml"),
        train: inside.join("train"),
        test: inside.join("test"),
        name,
    };
    write(&sealed.model, &case.model)?;
    Ok(sealed)
}

/// Writes the truth of all cases, by the names of their folders.
///
/// # Errors
/// [`FolderError`] where the file cannot be written.
pub fn write_truths<'a>(
    folder: &Path,
    truths: impl IntoIterator<Item = (&'a str, &'a Truth)>,
) -> Result<(), FolderError> {
    let cases = truths
        .into_iter()
        .map(|(name, truth)| (name.to_string(), truth.to_json()));
    let value = Value::Object(cases.collect::<Map<_, _>>());
    write(&folder.join(TRUTH), &format!("{value:#}\n"))
}

/// Writes cases and their truth into a folder, which is made where needed.
///
/// # Errors
/// [`FolderError`] where a file cannot be written.
pub fn write_cases(folder: &Path, cases: &[Case]) -> Result<Vec<SealedCase>, FolderError> {
    let written = cases
        .iter()
        .enumerate()
        .map(|(number, case)| write_case(folder, number, case));
    let sealed = written.collect::<Result<Vec<_>, _>>()?;
    let names = sealed.iter().map(|case| case.name.as_str());
    write_truths(folder, names.zip(cases.iter().map(|case| &case.truth)))?;
    Ok(sealed)
}

/// The cases in a folder in the order of their names. The truth is not read, but it must be there: hours later the score needs it.
///
/// # Errors
/// [`FolderError`] where the folder cannot be read, has no case, or has no truth.
pub fn read_cases(folder: &Path) -> Result<Vec<SealedCase>, FolderError> {
    let entries = std::fs::read_dir(folder).map_err(|source| file(folder, source))?;
    let mut cases = Vec::new();
    for entry in entries {
        let entry = entry.map_err(|source| file(folder, source))?;
        cases.extend(SealedCase::in_folder(&entry.path()));
    }
    cases.sort_by(|a, b| a.name.cmp(&b.name));
    if cases.is_empty() {
        return Err(FolderError::Empty {
            path: folder.into(),
        });
    }
    let truth = folder.join(TRUTH);
    std::fs::metadata(&truth).map_err(|source| file(&truth, source))?;
    Ok(cases)
}

/// Reads the truth of each case of a folder.
///
/// # Errors
/// [`FolderError`] where the truth cannot be read.
pub fn read_truths(folder: &Path) -> Result<BTreeMap<String, Truth>, FolderError> {
    let path = folder.join(TRUTH);
    let text = std::fs::read_to_string(&path).map_err(|source| file(&path, source))?;
    let wrong = |reason: String| FolderError::Truth {
        path: path.clone(),
        reason,
    };
    let cases: Map<String, Value> =
        serde_json::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    let read = |(name, value): (&String, &Value)| {
        let truth = Truth::from_json(value);
        let truth = truth.ok_or_else(|| wrong(format!("{name} does not say its \"effect\"")))?;
        Ok((name.clone(), truth))
    };
    cases.iter().map(read).collect()
}

fn write(path: &Path, text: &str) -> Result<(), FolderError> {
    if let Some(parent) = path.parent() {
        std::fs::create_dir_all(parent).map_err(|source| file(parent, source))?;
    }
    std::fs::write(path, text).map_err(|source| file(path, source))
}

fn file(path: &Path, source: std::io::Error) -> FolderError {
    FolderError::File {
        path: path.into(),
        source,
    }
}
