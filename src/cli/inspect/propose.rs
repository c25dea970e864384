//! `quell inspect FILE.csv`: proposed manifests for CSV files.

use super::joints::Joints;
use crate::cli::out::{Force, Out};
use crate::cli::{CliError, next, output};
use crate::recording::{MANIFEST, Proposal, Proposed, propose};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The written manifests, and their uncertain entries.
pub struct Written {
    /// The manifests.
    pub manifests: Vec<(PathBuf, Proposed)>,
    /// Uncertain entries that matter.
    pub open: Vec<String>,
}

/// Proposes manifests for a CSV file or the CSV files of a folder, and writes them beside these for a verb, as it edits them.
///
/// # Errors
/// [`CliError::Input`] where a file cannot be interpreted, or a manifest would replace a user's; those of the edit.
pub fn write(
    path: &Path,
    by: (&'static str, Force),
    mut edit: impl FnMut(&str) -> Result<String, CliError>,
) -> Result<Written, CliError> {
    let force = by.1;
    let Proposal {
        manifests,
        mut open,
        ..
    } = propose(path)?;
    let folder = match path.is_dir() {
        true => path,
        false => path.parent().unwrap_or(Path::new("")),
    };
    let open_out = |manifests: &[Proposed]| {
        let names = manifests.iter().map(|one| one.name.as_str());
        Out::open(folder, by, &[path], names)
    };
    let mut manifests: Vec<Proposed> = manifests;
    if is_taken(folder, path) {
        own_name(path, &mut manifests);
    }
    let out = match open_out(&manifests) {
        Ok(out) => out,
        Err(_) if path.is_file() && !force.force => {
            own_name(path, &mut manifests);
            open_out(&manifests)?
        }
        Err(error) => return Err(error),
    };
    for one in &mut manifests {
        let edited = edit(&one.text)?;
        // Somebody has seen what is not certain, and has said what it is.
        if edited != one.text {
            open.clear();
        }
        one.text = edited;
    }
    let stage = out.stage()?;
    for one in &manifests {
        stage.file(&one.name, &one.text)?;
    }
    stage.put()?;
    let placed = |one: Proposed| (folder.join(&one.name), one);
    Ok(Written {
        manifests: manifests.into_iter().map(placed).collect(),
        open,
    })
}

/// Writes the manifests proposed for CSV files for a verb, as it edits them, and tells the content of the first.
///
/// # Errors
/// [`CliError::Input`] where the files are refused, a manifest would replace a user's; those of the edit.
pub fn told(
    path: &Path,
    by: (&'static str, Force),
    as_json: bool,
    edit: impl FnMut(&str) -> Result<String, CliError>,
) -> Result<(), CliError> {
    let written = write(path, by, edit)?;
    let Some((manifest, _)) = written.manifests.first() else {
        return Ok(());
    };
    let read = Joints::read(manifest);
    let words = match &read {
        Ok(joints) => joints.follows(),
        Err(_) => vec!["inspect".into(), manifest.as_os_str().to_owned()],
    };
    let next = match written.open.is_empty() {
        true => next::command(words),
        false => format!(
            "Next: correct {}\n{}",
            manifest.display(),
            next::then(words)
        ),
    };
    let (text, mut all) = match &read {
        Ok(joints) => (joints.text(), joints.document()),
        Err(error) if written.is_empty() => (
            "It cannot be read yet: it has no [[channel]]\n".into(),
            json!({"refused": error.to_string()}),
        ),
        Err(error) => (
            format!("It cannot be read yet: {error}\n"),
            json!({"refused": error.to_string()}),
        ),
    };
    all["proposal"] = written.document();
    match as_json {
        true => output::json(&all),
        false => output::text(&format!("{}\n{text}\n{next}", written.text())),
    }
}

/// Whether the folder's `recording.toml` describes another file.
fn is_taken(folder: &Path, path: &Path) -> bool {
    let held = std::fs::read_to_string(folder.join(MANIFEST)).unwrap_or_default();
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    !held.is_empty() && path.is_file() && !held.contains(&format!("file = \"{file}\""))
}

/// Names the first manifest after its file, so that the folder's `recording.toml` stays.
fn own_name(path: &Path, manifests: &mut [Proposed]) {
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let stem = file.split('.').next().unwrap_or_default();
    if let Some(one) = manifests.first_mut().filter(|one| one.name == MANIFEST) {
        one.name = format!("{stem}.toml");
    }
}

impl Written {
    /// Whether the first manifest has no channel: its columns cannot be named.
    pub fn is_empty(&self) -> bool {
        let first = self.manifests.first();
        first.is_some_and(|(_, first)| !first.text.lines().any(|line| line == "[[channel]]"))
    }

    /// The first manifest with its content, the names of the others, and the uncertain entries.
    pub fn text(&self) -> String {
        let Some((path, first)) = self.manifests.first() else {
            return String::new();
        };
        let mut text = format!("{}:\n\n{}\n", path.display(), indented(&first.text));
        if let [_, others @ ..] = self.manifests.as_slice()
            && !others.is_empty()
        {
            let names: Vec<_> = others
                .iter()
                .map(|(path, _)| path.display().to_string())
                .collect();
            text += &format!("And of the other runs: {}\n\n", names.join(", "));
        }
        for open in &self.open {
            text += &format!("Not certain: {open}.\n");
        }
        text
    }

    /// The JSON for `--json`.
    pub fn document(&self) -> Value {
        let one =
            |(path, proposed): &(PathBuf, Proposed)| json!({"path": path, "text": proposed.text});
        json!({
            "manifests": self.manifests.iter().map(one).collect::<Vec<_>>(),
            "not_certain": self.open,
        })
    }
}

fn indented(text: &str) -> String {
    text.lines()
        .map(|line| format!("    {line}\n").replace("    \n", "\n"))
        .collect()
}
