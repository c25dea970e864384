//! The files of a verb replace nothing of a user's, and nothing of another verb's, without `--force`.

mod small;

use assert_cmd::Command;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A command, the folder that it writes into, and the files that it writes there, among others.
struct Verb {
    command: &'static str,
    folder: &'static str,
    files: &'static [&'static str],
}

/// Every verb that writes files. `--out` is given where it is not what a verb writes into.
const VERBS: &[Verb] = &[
    Verb {
        command: "simulate",
        folder: "out",
        files: &["recording.toml", "tip_position.csv.gz", "model.toml"],
    },
    Verb {
        command: "simulate model.toml fleet/r0000 --out predicted/p.csv",
        folder: "predicted",
        files: &["p.csv"],
    },
    Verb {
        command: "move",
        folder: "out",
        files: &[
            "report.html",
            "model.toml",
            "unshaped/recording.toml",
            "adaptive_next/motor_position.csv.gz",
        ],
    },
    Verb {
        command: "diagnose --model model.toml fleet/r0000",
        folder: "out",
        files: &["report.html", "diagnosis.json", "model.toml"],
    },
    Verb {
        command: "identify fleet/r0000 --model model.toml",
        folder: "out",
        files: &["identify.html"],
    },
    Verb {
        command: "compare --mode 8.12,0.084 --rate 250",
        folder: "out",
        files: &["compare.html"],
    },
    Verb {
        command: "shape --shaper zv --mode 8.12,0.084 --rate 250 command.csv --column a",
        folder: "out",
        files: &["command_shaped.csv"],
    },
    Verb {
        command: "prove --cases 1 --seed 5 --out out",
        folder: "out",
        files: &["proof.html", "proof.json"],
    },
    Verb {
        command: "prove --cases 1 --seed 5 --keep cases",
        folder: "cases",
        files: &[
            "truth.json",
            "case-00/model.toml",
            "case-00/train/recording.toml",
        ],
    },
];

/// A user's own file.
const OWN: &str = "mine\n";

fn quell(here: &Path, arguments: &str) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.current_dir(here).args(arguments.split_whitespace());
    command
}

/// Runs a command that must be refused, and returns what it says.
fn refused(here: &Path, arguments: &str) -> String {
    let assert = quell(here, arguments).assert().code(2).stdout("");
    String::from_utf8_lossy(&assert.get_output().stderr).into_owned()
}

fn workplace() -> TempDir {
    let folder = TempDir::new().unwrap();
    let here = folder.path();
    fs::write(here.join("model.toml"), small::MODEL).unwrap();
    fs::write(here.join("command.csv"), "a\n0\n1\n1\n").unwrap();
    small::fleet(&here.join("fleet"), 1);
    folder
}

/// Every file below a folder, with its content.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut all = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => all.extend(contents(&path)),
            false => drop(all.insert(path.clone(), fs::read(&path).unwrap())),
        }
    }
    all
}

#[test]
fn no_verb_replaces_what_it_did_not_write() {
    for verb in VERBS {
        let Verb {
            command,
            folder,
            files,
        } = verb;
        let place = workplace();
        let here = place.path();
        let out = here.join(folder);
        for name in *files {
            // A file that the user wrote before the verb ran at all.
            let file = out.join(name);
            fs::create_dir_all(file.parent().unwrap()).unwrap();
            fs::write(&file, OWN).unwrap();
            let before = contents(here);
            let said = refused(here, command);
            assert!(
                said.contains(name) && said.contains("--force"),
                "{command}: {said}"
            );
            assert_eq!(contents(here), before, "{command}");
            fs::remove_file(&file).unwrap();
        }
    }
}

#[test]
fn a_verb_replaces_what_it_wrote_and_nobody_changed() {
    for verb in VERBS {
        let Verb {
            command,
            folder,
            files,
        } = verb;
        let place = workplace();
        let here = place.path();
        let out = here.join(folder);
        fs::create_dir_all(&out).unwrap();
        fs::write(out.join("notes.txt"), OWN).unwrap();
        quell(here, command).assert().success();
        let written = contents(&out);
        for name in *files {
            assert!(written.contains_key(&out.join(name)), "{command}: {name}");
        }
        let hidden = |path: &&PathBuf| path.to_string_lossy().contains("/.quell-");
        assert_eq!(written.keys().find(hidden), None, "{command}");
        quell(here, command).assert().success();
        // What was changed since is the user's.
        let file = out.join(files[0]);
        fs::write(&file, OWN).unwrap();
        let said = refused(here, command);
        assert!(said.contains("changed since"), "{command}: {said}");
        quell(here, &format!("{command} --force"))
            .assert()
            .success();
        assert_ne!(fs::read(&file).unwrap(), OWN.as_bytes(), "{command}");
        let notes = fs::read(out.join("notes.txt")).unwrap();
        assert_eq!(notes, OWN.as_bytes(), "{command}");
    }
}

