//! Programs in Python that know nothing of Quell.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use super::skipped::skipped;

/// The output of a script of `folder` (below `tests`); none, with a word, where its packages cannot be installed.
///
/// * `requirements`: the file in `folder` that lists them;
/// * `script`: its file in `folder`, and its arguments.
///
/// # Panics
/// Where the script fails.
pub fn python(folder: &str, requirements: &str, script: &[&OsStr]) -> Option<Vec<u8>> {
    let inside = Path::new("tests").join(folder);
    let (file, arguments) = script.split_first().expect("a script");
    let output = Command::new("sh")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .arg("tests/absent/python.sh")
        .args([inside.join(requirements), inside.join(file)])
        .args(arguments)
        .output()
        .expect("a shell");
    let words = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(77) {
        skipped(words.trim());
        return None;
    }
    assert!(output.status.success(), "{words}");
    Some(output.stdout)
}
