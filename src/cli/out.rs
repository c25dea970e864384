//! The folder of `--out`: a verb replaces only files that it wrote itself.
//!
//! A verb declares at its start which files it will write ([`Out::open`]), and is refused before it works. It
//! writes into its own hidden folder ([`Stage`]); at the end whole files are moved to their places. A list
//! beside them records for each file its verb and its hash: a file that has changed since belongs to the user.

mod ledger;

use super::{CliError, output};
use crate::recording::{MANIFEST, Role};
use ledger::Ledger;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// `--force`, of every verb that writes files.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Force {
    /// Replaces files that this verb did not write, or that were changed since.
    #[arg(long)]
    pub force: bool,
}

/// Channels of a simulated recording.
const SIMULATED: [Role; 3] = [
    Role::CommandPosition,
    Role::MotorPosition,
    Role::TipPosition,
];

/// Files of a simulated recording in a folder within `--out`, "" for `--out` itself.
pub fn recording_files(folder: &str) -> impl Iterator<Item = PathBuf> {
    let channels = SIMULATED.map(|role| format!("{}.csv.gz", role.name()));
    let folder = PathBuf::from(folder);
    std::iter::once(MANIFEST.to_string())
        .chain(channels)
        .map(move |name| folder.join(name))
}

/// A folder that a verb may write into.
#[derive(Debug)]
pub struct Out {
    folder: PathBuf,
    verb: &'static str,
    force: bool,
    /// Files that the verb reads; it never replaces them.
    reads: Vec<PathBuf>,
}

impl Out {
    /// The folder, for files of these names, by a verb that reads these other files. Nothing is created yet.
    ///
    /// # Errors
    /// [`CliError::Input`] where it is no folder, or one of the files must not be replaced.
    pub fn open(
        folder: &Path,
        (verb, Force { force }): (&'static str, Force),
        reads: &[&Path],
        names: impl IntoIterator<Item = impl AsRef<Path>>,
    ) -> Result<Self, CliError> {
        let out = Self {
            folder: match folder.as_os_str().is_empty() {
                true => Path::new(".").into(),
                false => folder.into(),
            },
            verb,
            force,
            reads: reads.iter().filter_map(|path| real(path)).collect(),
        };
        if folder.exists() && !folder.is_dir() {
            let text = format!("--out {}: it is a file, not a folder", folder.display());
            return Err(CliError::input(text));
        }
        let ledger = Ledger::read(folder)?;
        for name in names {
            out.may_write(&ledger, name.as_ref())?;
        }
        Ok(out)
    }

    /// A hidden folder within it for unfinished files, removed when it is dropped.
    ///
    /// # Errors
    /// [`CliError::Input`] where the folder cannot be made.
    pub fn stage(&self) -> Result<Stage<'_>, CliError> {
        output::folder(&self.folder)?;
        let made = tempfile::Builder::new()
            .prefix(".quell-")
            .tempdir_in(&self.folder);
        let refused = |error| {
            CliError::input(format!(
                "cannot write into {}: {error}",
                self.folder.display()
            ))
        };
        Ok(Stage {
            out: self,
            folder: made.map_err(refused)?,
        })
    }

    /// Whether a file is not there, or may be replaced.
    fn may_write(&self, ledger: &Ledger, name: &Path) -> Result<(), CliError> {
        let file = self.folder.join(name);
        let refuse = |why: String| CliError::input(format!("{} {why}", file.display()));
        let found = match fs::symlink_metadata(&file) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(refuse(format!("cannot be written: {error}"))),
            Ok(found) => found,
        };
        if found.is_dir() {
            return Err(refuse("is a folder: a file would be written there".into()));
        }
        if real(&file).is_some_and(|file| self.reads.contains(&file)) {
            let error = refuse("is read, and would be written over".into());
            return Err(error.with_help(self.elsewhere()));
        }
        if self.force {
            return Ok(());
        }
        let bytes = fs::read(&file).map_err(|error| refuse(format!("cannot be read: {error}")))?;
        let Some(stranger) = ledger.stranger(name, self.verb, &bytes) else {
            return Ok(());
        };
        let why = format!("is there already, and {stranger}: it is not written over");
        Err(refuse(why).with_help(format!("{}, or --force to replace it", self.elsewhere())))
    }

    /// What helps where a file cannot be written. `inspect` writes beside what it reads.
    fn elsewhere(&self) -> &'static str {
        match self.verb {
            "inspect" => "rename that file",
            _ => "give another folder, --out DIR",
        }
    }
}

/// Files of a verb before they are moved to their places.
pub struct Stage<'a> {
    out: &'a Out,
    folder: TempDir,
}

impl Stage<'_> {
    /// The folder to write them into, under their final names.
    pub fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Adds a file.
    ///
    /// # Errors
    /// [`CliError::Failure`] that names it.
    pub fn file(&self, name: impl AsRef<Path>, bytes: impl AsRef<[u8]>) -> Result<(), CliError> {
        output::file(&self.path().join(name), bytes)
    }

    /// Moves every file to its place, in the order of their names, and returns where they are.
    ///
    /// # Errors
    /// [`CliError::Input`] where one of them must not be replaced: then none is moved.
    /// [`CliError::Failure`] where the disk refuses.
    pub fn put(self) -> Result<Vec<PathBuf>, CliError> {
        let (out, names) = (self.out, files_below(self.path(), Path::new(""))?);
        let mut ledger = Ledger::read(&out.folder)?;
        for name in &names {
            out.may_write(&ledger, name)?;
        }
        for name in &names {
            let (from, to) = (self.path().join(name), out.folder.join(name));
            if let Some(parent) = to.parent() {
                output::folder(parent)?;
            }
            tracing::info!(file = %to.display(), "writing");
            let bytes = fs::read(&from).map_err(|error| failed(&from, error))?;
            fs::rename(&from, &to).map_err(|error| failed(&to, error))?;
            ledger.wrote(name, out.verb, &bytes);
        }
        ledger.write(self.path(), &out.folder)?;
        Ok(names.iter().map(|name| out.folder.join(name)).collect())
    }
}

/// Names of all files below a folder, relative to it.
fn files_below(folder: &Path, within: &Path) -> Result<Vec<PathBuf>, CliError> {
    let here = folder.join(within);
    let mut names = Vec::new();
    for entry in fs::read_dir(&here).map_err(|error| failed(&here, error))? {
        let entry = entry.map_err(|error| failed(&here, error))?;
        let name = within.join(entry.file_name());
        match entry.path().is_dir() {
            true => names.extend(files_below(folder, &name)?),
            false => names.push(name),
        }
    }
    names.sort();
    Ok(names)
}

/// The canonical path of a file; `None` if it does not exist.
fn real(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}

fn failed(path: &Path, error: std::io::Error) -> CliError {
    CliError::failure(format!("cannot write {}: {error}", path.display()))
}
