//! Parquet files as LeRobot and pandas write them: what is read, what is refused, and damaged files.

mod columns;
mod damaged;
mod learning;
#[path = "../episodes/servo.rs"]
mod servo;
mod written;

use assert_cmd::Command;
use std::path::Path;

/// Runs the command line in a folder; gives exit code, output and errors.
fn quell(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::cargo_bin("quell").unwrap();
    let told = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let [out, err] = [told.stdout, told.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (told.status.code(), out, err)
}