#[test]
fn a_verb_does_not_replace_what_another_wrote() {
    let place = workplace();
    let here = place.path();
    quell(here, "diagnose --model model.toml fleet/r0000")
        .assert()
        .success();
    let before = contents(&here.join("out"));
    let said = refused(here, "move");
    assert!(
        said.contains("out/report.html") && said.contains("`quell diagnose` wrote it"),
        "{said}"
    );
    assert_eq!(contents(&here.join("out")), before);
}

/// Not even with `--force`: without its input a command could not be run again.
#[test]
fn what_is_read_is_never_replaced() {
    let place = workplace();
    let here = place.path();
    for command in [
        "diagnose --model model.toml fleet/r0000 --out .",
        "simulate model.toml fleet/r0000 --out fleet/../model.toml",
    ] {
        let said = refused(here, &format!("{command} --force"));
        assert!(
            said.contains("is read, and would be written over"),
            "{said}"
        );
    }
    let model = fs::read_to_string(here.join("model.toml")).unwrap();
    assert_eq!(model, small::MODEL);
}

/// A folder of the name of a file, a file of the name of a folder, and a list that is none.
#[test]
fn what_stands_in_the_way_is_left_alone() {
    let place = workplace();
    let here = place.path();
    fs::create_dir_all(here.join("out/compare.html")).unwrap();
    fs::write(here.join("file"), OWN).unwrap();
    fs::create_dir(here.join("listed")).unwrap();
    fs::write(here.join("listed/.quell.json"), OWN).unwrap();
    let compare = "compare --mode 8.12,0.084 --rate 250 --force --out";
    let before = contents(here);
    for (folder, words) in [
        ("out", "is a folder"),
        ("file", "not a folder"),
        ("listed", "not a list of what Quell wrote"),
    ] {
        let said = refused(here, &format!("{compare} {folder}"));
        assert!(said.contains(words), "{said}");
    }
    assert_eq!(contents(here), before);
}

/// A link is replaced itself; what it leads to stays.
#[cfg(unix)]
#[test]
fn a_link_is_not_followed() {
    let place = workplace();
    let here = place.path();
    fs::create_dir(here.join("out")).unwrap();
    fs::write(here.join("precious"), OWN).unwrap();
    std::os::unix::fs::symlink("../precious", here.join("out/compare.html")).unwrap();
    let compare = "compare --mode 8.12,0.084 --rate 250";
    refused(here, compare);
    quell(here, &format!("{compare} --force"))
        .assert()
        .success();
    assert_eq!(fs::read(here.join("precious")).unwrap(), OWN.as_bytes());
    let report = fs::symlink_metadata(here.join("out/compare.html")).unwrap();
    assert!(report.is_file());
}

/// A refusal makes no folder either.
#[test]
fn nothing_is_written_before_the_work_is_done() {
    let place = workplace();
    let here = place.path();
    small::poison(&here.join("fleet"));
    for command in [
        "diagnose --model model.toml fleet/poison",
        "identify fleet/poison",
        "simulate --joint 9",
    ] {
        refused(here, command);
        assert!(!here.join("out").exists(), "{command}");
    }
}

/// A folder of a result's name that holds something else is not touched by a batch.
#[test]
fn a_batch_replaces_nothing() {
    let place = workplace();
    let here = place.path();
    let batch = "diagnose --batch --model model.toml fleet --out results";
    quell(here, batch).assert().success();
    let results = here.join("results");
    let mut entries = fs::read_dir(&results)
        .unwrap()
        .map(|one| one.unwrap().path());
    let one = entries.find(|path| path.is_dir()).unwrap();
    fs::remove_dir_all(&one).unwrap();
    fs::create_dir(&one).unwrap();
    fs::write(one.join("diagnosis.json"), OWN).unwrap();
    let before = contents(&results);
    let assert = quell(here, batch).assert().code(2);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("holds no result"), "{said}");
    assert_eq!(contents(&results), before);
    let said = refused(here, &format!("{batch} --force"));
    assert!(said.contains("a batch replaces nothing"), "{said}");
}
