//! `quell inspect FILE.csv`: the manifest that is proposed for CSV files.

use crate::cli::CliError;
use crate::cli::out::{Force, Out};
use crate::recording::{MANIFEST, Proposal, Proposed, propose};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Manifests that were written, and what is not certain of them.
pub struct Written {
    /// The manifests.
    pub manifests: Vec<(PathBuf, Proposed)>,
    /// What is not certain, and matters.
    pub open: Vec<String>,
}

/// Proposes manifests for a CSV file or the CSV files of a folder, and writes them beside these.
///
/// # Errors
/// [`CliError::Input`] where a file is not understood, or a manifest would replace a user's.
pub fn write(path: &Path, force: Force) -> Result<Written, CliError> {
    let Proposal { manifests, open } = propose(path)?;
    let folder = match path.is_dir() {
        true => path,
        false => path.parent().unwrap_or(Path::new("")),
    };
    let manifests: Vec<Proposed> = manifests
        .into_iter()
        .map(|one| beside(folder, path, one))
        .collect();
    let names = manifests.iter().map(|one| one.name.as_str());
    let out = Out::open(folder, ("inspect", force), &[path], names)?;
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

/// The manifest under a name of its own, where the folder's `recording.toml` is of another file.
fn beside(folder: &Path, path: &Path, mut one: Proposed) -> Proposed {
    let held = std::fs::read_to_string(folder.join(MANIFEST)).unwrap_or_default();
    let file = path.file_name().unwrap_or_default().to_string_lossy();
    let is_other = !held.is_empty() && !held.contains(&format!("file = \"{file}\""));
    if one.name == MANIFEST && path.is_file() && is_other {
        let stem = file.split('.').next().unwrap_or_default();
        one.name = format!("{stem}.toml");
    }
    one
}

impl Written {
    /// The first manifest with what is written in it, the names of the others, and what to do next.
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

    /// For `--json`.
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
