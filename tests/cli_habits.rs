//! What people expect of any command: completions, a manual, colours, pipes, signals, and errors of one line.

use assert_cmd::Command;
use serde_json::Value;
use std::path::Path;
use std::process::Stdio;
use tempfile::TempDir;

const ARM: &str = include_str!("../crates/simulation/src/plant/rx170.toml");

fn quell(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("quell").unwrap();
    command.current_dir(folder).args(arguments);
    command
}

/// What a refused command says; nothing else is printed.
fn refused(folder: &Path, arguments: &[&str]) -> String {
    let assert = quell(folder, arguments).assert().code(2).stdout("");
    String::from_utf8(assert.get_output().stderr.clone()).unwrap()
}

/// What a shell line prints on stdout and on stderr, and its exit code.
fn shell(folder: &Path, line: &str) -> (String, String, Option<i32>) {
    let program = Path::new(env!("CARGO_BIN_EXE_quell"));
    let path = std::env::var("PATH").unwrap_or_default();
    let output = std::process::Command::new("bash")
        .args(["-c", &format!("set -o pipefail; {line}")])
        .current_dir(folder)
        .env(
            "PATH",
            format!("{}:{path}", program.parent().unwrap().display()),
        )
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        text(&output.stdout),
        text(&output.stderr),
        output.status.code(),
    )
}

