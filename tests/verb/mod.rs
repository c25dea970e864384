//! Verbs of the program as a user types them in a folder.

use assert_cmd::Command;
use std::path::Path;

/// What a verb prints on its two outputs.
pub fn quell(folder: impl AsRef<Path>, arguments: &[&str]) -> (String, String) {
    let mut command = Command::cargo_bin("quell").unwrap();
    let output = command
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr))
}

/// All of these words are in a text.
pub fn has(text: &str, words: &[&str]) {
    for own in words {
        assert!(text.contains(own), "{own:?} is not in {text}");
    }
}
