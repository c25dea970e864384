//! The package for Python: its wheel is built and installed, and its own tests are run.

#[path = "absent/skipped.rs"]
mod skipped;

use skipped::skipped;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What a program said, where it failed.
fn told(output: &Output) -> String {
    let [out, err] = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    format!("{out}{err}")
}

/// The interpreter with the packages of the tests; none, with a word, where they cannot be installed.
fn interpreter() -> Option<PathBuf> {
    let script = ["tests/absent/python.sh", "python/requirements.txt", "-c"];
    let output = Command::new("sh")
        .current_dir(root())
        .args(script)
        .arg("import sys; print(sys.executable)")
        .output()
        .expect("a shell");
    match output.status.code() {
        Some(0) => Some(String::from_utf8_lossy(&output.stdout).trim().into()),
        Some(77) => {
            skipped(told(&output).trim());
            None
        }
        _ => panic!("{}", told(&output)),
    }
}

fn run(command: &mut Command) {
    let output = command.output().expect("a program");
    assert!(output.status.success(), "{}", told(&output));
}

/// The wheel, built in the folder of this build, so that what is compiled there is taken from there.
fn wheel(python: &Path, wheels: &Path, target: &Path) -> PathBuf {
    let _ = std::fs::remove_dir_all(wheels);
    run(Command::new(python)
        .args(["-m", "maturin", "build", "--release", "--locked", "--out"])
        .arg(wheels)
        .env("CARGO_TARGET_DIR", target)
        .current_dir(root().join("python")));
    let mut files = std::fs::read_dir(wheels).expect("wheels");
    files.next().expect("a wheel").expect("a wheel").path()
}

#[test]
fn the_wheel_is_built_and_its_tests_pass() {
    let Some(python) = interpreter() else { return };
    let scratch = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let target = scratch.parent().expect("a target folder");
    let wheel = wheel(&python, &scratch.join("wheels"), target);
    // Built once for all versions of Python.
    let name = wheel.to_string_lossy();
    assert!(name.contains("-cp310-abi3-"), "{name}");
    run(Command::new(&python)
        .args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--force-reinstall",
            "--no-deps",
        ])
        .arg(&wheel));
    // In a folder without the sources, so that what is installed is what is tested.
    let package = root().join("python");
    run(Command::new(&python)
        .args(["-B", "-m", "pytest", "-q", "-p", "no:cacheprovider", "-c"])
        .arg(package.join("pyproject.toml"))
        .arg(package.join("tests"))
        .current_dir(scratch));
}
