//! README and book: the reference is what the code says, every block runs or is read, every link leads somewhere.
//!
//! `QUELL_UPDATE=1 cargo test --release --features full --test book` writes the reference, and the outputs that stand
//! behind commands, anew.

#[path = "../absent/python.rs"]
mod python;
#[path = "../absent/skipped.rs"]
mod skipped;

mod atlas;
mod blocks;
mod commands;
mod evidence;
mod links;
mod lists;
mod markdown;
mod output;
mod reference;
mod service;
mod udp;

use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Whether what is made from the code is to be written.
fn updates() -> bool {
    std::env::var_os("QUELL_UPDATE").is_some()
}

/// Writes a file that is made from the code where it is to be written, or notes that it is another.
fn keep(file: &Path, made: &str, stale: &mut Vec<String>) {
    let made = format!("{}\n", made.trim_end());
    if std::fs::read_to_string(file).unwrap_or_default() == made {
        return;
    }
    match updates() {
        true => {
            std::fs::create_dir_all(file.parent().unwrap()).unwrap();
            std::fs::write(file, made).unwrap();
        }
        false => stale.push(called(file)),
    }
}

/// Fails where files are not what the code makes.
fn tell_stale(stale: &[String]) {
    assert!(
        stale.is_empty(),
        "stale: {stale:?}; QUELL_UPDATE=1 cargo test --release --features full --test book"
    );
}

/// Markdown files below a folder, in order.
fn markdown_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(markdown_below(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
    files.sort();
    files
}

/// The pages that people read first: README and book.
fn pages() -> Vec<PathBuf> {
    let mut pages = vec![root().join("README.md")];
    pages.extend(markdown_below(&root().join("docs/src")));
    pages
}

/// A file as it is called in messages.
fn called(file: &Path) -> String {
    file.strip_prefix(root())
        .unwrap_or(file)
        .display()
        .to_string()
}
