//! Walls between crates: what each may see of the others, and of the world.

use super::root;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

/// The parts of the workspace that a crate reaches, at most, with everything that it reaches by others.
const REACHES: &[(&str, &[&str])] = &[
    ("quell-shapers", &[]),
    ("quell-shapers-c", &["shapers"]),
    ("quell-trajectories", &[]),
    ("quell-recording", &[]),
    ("quell-page", &[]),
    ("quell-signal", &["recording", "shapers"]),
    ("quell-model", &["recording", "shapers", "signal"]),
    ("quell-rigid-body", &["recording", "shapers", "signal"]),
    // The controller must not know the truth that it is to learn.
    (
        "quell-control",
        &["recording", "shapers", "signal", "trajectories"],
    ),
    (
        "quell-simulation",
        &["control", "recording", "shapers", "signal", "trajectories"],
    ),
    (
        "quell-identification",
        &[
            "control",
            "model",
            "recording",
            "shapers",
            "signal",
            "trajectories",
        ],
    ),
    (
        "quell-diagnosis",
        &["model", "recording", "shapers", "signal", "trajectories"],
    ),
    (
        "quell-report",
        &[
            "diagnosis",
            "model",
            "page",
            "recording",
            "shapers",
            "signal",
            "trajectories",
        ],
    ),
    // It must not make its recordings with what explains them, nor look into the diagnosis that it judges.
    ("quell-proof", &["page", "recording", "trajectories"]),
];

/// The package for Python, which has the command line in it, and so sees all.
const PACKAGE: &str = "quell-python";

/// Packages that only a program needs.
const PROGRAMS: &[&str] = &["axum", "clap", "hyper", "indicatif", "miette", "tokio"];

/// Names of what each package depends on, tests and builds left out.
fn graph() -> BTreeMap<String, BTreeSet<String>> {
    let output = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version=1",
            "--locked",
            "--all-features",
        ])
        .current_dir(root())
        .output()
        .unwrap();
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let text = |value: &Value| value.as_str().unwrap_or_default().to_string();
    let packages = list(&metadata["packages"]);
    let names: BTreeMap<String, String> = packages
        .iter()
        .map(|package| (text(&package["id"]), text(&package["name"])))
        .collect();
    let normal = |dependency: &Value| {
        let kinds = list(&dependency["dep_kinds"]);
        kinds.iter().any(|kind| kind["kind"].is_null())
    };
    let mut graph: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for node in list(&metadata["resolve"]["nodes"]) {
        let dependencies = list(&node["deps"]);
        let of = dependencies.iter().filter(|dependency| normal(dependency));
        let of = of.map(|dependency| names[&text(&dependency["pkg"])].clone());
        graph
            .entry(names[&text(&node["id"])].clone())
            .or_default()
            .extend(of);
    }
    graph
}

fn reached(graph: &BTreeMap<String, BTreeSet<String>>, from: &str) -> BTreeSet<String> {
    let (mut seen, mut left) = (BTreeSet::new(), vec![from.to_string()]);
    while let Some(next) = left.pop() {
        for other in graph.get(&next).into_iter().flatten() {
            if seen.insert(other.clone()) {
                left.push(other.clone());
            }
        }
    }
    seen
}

#[test]
fn each_crate_sees_only_what_it_may() {
    let graph = graph();
    for (name, allowed) in REACHES {
        let reached = reached(&graph, name);
        for other in reached.iter().filter(|other| other.starts_with("quell")) {
            let short = other.trim_start_matches("quell-");
            assert!(allowed.contains(&short), "{name} must not reach {other}");
        }
        for program in PROGRAMS {
            assert!(
                !reached.contains(*program),
                "{name} must not reach {program}"
            );
        }
    }
    let own = graph.keys().filter(|name| name.starts_with("quell-"));
    let listed = |name: &&String| *name == PACKAGE || REACHES.iter().any(|(own, _)| own == name);
    let missing: Vec<_> = own.filter(|name| !listed(name)).collect();
    assert!(
        missing.is_empty(),
        "without a line in {}: {missing:?}",
        file!()
    );
}

/// Packages with versions and features, of what such a selection of the workspace is made of.
fn made_of(selection: &[&str]) -> BTreeSet<String> {
    let output = Command::new(env!("CARGO"))
        .args(["tree", "--locked", "--prefix", "none", "-f", "{p} {f}"])
        .args(selection)
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success());
    let tree = String::from_utf8_lossy(&output.stdout).into_owned();
    tree.lines()
        .map(|line| line.trim_end_matches(" (*)").to_string())
        .collect()
}

/// Else the test of the package compiles all anew: `python/Cargo.toml` lists what the tests ask for besides.
/// Macros run in the compiler, with features of their own, so they are left out.
#[test]
fn the_package_for_python_is_made_of_what_the_tests_are_made_of() {
    let package = made_of(&["-p", PACKAGE, "-e", "normal,no-proc-macro"]);
    let edges = "normal,dev,no-proc-macro";
    let tests = made_of(&["--workspace", "--features", "full", "-e", edges]);
    let apart: Vec<_> = package.difference(&tests).collect();
    assert!(apart.is_empty(), "{apart:#?}");
}

/// The library of the root is for programs of others: without its features it needs nothing of a program.
#[test]
fn the_library_needs_no_command_line() {
    let output = Command::new(env!("CARGO"))
        .args([
            "tree",
            "--locked",
            "-p",
            "quell",
            "--no-default-features",
            "-e",
            "normal",
        ])
        .args(["--prefix", "none"])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(output.status.success());
    let tree = String::from_utf8_lossy(&output.stdout).into_owned();
    let found: Vec<_> = tree
        .lines()
        .filter_map(|line| line.split(' ').next())
        .filter(|name| PROGRAMS.contains(name))
        .collect();
    assert!(found.is_empty(), "{found:?}");
}
