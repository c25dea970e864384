//! Every relative link of a document leads to a file and a heading that exist.

use super::markdown::{Page, read};
use super::{called, markdown_below, root};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Folders with documents of their own; `target` and the like are not looked at.
const FOLDERS: [&str; 11] = [
    "assets",
    "benches",
    "crates",
    "docs",
    "examples",
    "fuzz",
    "packaging",
    "shapers",
    "src",
    "tests",
    "trajectories",
];

fn documents() -> Vec<PathBuf> {
    let top = std::fs::read_dir(root()).unwrap();
    let top = top.map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = top
        .filter(|path| path.extension().is_some_and(|extension| extension == "md"))
        .collect();
    files.extend(
        FOLDERS
            .iter()
            .flat_map(|folder| markdown_below(&root().join(folder))),
    );
    files
}

fn page(file: &Path) -> Page {
    read(&std::fs::read_to_string(file).unwrap())
}

fn is_elsewhere(to: &str) -> bool {
    to.contains("://") || to.starts_with("mailto:")
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut wrong = Vec::new();
    for file in documents() {
        for link in page(&file).links {
            if is_elsewhere(&link.to) {
                continue;
            }
            let (path, anchor) = link.to.split_once('#').unwrap_or((&link.to, ""));
            let target = match path.is_empty() {
                true => file.clone(),
                false => file.parent().unwrap().join(path),
            };
            let held = || page(&target).anchors.iter().any(|held| held == anchor);
            if !target.exists() || !(anchor.is_empty() || held()) {
                wrong.push(format!("{}:{}: {}", called(&file), link.line, link.to));
            }
        }
    }
    assert!(wrong.is_empty(), "links to nothing:\n{}", wrong.join("\n"));
}

/// What is built has the files of the book alone.
#[test]
fn no_link_leaves_the_book() {
    let book = root().join("docs/src").canonicalize().unwrap();
    let mut wrong = Vec::new();
    for file in markdown_below(&book) {
        for link in page(&file)
            .links
            .iter()
            .filter(|link| !is_elsewhere(&link.to))
        {
            let path = link.to.split('#').next().unwrap_or_default();
            let target = file.parent().unwrap().join(path).canonicalize();
            if target.is_ok_and(|target| !target.starts_with(&book)) {
                wrong.push(format!("{}:{}: {}", called(&file), link.line, link.to));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "links out of the book:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn every_page_of_the_book_is_in_its_summary_once() {
    let book = root().join("docs/src");
    let summary = book.join("SUMMARY.md");
    let named: Vec<PathBuf> = page(&summary)
        .links
        .iter()
        .map(|link| book.join(&link.to))
        .collect();
    let listed: BTreeSet<&PathBuf> = named.iter().collect();
    assert_eq!(listed.len(), named.len(), "a page is named twice");
    let pages = markdown_below(&book);
    let pages: BTreeSet<&PathBuf> = pages.iter().filter(|page| **page != summary).collect();
    assert_eq!(pages, listed);
}

/// Comments, help and messages name pages of the book.
#[test]
fn every_page_that_a_source_names_exists() {
    let mut wrong = Vec::new();
    let mut folders: Vec<PathBuf> = FOLDERS.iter().map(|folder| root().join(folder)).collect();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            // What is no text names nothing.
            let Ok(text) = std::fs::read_to_string(&path) else {
                continue;
            };
            for name in named(&text) {
                if !root().join(name).exists() {
                    wrong.push(format!("{}: {name}", called(&path)));
                }
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "pages that are not there:\n{}",
        wrong.join("\n")
    );
}

/// Names such as `docs/src/index.md`, from the root.
fn named(text: &str) -> impl Iterator<Item = &str> {
    let begins = text.match_indices("docs/src/").map(|(index, _)| index);
    begins.filter_map(|index| {
        let rest = &text[index..];
        let end = rest.find(|letter: char| !(letter.is_alphanumeric() || "/-_.".contains(letter)));
        let name = &rest[..end.unwrap_or(rest.len())];
        let end = name.rfind(".md").map(|end| end + 3);
        end.map(|end| &name[..end])
    })
}
