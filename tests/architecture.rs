//! The rules of the house: which room may see which, how long a file may be, what may be built.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Floors from the ground up. A room sees only rooms on floors below it.
const FLOORS: &[&[&str]] = &[
    &["recording"],
    &["signal"],
    &["estimators", "effects"],
    &["plant", "adaptation", "model"],
    &["controller", "identification", "diagnosis"],
    &["batch", "closed_loop", "report"],
    &["proof"],
    &["service"],
    &["cli"],
];

/// What is forbidden although it lies below: the controller must not know the truth; the proof must
/// not make its recordings with what explains them, nor look into the diagnosis that it judges;
/// the service works with what is real.
const NEVER: &[(&str, &str)] = &[
    ("controller", "plant"),
    ("proof", "model"),
    ("proof", "effects"),
    ("proof", "diagnosis"),
    ("proof", "signal"),
    ("proof", "plant"),
    ("proof", "estimators"),
    ("proof", "identification"),
    ("service", "proof"),
];

/// Lines that a file may have, unit tests at its end not counted.
const LONGEST_FILE: usize = 400;
/// Files above this are listed, as candidates for two ideas in one file.
const LONG_FILE: usize = 300;

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

/// The one place where code may be unsafe: pointers of a program in C.
const FOREIGN: &str = "shapers/c";

fn sources() -> Vec<PathBuf> {
    ["src", "shapers/src", "shapers/c/src", "trajectories/src"]
        .iter()
        .flat_map(|folder| rust_files(&root().join(folder)))
        .collect()
}

/// A file without its comments.
fn code(file: &Path) -> String {
    let text = std::fs::read_to_string(file).unwrap();
    text.lines()
        .map(|line| line.split("//").next().unwrap_or(""))
        .collect::<Vec<_>>()
        .join("\n")
}

fn floor(room: &str) -> usize {
    let found = FLOORS.iter().position(|floor| floor.contains(&room));
    found.unwrap_or_else(|| {
        panic!(
            "the room src/{room} has no floor: give it one in {}",
            file!()
        )
    })
}

/// The room of a file below `src`: its first folder, or itself (`adaptation.rs`).
fn room(file: &Path) -> Option<String> {
    let inside = file.strip_prefix(root().join("src")).ok()?;
    let room = inside
        .iter()
        .next()?
        .to_str()?
        .trim_end_matches(".rs")
        .to_string();
    (room != "lib" && room != "main").then_some(room)
}

/// Rooms that code names as `crate::room` or in `crate::{room, other::Thing}`.
fn rooms_seen(code: &str) -> Vec<String> {
    let name = |text: &str| -> String {
        text.trim_start()
            .chars()
            .take_while(|c| c.is_alphanumeric() || *c == '_')
            .collect()
    };
    code.split("crate::")
        .skip(1)
        .flat_map(|rest| match rest.trim_start().strip_prefix('{') {
            None => vec![name(rest)],
            Some(group) => entries(group).into_iter().map(name).collect(),
        })
        .filter(|seen| seen.starts_with(|c: char| c.is_ascii_lowercase()))
        .collect()
}