#[test]
fn each_shell_gets_completions_with_all_verbs() {
    let folder = TempDir::new().unwrap();
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let assert = quell(folder.path(), &["completions", shell])
            .assert()
            .success();
        let script = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        for word in ["diagnose", "held-out", "doctor", "optimal"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let (_, stderr, code) = shell(folder.path(), "quell completions bash | bash -n");
    assert_eq!((stderr.as_str(), code), ("", Some(0)));
}

#[test]
fn the_manual_has_a_page_for_each_verb_that_is_built_in() {
    let folder = TempDir::new().unwrap();
    let assert = quell(folder.path(), &["man"]).assert().success();
    let page = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert!(
        page.contains(".TH quell 1") && page.contains("Exit codes"),
        "{page}"
    );
    for words in ["ENVIRONMENT", "NO_COLOR", "QUELL_LOG"] {
        assert!(page.contains(words), "{words} in {page}");
    }
    // No page is referred to that is not written.
    assert!(!page.contains("help(1)"), "{page}");
    quell(folder.path(), &["man", "--out", "man1"])
        .assert()
        .success()
        .stdout("");
    let main = std::fs::read_to_string(folder.path().join("man1/quell.1")).unwrap();
    assert_eq!(main, page);
    for verb in ["move", "diagnose", "doctor"] {
        assert!(
            folder.path().join(format!("man1/quell-{verb}.1")).exists(),
            "{verb}"
        );
    }
}

#[test]
fn verbs_that_are_not_built_in_are_not_listed_and_say_how_to_build_them() {
    let folder = TempDir::new().unwrap();
    let assert = quell(folder.path(), &["--help"]).assert().success();
    let help = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    for verb in ["work", "results"] {
        let listed = help
            .lines()
            .any(|line| line.trim_start().starts_with(&format!("{verb} ")));
        assert_eq!(listed, cfg!(feature = "nats"), "{help}");
        if !listed {
            let told = refused(folder.path(), &[verb, "--queue", "nats://127.0.0.1:1"]);
            assert!(told.contains("--features nats"), "{told}");
            let help = quell(folder.path(), &[verb, "--help"]).assert().success();
            let help = String::from_utf8_lossy(&help.get_output().stdout).into_owned();
            assert!(
                help.starts_with("This program is built without NATS"),
                "{help}"
            );
        }
    }
    let assert = quell(folder.path(), &["diagnose", "--help"])
        .assert()
        .success();
    let help = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
    assert_eq!(help.contains("--queue"), cfg!(feature = "nats"), "{help}");
}

/// The last line of a verb that begins so, as it is typed.
fn last(text: &str) -> &str {
    text.trim_end().lines().last().unwrap_or_default()
}

#[test]
fn each_verb_ends_with_the_next_command_and_that_command_runs() {
    let folder = TempDir::new().unwrap();
    // From a first move to the train for what rings in it.
    let mut line = "quell move".to_string();
    for verb in ["identify", "compare", "shape"] {
        let (stdout, stderr, code) = shell(folder.path(), &line);
        assert_eq!(code, Some(0), "{line}: {stderr}");
        line = last(&stdout)
            .strip_prefix("Next: ")
            .expect(&stdout)
            .to_string();
        assert!(line.starts_with(&format!("quell {verb} ")), "{line}");
    }
    let (stdout, stderr, code) = shell(folder.path(), &line);
    assert_eq!(code, Some(0), "{line}: {stderr}");
    assert!(
        last(&stdout).ends_with("COMMAND.csv --column NAME"),
        "{stdout}"
    );
    for (line, next) in [
        (
            "quell simulate --out s",
            "quell identify s/recording.toml --model s/model.toml --out s",
        ),
        ("quell inspect s", "quell identify s --model s/model.toml"),
        (
            "quell score out/model.toml s",
            "quell diagnose --model out/model.toml s",
        ),
        (
            "quell simulate out/model.toml s --out p.csv",
            "quell diagnose --model out/model.toml s",
        ),
        ("quell doctor", "quell move"),
    ] {
        let (stdout, stderr, _) = shell(folder.path(), line);
        assert_eq!(last(&stdout), format!("Next: {next}"), "{line}: {stderr}");
    }
}

#[test]
fn the_log_has_no_colours_where_nobody_sees_them() {
    let folder = TempDir::new().unwrap();
    let assert = quell(folder.path(), &["compare", "-v"]).assert().success();
    let log = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(
        log.contains("writing") && !log.contains('\u{1b}'),
        "{log:?}"
    );
    // On a terminal of its own, as script makes one, NO_COLOR takes them away.
    let line = |colour: &str| format!("{colour} script -qec 'quell compare -v --out b' /dev/null");
    if shell(folder.path(), "command -v script").2 == Some(0) {
        let (plain, _, _) = shell(folder.path(), &line("NO_COLOR=1"));
        assert!(
            plain.contains("writing") && !plain.contains("\u{1b}[32m"),
            "{plain:?}"
        );
        let (coloured, _, _) = shell(folder.path(), &line("NO_COLOR="));
        assert!(coloured.contains("\u{1b}[32m"), "{coloured:?}");
    }
}

#[test]
fn quiet_says_nothing_on_stderr_and_is_not_verbose() {
    let folder = TempDir::new().unwrap();
    quell(folder.path(), &["compare", "-q"])
        .assert()
        .success()
        .stderr("");
    let told = refused(folder.path(), &["compare", "-q", "-v"]);
    assert!(
        told.contains("--quiet") && told.contains("--verbose"),
        "{told}"
    );
}

#[test]
fn a_reader_that_goes_away_ends_a_verb_quietly() {
    let folder = TempDir::new().unwrap();
    for line in [
        "quell completions bash | head -1",
        "quell move --help | head -1",
        "quell compare --out c | head -1",
    ] {
        let (stdout, stderr, code) = shell(folder.path(), line);
        assert_eq!(
            (stdout.lines().count(), stderr.as_str(), code),
            (1, "", Some(0)),
            "{line}"
        );
    }
}

#[test]
fn an_interrupt_ends_a_verb_quietly_and_leaves_nothing_behind() {
    let folder = TempDir::new().unwrap();
    // What runs in the background of a script ignores the interrupt, and so would its children.
    let mut child = std::process::Command::new("env")
        .args(["--default-signal=INT", env!("CARGO_BIN_EXE_quell")])
        .args(["prove", "--cases", "500", "--out", "out"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(500));
    let id = child.id().to_string();
    let sent = std::process::Command::new("kill")
        .args(["-INT", &id])
        .status()
        .unwrap();
    assert!(sent.success());
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
    let status = child.wait().unwrap();
    assert_eq!(
        std::os::unix::process::ExitStatusExt::signal(&status),
        Some(2),
        "{status}"
    );
    assert!(!said.contains("panicked"), "{said}");
    let left = std::fs::read_dir(folder.path().join("out"))
        .into_iter()
        .flatten();
    let left: Vec<_> = left.map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn a_mode_that_cannot_be_is_refused_in_a_sentence() {
    let folder = TempDir::new().unwrap();
    let cases = [
        (
            ["move", "--belief", "-8,0.1"],
            "a natural frequency of -8 Hz is not a number from 1e-9 to 1e9",
        ),
        (
            ["compare", "--mode", "8,-0.1"],
            "damping ratio -0.1 is not in [0, 1)",
        ),
        (
            ["simulate", "--belief", "8"],
            "is not F,XI, such as 8.12,0.084",
        ),
    ];
    for (arguments, sentence) in cases {
        let told = refused(folder.path(), &arguments);
        assert!(told.contains(sentence), "{told}");
    }
}

#[test]
fn a_count_of_nothing_is_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        ["prove", "--cases", "0"],
        ["prove", "--cases", "many"],
        ["diagnose", "--jobs", "0"],
    ] {
        let refused = refused(folder.path(), &arguments);
        assert!(
            refused.contains("it is not a whole number, 1 or more"),
            "{refused}"
        );
    }
}

#[test]
fn a_robot_file_is_refused_with_line_key_and_what_was_meant() {
    let folder = TempDir::new().unwrap();
    let cases = [
        (
            ("bandwidth_hz", "bandwith_hz"),
            "arm.toml:22: unknown key \"bandwith_hz\"; did you mean \"bandwidth_hz\"?",
        ),
        (
            ("\"across_joint\"", "\"across_join\""),
            "it must be one of across_joint, to_ground; did you mean \"across_joint\"?",
        ),
        (
            ("noise_um = 10.0", "noise_um = \"much\""),
            "arm.toml:32: tracker.noise_um = \"much\": it must be a number",
        ),
        (
            ("[servo]", "[servo"),
            "arm.toml:21:7: [servo: the closing ] is missing",
        ),
        (
            ("damping_ratio = 0.084", "damping_ratio = 1.5"),
            "joint[1].mode[1].damping_ratio = 1.5: 0 or more, below 1",
        ),
    ];
    for ((right, wrong), words) in cases {
        std::fs::write(folder.path().join("arm.toml"), ARM.replace(right, wrong)).unwrap();
        let told = refused(folder.path(), &["move", "--robot", "arm.toml"]);
        assert!(told.contains(words), "{told}");
        assert_eq!(told.lines().count(), 1, "{told}");
    }
}

#[test]
fn the_doctor_tells_what_is_built_in_and_what_the_machine_grants() {
    let folder = TempDir::new().unwrap();
    let assert = quell(folder.path(), &["doctor", "--json"])
        .assert()
        .success();
    let told: Value = serde_json::from_slice(&assert.get_output().stdout).unwrap();
    let features = told["features"].as_array().unwrap();
    let serve = features.iter().find(|one| one["name"] == "serve").unwrap();
    assert_eq!(serve["built"], true);
    assert!(told["machine"]["cores"].as_u64().unwrap() >= 1);
    assert!(told["tick"]["real_time_priority"].is_boolean());
    let late = &told["tick"]["lateness_us"];
    assert!(late["median"].as_f64().unwrap() <= late["max"].as_f64().unwrap());
    quell(folder.path(), &["doctor"]).assert().success();
}
