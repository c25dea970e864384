//! Licences, one nalgebra, no network client.

use super::root;
use std::process::Command;

/// The packages that are built for this machine, by default and with more `features`: name, version, licence.
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
    let packages = packages(&["--features", "full"]);
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
fn the_full_build_holds_no_network_client() {
    let deny = deny();
    let denied: Vec<_> = deny["bans"]["deny"].as_array().unwrap().iter().collect();
    let is_denied = |name: &str| {
        denied
            .iter()
            .any(|entry| entry["name"].as_str() == Some(name))
    };
    let found: Vec<_> = packages(&["--features", "full"])
        .into_iter()
        .filter(|package| is_denied(&package.0))
        .collect();
    assert!(found.is_empty(), "{found:?}");
}
