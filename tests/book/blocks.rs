//! The blocks of README and book: TOML is read by its reader, commands are parsed, what can be run is run.

use super::commands::{commands, fault};
use super::markdown::{Block, read};
use super::{called, output, pages, reference, root, updates};
use quell::model::Model;
use quell::plant::Robot;
use quell::recording::{Problem, Recording};
use quell::service::config::{Config, Overrides};
use std::path::Path;

fn each(mut look: impl FnMut(&Path, &Block) -> Option<String>) {
    let mut wrong = Vec::new();
    for file in pages() {
        let page = read(&std::fs::read_to_string(&file).unwrap());
        for block in &page.blocks {
            if let Some(fault) = look(&file, block) {
                wrong.push(format!("{}:{}: {fault}", called(&file), block.line));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_block_says_what_it_is() {
    const KINDS: [&str; 11] = [
        "c", "json", "python", "rust", "sh", "text", "toml", "ini", "bibtex", "console", "xml",
    ];
    each(|_, block| {
        let first = block.words.first().map_or("nothing", String::as_str);
        (!KINDS.contains(&first)).then(|| format!("a block of {first}"))
    });
}

/// Each block of TOML says in its fence what file it is: `toml,model`.
#[test]
fn every_block_of_toml_is_read() {
    each(|_, block| {
        if !block.is("toml") {
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("block.toml");
        std::fs::write(&file, &block.text).unwrap();
        let outcome = match block.words.get(1).map(String::as_str) {
            Some("manifest") => manifest(&file),
            Some("model") => model(&block.text),
            Some("robot") => told(Robot::from_toml(&block.text, &file)),
            Some("quell") => told(Config::load(Some(&file), &Overrides::default())),
            other => Some(format!("it does not say which file it is, but {other:?}")),
        };
        outcome.or_else(|| told(block.text.parse::<toml::Table>()))
    });
}

fn told<T, E: std::fmt::Display>(outcome: Result<T, E>) -> Option<String> {
    outcome.err().map(|error| error.to_string())
}

/// A manifest is right up to the files that it names, which are the reader's own.
fn manifest(file: &Path) -> Option<String> {
    let error = Recording::from_path(file).err()?;
    let is_absent = matches!(&error.problem, Problem::Key { key: "file", reason } if reason.starts_with("there is no file"));
    (!is_absent).then(|| error.to_string())
}

/// A model, or effects to be added to one.
fn model(text: &str) -> Option<String> {
    const BELIEVED: &str =
        "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.06\n";
    let whole = match text.contains("kind =") {
        true => text.to_string(),
        false => format!("{BELIEVED}{text}"),
    };
    told(Model::from_toml(&whole, "model.toml"))
}

#[test]
fn every_command_could_be_typed() {
    let paths = reference::http::paths();
    each(|_, block| {
        if !block.is("sh") {
            return None;
        }
        commands(&block.text)
            .iter()
            .find_map(|command| fault(command, &paths))
    });
}

#[test]
fn every_block_of_json_is_json() {
    each(|_, block| {
        let text = block.is("json").then_some(&block.text)?;
        let mut lines = text.lines().filter(|line| !line.trim().is_empty());
        match serde_json::from_str::<serde_json::Value>(text) {
            Ok(_) => None,
            // Or a value a line.
            Err(_) => lines.find_map(|line| told(serde_json::from_str::<serde_json::Value>(line))),
        }
    });
}

/// Blocks of C and Python are taken from programs that the tests run; a block with a `main` is a whole one.
#[test]
fn every_line_of_c_and_python_stands_in_a_program_that_is_tested() {
    let source = |file: &str| std::fs::read_to_string(root().join(file)).unwrap();
    let c = source("shapers/c/examples/shape.c");
    let whole = source("shapers/c/examples/step.c");
    let python = source("examples/udp_robot.py");
    each(|file, block| {
        // python/tests run what stands there.
        let run_there = [
            "README.md",
            "docs/src/guide/python.md",
            "docs/src/guide/simulators.md",
        ];
        let program = match block.words.first().map(String::as_str) {
            Some("c") if block.text.contains("int main") => {
                let is_whole = block.text.trim() == whole.trim();
                return (!is_whole).then(|| "it is not shapers/c/examples/step.c".into());
            }
            Some("c") => &c,
            Some("python") if !run_there.contains(&called(file).as_str()) => &python,
            _ => return None,
        };
        let held = |line: &&str| program.lines().any(|own| own.trim() == line.trim());
        let strange = block.text.lines().find(|line| !held(line));
        strange.map(|line| format!("{line:?} stands in no program"))
    });
}

/// Blocks of Rust are run as tests of the documentation: `src/lib.rs` names the pages.
#[test]
fn every_page_with_rust_is_tested_as_documentation() {
    let library = std::fs::read_to_string(root().join("src/lib.rs")).unwrap();
    each(|file, block| {
        let name = called(file);
        let named = library.contains(&format!("include_str!(\"../{name}\")"));
        let is_quoted = block.is("effect");
        (block.is("rust") && !is_quoted && !named)
            .then(|| format!("src/lib.rs does not name {name}"))
    });
}

/// A block marked `effect` is a file of the catalogue.
#[test]
fn every_effect_that_is_quoted_is_the_file() {
    let folder = root().join("crates/model/src/effects");
    let files = std::fs::read_dir(folder).unwrap();
    let files = files.map(|file| std::fs::read_to_string(file.unwrap().path()).unwrap());
    let files: Vec<String> = files.collect();
    each(|_, block| {
        let is_file = || files.iter().any(|file| file.trim() == block.text.trim());
        (block.is("effect") && !is_file()).then(|| "it is no file of the catalogue".into())
    });
}

/// Blocks marked `run` are run page by page, each in a folder of its own; a block marked `output` holds what the one
/// before it printed, figures to their last digit.
#[test]
fn what_is_marked_runs_and_prints_what_is_written() {
    let mut wrong = Vec::new();
    for file in pages() {
        let text = std::fs::read_to_string(&file).unwrap();
        let page = read(&text);
        if !page.blocks.iter().any(|block| block.is("run")) {
            continue;
        }
        let (mut printed, mut new) = (String::new(), text.clone());
        let folder = output::folder();
        for block in &page.blocks {
            let at = format!("{}:{}", called(&file), block.line);
            if block.is("run") {
                match output::run(folder.path(), &block.text) {
                    Ok(text) => printed = text,
                    Err(error) => wrong.push(format!("{at}: {error}")),
                }
            } else if block.is("output") {
                new = new.replacen(&block.text, &output::fresh(&block.text, &printed), 1);
                if let Some(line) = output::strange(&block.text, &printed) {
                    wrong.push(format!("{at}: nothing printed {line:?}"));
                }
            }
        }
        if updates() && new != text {
            std::fs::write(&file, new).unwrap();
        }
    }
    assert!(wrong.is_empty() || updates(), "{}", wrong.join("\n"));
}
