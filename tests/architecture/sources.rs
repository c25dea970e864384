//! Rules that every source keeps.

use super::{root, rust_files, sources};
use std::path::Path;

/// The one place where code may be unsafe: pointers of a program in C.
const FOREIGN: &str = "shapers/c";

/// A file without its comments.
fn code(file: &Path) -> String {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines()
        .map(|line| line.split("//").next().unwrap_or(""))
        .collect::<Vec<_>>()
        .join("\n")
}

#[test]
fn waypoints_are_never_handed_over() {
    // Ruckig's community edition sends intermediate positions to a service on the network.
    for file in rust_files(&root().join("trajectories/src")) {
        let code = code(&file);
        for word in [
            "intermediate_positions",
            "ruckig::Trajectory::new(",
            "new_offline(",
            "Ruckig::new(",
        ] {
            assert!(!code.contains(word), "{}: {word}", file.display());
        }
    }
}

#[test]
fn nothing_is_unsafe_or_waved_through() {
    // Put together here, so that this file does not hold what it looks for.
    let words = [
        "unsafe ",
        "#[allow",
        "#![allow",
        "#[ignore",
        "todo!",
        "unimplemented!",
    ];
    let tests = [
        "tests",
        "shapers/tests",
        "shapers/c/tests",
        "trajectories/tests",
    ];
    let tests = tests
        .iter()
        .flat_map(|folder| rust_files(&root().join(folder)));
    for file in sources().into_iter().chain(tests) {
        if file.ends_with("tests/architecture/sources.rs") {
            continue;
        }
        let code = code(&file);
        let foreign = file.starts_with(root().join(FOREIGN));
        for word in words.iter().skip(usize::from(foreign)) {
            assert!(!code.contains(word), "{}: {word}", file.display());
        }
    }
    let folders = super::source_folders();
    for folder in folders
        .iter()
        .filter(|folder| !folder.starts_with(root().join(FOREIGN)))
    {
        let manifest = folder.with_file_name("Cargo.toml");
        let text = std::fs::read_to_string(&manifest).unwrap();
        let table: toml::Table = text.parse().unwrap();
        assert_eq!(
            table["lints"]["workspace"].as_bool(),
            Some(true),
            "{}",
            manifest.display()
        );
        if let Some(workspace) = table.get("workspace") {
            assert_eq!(
                workspace["lints"]["rust"]["unsafe_code"].as_str(),
                Some("forbid")
            );
        }
    }
}

#[test]
fn unsafe_code_gives_its_reasons() {
    let manifest = std::fs::read_to_string(root().join(FOREIGN).join("Cargo.toml")).unwrap();
    let manifest: toml::Table = manifest.parse().unwrap();
    let lints = &manifest["lints"];
    // Each block says why it is sound; the rest is as in the workspace.
    let reasons = &lints["clippy"]["undocumented_unsafe_blocks"];
    assert_eq!(reasons.as_str(), Some("warn"));
    let workspace = std::fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let workspace: toml::Table = workspace.parse().unwrap();
    let shared = &workspace["workspace"]["lints"];
    assert_eq!(lints["clippy"]["all"], shared["clippy"]["all"]);
    assert_eq!(
        lints["rust"]["missing_docs"],
        shared["rust"]["missing_docs"]
    );
}
