//! Answers on disk: a folder for each.
//!
//! `<name>-<first 16 digits of the key>/` has `report.html`, `diagnosis.json` and `model.toml` as `quell diagnose` writes
//! them (the report only where the diagnosis was made here), and `result.json`, which says what they are of, or why they are not there. It is written under a
//! hidden name and moved to its own when it is whole. A folder of that name without `result.json` is not
//! ours, and is left alone.

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::Serialize;
use serde_json::Value;

use super::answer::{About, Answer};
use super::error::BatchError;

const RESULT: &str = "result.json";
const DIAGNOSIS: &str = "diagnosis.json";
const MODEL: &str = "model.toml";
/// The report in a folder of an answer.
pub const REPORT: &str = "report.html";
/// How the name of a folder begins that is not whole.
const UNFINISHED: &str = ".unfinished-";
/// Digits of a key in the name of a folder: among a million jobs two share 64 bits once in 4e7 batches.
const DIGITS: usize = 16;
/// The longest name before the digits, characters: file systems take 255 bytes.
const LONGEST: usize = 100;

/// A folder of answers.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    known: Mutex<HashMap<String, PathBuf>>,
}

impl Folder {
    /// Takes a folder, which is made where needed, with the answers that are in it.
    ///
    /// # Errors
    /// [`BatchError::Disk`] where it cannot be made or read.
    pub fn open(path: &Path) -> Result<Self, BatchError> {
        fs::create_dir_all(path).map_err(BatchError::disk(path))?;
        let mut known = HashMap::new();
        for entry in fs::read_dir(path).map_err(BatchError::disk(path))? {
            let folder = entry.map_err(BatchError::disk(path))?.path();
            let name = folder.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with(UNFINISHED) {
                continue;
            }
            if let Some((_, digits)) = name.rsplit_once('-')
                && folder.join(RESULT).is_file()
            {
                known.insert(digits.to_string(), folder.clone());
            }
        }
        Ok(Self {
            path: path.into(),
            known: Mutex::new(known),
        })
    }

    /// Whether the answer to a job is there.
    pub fn has(&self, key: &str) -> bool {
        self.known().contains_key(digits(key))
    }

    /// Writes an answer, and says whether it is the first to its job.
    ///
    /// # Errors
    /// [`BatchError::Disk`] where it cannot be written, [`BatchError::InTheWay`] where something else has
    /// its name.
    pub fn store(&self, answer: &Answer) -> Result<bool, BatchError> {
        let about = &answer.about;
        if self.has(&about.key) {
            return Ok(false);
        }
        let folder = self.path.join(folder_of(about));
        let (key, process) = (digits(&about.key), std::process::id());
        let unfinished = self.path.join(format!("{UNFINISHED}{key}-{process}"));
        fs::create_dir_all(&unfinished).map_err(BatchError::disk(&unfinished))?;
        if let Some(diagnosis) = &answer.diagnosis {
            write(&unfinished.join(DIAGNOSIS), json(diagnosis).as_bytes())?;
        }
        if let Some(report) = &answer.report {
            write(&unfinished.join(REPORT), report.as_bytes())?;
        }
        if let Some(model) = &answer.model {
            write(&unfinished.join(MODEL), model.as_bytes())?;
        }
        write(&unfinished.join(RESULT), json(about).as_bytes())?;
        // A folder that holds anything is not replaced by the system.
        let moved = fs::rename(&unfinished, &folder);
        let is_first = moved.is_ok();
        if let Err(error) = moved {
            fs::remove_dir_all(&unfinished).map_err(BatchError::disk(&unfinished))?;
            // Another process may have had the same job, and was quicker.
            if !folder.join(RESULT).is_file() {
                return Err(BatchError::InTheWay {
                    path: folder,
                    source: error,
                });
            }
        }
        self.known().insert(key.into(), folder);
        Ok(is_first)
    }

    /// The answer to a job, if it is there.
    ///
    /// # Errors
    /// [`BatchError::Disk`] where it cannot be read.
    pub fn answer(&self, key: &str) -> Result<Option<Answer>, BatchError> {
        let folder = self.known().get(digits(key)).cloned();
        folder.map(|folder| read(&folder)).transpose()
    }

    /// The folder of the answer to a job, if it is there.
    pub fn of(&self, key: &str) -> Option<PathBuf> {
        self.known().get(digits(key)).cloned()
    }

    /// Every folder with an answer, in the order of their names.
    pub fn folders(&self) -> Vec<PathBuf> {
        let mut folders: Vec<_> = self.known().values().cloned().collect();
        folders.sort();
        folders
    }

    /// No holder can leave the map half changed.
    fn known(&self) -> MutexGuard<'_, HashMap<String, PathBuf>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The answer in a folder.
///
/// # Errors
/// [`BatchError::Disk`] where it cannot be read.
pub(super) fn read(folder: &Path) -> Result<Answer, BatchError> {
    let parsed = |file: &str| -> Result<Vec<u8>, BatchError> {
        let path = folder.join(file);
        fs::read(&path).map_err(BatchError::disk(&path))
    };
    let refused = |file: &str| BatchError::disk(folder.join(file));
    let about: About =
        serde_json::from_slice(&parsed(RESULT)?).map_err(|error| refused(RESULT)(error.into()))?;
    if about.error.is_some() {
        return Ok(Answer {
            about,
            diagnosis: None,
            model: None,
            report: None,
        });
    }
    let diagnosis: Value = serde_json::from_slice(&parsed(DIAGNOSIS)?)
        .map_err(|error| refused(DIAGNOSIS)(error.into()))?;
    let model = String::from_utf8_lossy(&parsed(MODEL)?).into_owned();
    Ok(Answer {
        about,
        diagnosis: Some(diagnosis),
        model: Some(model),
        report: None,
    })
}

fn digits(key: &str) -> &str {
    key.get(..DIGITS).unwrap_or(key)
}

/// A name that every file system takes, whatever the recording is called.
fn folder_of(about: &About) -> String {
    let fit = |c: char| match c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.') {
        true => c,
        false => '_',
    };
    let name: String = about.name.chars().map(fit).take(LONGEST).collect();
    format!("{}-{}", name.trim_start_matches('.'), digits(&about.key))
}

fn json(value: &impl Serialize) -> String {
    // Texts, numbers and lists of them always have a form in JSON.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), BatchError> {
    fs::write(path, bytes).map_err(BatchError::disk(path))
}
