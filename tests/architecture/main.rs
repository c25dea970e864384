//! The rules of the house: which crate may see which, no circles of imports, what may be built.

mod crates;
mod licences;
mod modules;
mod sources;

use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut files: Vec<_> = entries
        .flat_map(|entry| {
            let path = entry.unwrap().path();
            if path.is_dir() {
                rust_files(&path)
            } else {
                vec![path]
            }
        })
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .collect();
    files.sort();
    files
}

/// Folders of the sources of all crates.
fn source_folders() -> Vec<PathBuf> {
    let own = [
        "src",
        "python/src",
        "shapers/src",
        "shapers/c/src",
        "trajectories/src",
    ];
    let mut folders: Vec<PathBuf> = own.iter().map(|folder| root().join(folder)).collect();
    let crates = std::fs::read_dir(root().join("crates")).unwrap();
    folders.extend(crates.map(|entry| entry.unwrap().path().join("src")));
    folders
}

fn sources() -> Vec<PathBuf> {
    source_folders()
        .iter()
        .flat_map(|folder| rust_files(folder))
        .collect()
}
