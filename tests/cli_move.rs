//! `quell move` as a user mistypes it: what it refuses, and in which words.

use assert_cmd::Command;
use tempfile::TempDir;

#[test]
fn bad_input_is_refused() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let robot = include_str!("../crates/simulation/src/plant/rx170.toml");
    write(
        "fast.toml",
        &robot.replace("rate_hz = 333.0", "rate_hz = 1e12"),
    );
    write(
        "stiff.toml",
        &robot.replace("frequency_hz = 8.12", "frequency_hz = 1e9"),
    );
    write("file", "");
    for (arguments, words) in [
        ("--target nan", "--target"),
        ("--target 0", "--target 0"),
        ("--target 1e9", "longer than"),
        ("--joint 0", "joints 1 to 6"),
        ("--joint 2", "has no mode"),
        ("--payload -5", "0 or more"),
        ("--noise nan", "0 or more"),
        ("--seed -1", "--seed"),
        ("--velocity 0", "above 0"),
        ("--jerk -3", "above 0"),
        // Moves that the 20 s of simulation would cut off, and beliefs that would fill the memory.
        ("--velocity 0.5", "has not ended after 20 s"),
        ("--belief 1e-9,0.1", "1e-9 Hz"),
        ("--belief-error -100", "--belief-error -100"),
        ("--belief 1e9,0.1", "two ticks"),
        ("--belief 8,1", "[0, 1)"),
        ("--robot .", ".: "),
        ("--robot absent.toml", "absent.toml"),
        ("--robot fast.toml", "tracker.rate_hz"),
        ("--robot stiff.toml", "joint[1].mode[1].frequency_hz"),
        ("--out file", "file"),
    ] {
        let mut command = Command::cargo_bin("quell").unwrap();
        command.current_dir(folder.path()).arg("move");
        let assert = command.args(arguments.split(' ')).assert();
        let assert = assert.code(2).stdout("");
        let stderr = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        let told = stderr.starts_with("error: ") && stderr.contains(words);
        assert!(told, "{arguments:?}: no {words:?} in {stderr}");
    }
}