/// The entries of a brace group, whose opening brace is gone, at its own level.
fn entries(group: &str) -> Vec<&str> {
    let (mut depth, mut start, mut entries) = (0, 0, Vec::new());
    for (index, character) in group.char_indices() {
        match character {
            '{' => depth += 1,
            ',' if depth == 0 => {
                entries.push(&group[start..index]);
                start = index + 1;
            }
            '}' if depth == 0 => {
                entries.push(&group[start..index]);
                break;
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    entries
}

#[test]
fn arrows_point_down() {
    let mut wrong = Vec::new();
    for file in sources() {
        let Some(room) = room(&file) else { continue };
        for seen in rooms_seen(&code(&file)) {
            let below = seen == room || floor(&seen) < floor(&room);
            let never = NEVER.contains(&(room.as_str(), seen.as_str()));
            let report =
                seen == "report" && !["report", "proof", "service", "cli"].contains(&room.as_str());
            if !below || never || report {
                wrong.push(format!("{}: {room} must not see {seen}", file.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_group_of_imports_is_read() {
    let code = "use crate::{plant::{Arm, Axis}, signal};\nuse crate::report::Page; crate::Thing";
    assert_eq!(rooms_seen(code), ["plant", "signal", "report"]);
}

#[test]
fn the_ground_floor_stands_alone() {
    for (crate_folder, stranger) in [("shapers", "trajectories"), ("trajectories", "shapers")] {
        let manifest =
            std::fs::read_to_string(root().join(crate_folder).join("Cargo.toml")).unwrap();
        let manifest: toml::Table = manifest.parse().unwrap();
        for list in ["dependencies", "dev-dependencies", "build-dependencies"] {
            let Some(list) = manifest.get(list).and_then(|list| list.as_table()) else {
                continue;
            };
            for name in ["quell".into(), format!("quell-{stranger}")] {
                assert!(
                    !list.contains_key(&name),
                    "{crate_folder} must not depend on {name}"
                );
            }
        }
    }
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
fn files_hold_one_idea() {
    let mut long = BTreeMap::new();
    for file in sources() {
        let text = std::fs::read_to_string(&file).unwrap();
        let lines = text
            .lines()
            .take_while(|line| !line.starts_with("#[cfg(test)]"))
            .count();
        if lines > LONG_FILE {
            long.insert(file.strip_prefix(root()).unwrap().to_path_buf(), lines);
        }
    }
    long.iter()
        .for_each(|(file, lines)| println!("{}: {lines} lines", file.display()));
    long.retain(|_, lines| *lines > LONGEST_FILE);
    assert!(
        long.is_empty(),
        "longer than {LONGEST_FILE} lines, to be split: {long:?}"
    );
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
        if file.ends_with("tests/architecture.rs") {
            continue;
        }
        let code = code(&file);
        let foreign = file.starts_with(root().join(FOREIGN));
        for word in words.iter().skip(usize::from(foreign)) {
            assert!(!code.contains(word), "{}: {word}", file.display());
        }
    }
    for manifest in [
        "Cargo.toml",
        "shapers/Cargo.toml",
        "trajectories/Cargo.toml",
    ] {
        let text = std::fs::read_to_string(root().join(manifest)).unwrap();
        let table: toml::Table = text.parse().unwrap();
        assert_eq!(
            table["lints"]["workspace"].as_bool(),
            Some(true),
            "{manifest}"
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

/// What is built for this machine, by default and with more `features`: name, version, licence.
fn packages(features: &[&str]) -> Vec<(String, String, String)> {
    let version = Command::new("rustc").arg("-vV").output().unwrap();
    let version = String::from_utf8(version.stdout).unwrap();
    let host = version
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .unwrap();
    let arguments = [
        "metadata",
        "--format-version=1",
        "--locked",
        "--filter-platform",
        host,
    ];
    let output = Command::new(env!("CARGO"))
        .args(arguments)
        .args(features)
        .current_dir(root())
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let text = |value: &serde_json::Value| value.as_str().unwrap_or_default().to_string();
    let packages = metadata["packages"].as_array().unwrap().iter();
    packages
        .map(|p| (text(&p["name"]), text(&p["version"]), text(&p["license"])))
        .collect()
}

fn deny() -> toml::Table {
    std::fs::read_to_string(root().join("deny.toml"))
        .unwrap()
        .parse()
        .unwrap()
}

#[test]
fn licences_are_permissive() {
    let deny = deny();
    let allowed = deny["licenses"]["allow"].as_array().unwrap();
    let allowed: Vec<_> = allowed
        .iter()
        .filter_map(|licence| licence.as_str())
        .collect();
    let exceptions = deny["licenses"]["exceptions"].as_array().unwrap();
    let excepted = |name: &str, licence: &str| {
        let of = |entry: &toml::Value| entry["name"].as_str() == Some(name);
        let permitted = |entry: &toml::Value| entry["allow"][0].as_str() == Some(licence);
        exceptions.iter().any(|entry| of(entry) && permitted(entry))
    };
    let refused: Vec<_> = packages(&["--all-features"])
        .into_iter()
        .filter(|(name, _, licence)| !permits(licence, &allowed) && !excepted(name, licence))
        .map(|(name, version, licence)| format!("{name} {version}: {licence:?}"))
        .collect();
    assert!(refused.is_empty(), "{refused:#?}");
}

/// Whether an SPDX expression is fulfilled: AND binds more tightly than OR, `/` is an old OR.
fn permits(expression: &str, allowed: &[&str]) -> bool {
    let expression = expression.trim();
    let splits = |text: &str, operator: &str| -> Option<(String, String)> {
        let mut depth = 0;
        for (index, character) in text.char_indices() {
            depth += i32::from(character == '(') - i32::from(character == ')');
            if depth == 0 && text[index..].starts_with(operator) {
                return Some((text[..index].into(), text[index + operator.len()..].into()));
            }
        }
        None
    };
    for operator in [" OR ", "/"] {
        if let Some((left, right)) = splits(expression, operator) {
            return permits(&left, allowed) || permits(&right, allowed);
        }
    }
    if let Some((left, right)) = splits(expression, " AND ") {
        return permits(&left, allowed) && permits(&right, allowed);
    }
    match expression
        .strip_prefix('(')
        .and_then(|inner| inner.strip_suffix(')'))
    {
        Some(inner) => permits(inner, allowed),
        None => allowed.contains(&expression),
    }
}

#[test]
fn licence_expressions_are_understood() {
    let allowed = ["MIT", "Unicode-3.0", "Apache-2.0 WITH LLVM-exception"];
    let good = [
        "MIT/GPL-3.0",
        "(GPL-3.0 OR MIT) AND Unicode-3.0",
        "Apache-2.0 WITH LLVM-exception",
    ];
    let bad = [
        "",
        "GPL-3.0",
        "MIT AND GPL-3.0",
        "(MIT AND GPL-3.0) OR AGPL-3.0",
    ];
    assert!(good.iter().all(|expression| permits(expression, &allowed)));
    assert!(bad.iter().all(|expression| !permits(expression, &allowed)));
}

#[test]
fn there_is_one_nalgebra() {
    let packages = packages(&[]);
    let versions: Vec<_> = packages
        .iter()
        .filter(|p| p.0 == "nalgebra")
        .map(|p| &p.1)
        .collect();
    assert_eq!(versions.len(), 1, "{versions:?}");
    // The lockfile holds what optional features would bring, too.
    let lock = std::fs::read_to_string(root().join("Cargo.lock")).unwrap();
    assert_eq!(lock.matches("name = \"nalgebra\"\n").count(), 1);
}

#[test]
fn the_default_build_holds_no_network_client() {
    let deny = deny();
    let denied: Vec<_> = deny["bans"]["deny"].as_array().unwrap().iter().collect();
    let is_denied = |name: &str| {
        denied
            .iter()
            .any(|entry| entry["name"].as_str() == Some(name))
    };
    let found: Vec<_> = packages(&[])
        .into_iter()
        .filter(|package| is_denied(&package.0))
        .collect();
    assert!(found.is_empty(), "{found:?}");
}
