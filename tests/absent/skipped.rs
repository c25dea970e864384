//! A word for each test that this machine cannot run.

use std::fs::OpenOptions;
use std::io::{Write, stderr};
use std::path::Path;

/// Says on the terminal, and at the end of `.ci/run`, what was not tested and why.
pub fn skipped(why: &str) {
    let line = format!("skipped: {why}\n");
    // Written past the capture of the test harness, which shows nothing of a test that passes.
    let _ = stderr().write_all(line.as_bytes());
    let list = Path::new(env!("CARGO_TARGET_TMPDIR")).join("skipped.txt");
    let list = OpenOptions::new().create(true).append(true).open(list);
    let _ = list.and_then(|mut list| list.write_all(line.as_bytes()));
}
