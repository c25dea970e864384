//! Recordings and cases that are not part of the project.

#[path = "skipped.rs"]
pub mod skipped;

use skipped::skipped;
use std::path::{Path, PathBuf};

/// A folder or file beside the project, in `../shared` or where the variable says; none, with a word, where it
/// is absent.
///
/// * `variable`: `QUELL_RECORDINGS` or `QUELL_CONCEALED`, the path of `folder`;
/// * `inside`: what is looked for in it.
pub fn shared(variable: &str, folder: &str, inside: &str) -> Option<PathBuf> {
    let beside = || {
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../shared")
            .join(folder)
    };
    let folder = std::env::var_os(variable).map_or_else(beside, PathBuf::from);
    let found = folder.join(inside).canonicalize();
    if found.is_err() {
        skipped(&format!("{} is absent", folder.join(inside).display()));
    }
    found.ok()
}
