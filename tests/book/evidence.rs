//! The tables of the evidence: each is made by one command, or says how it was made.

use super::commands::fault;
use super::skipped::skipped;
use super::{called, markdown_below, root};
use std::collections::BTreeSet;
use std::process::Command;

/// What `benches/evidence.py --list` tells: for each table a line of its name, its page and what it takes, and its commands,
/// indented. None, with a word, where there is no Python.
fn list() -> Option<String> {
    let mut command = Command::new("python3");
    command.args(["benches/evidence.py", "--list"]);
    let Ok(output) = command.current_dir(root()).output() else {
        skipped("the list of benches/evidence.py: there is no python3");
        return None;
    };
    let words = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{words}");
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Names and pages of the tables.
fn made(list: &str) -> BTreeSet<(String, String)> {
    let heads = list.lines().filter(|line| !line.starts_with(' '));
    let names = heads.filter_map(|line| {
        let mut words = line.split_whitespace().map(str::to_owned);
        Some((words.next()?, words.next()?))
    });
    names.collect()
}

/// The marks of a page, each with its first line; and the lines of tables that stand behind none.
fn marks(text: &str) -> (Vec<(usize, &str)>, Vec<usize>) {
    let (mut marks, mut bare, mut open) = (Vec::new(), Vec::new(), false);
    for (line, words) in (1..).zip(text.lines()) {
        let mark = words.strip_prefix("<!-- ");
        match mark.and_then(|mark| mark.strip_suffix(" -->")) {
            Some("end") => open = false,
            Some(mark) => {
                open = true;
                marks.push((line, mark));
            }
            None if words.starts_with("|---") && !open => bare.push(line),
            None => {}
        }
    }
    (marks, bare)
}

#[test]
fn every_table_of_the_evidence_says_what_makes_it() {
    let Some(list) = list() else { return };
    let mut made = made(&list);
    let mut strange = Vec::new();
    for file in markdown_below(&root().join("docs/src/evidence")) {
        let text = std::fs::read_to_string(&file).unwrap();
        let page = file.file_name().unwrap().to_string_lossy().into_owned();
        let (marks, bare) = marks(&text);
        let place = |line| format!("{}:{line}", called(&file));
        strange.extend(bare.into_iter().map(place));
        for (line, mark) in marks {
            let known = match mark.split_once(": ") {
                Some(("table", name)) => made.remove(&(name.to_owned(), page.clone())),
                Some(("by hand", how)) => !how.trim().is_empty(),
                _ => false,
            };
            if !known {
                strange.push(place(line));
            }
        }
    }
    assert!(
        strange.is_empty(),
        "tables that no command makes: {strange:?}; `python3 benches/evidence.py --list`, or <!-- by hand: HOW -->"
    );
    assert!(made.is_empty(), "made, but in no page: {made:?}");
}

#[test]
fn every_table_of_the_evidence_has_commands_that_can_be_typed() {
    let Some(list) = list() else { return };
    let commands = list.lines().filter_map(|line| line.strip_prefix("    "));
    let faults: Vec<_> = commands
        .filter_map(|command| fault(command, &BTreeSet::new()))
        .collect();
    assert!(faults.is_empty(), "{faults:?}");
}
