//! Blocks of commands that are run, and what they print.

use super::root;
use std::path::Path;
use std::process::Command;

/// A folder with the examples in it, to run commands in.
pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root().join("examples"), folder.path().join("examples")).unwrap();
    folder
}

/// What a block prints on stdout.
pub fn run(folder: &Path, block: &str) -> Result<String, String> {
    let program = Path::new(env!("CARGO_BIN_EXE_quell"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", program.parent().unwrap().display());
    // In a clone the program is run by cargo, which is there already here.
    let block = block.replace("cargo run --release -- ", "quell ");
    let output = Command::new("bash")
        .args(["-eu", "-c", &block])
        .current_dir(folder)
        .env("PATH", path)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    match output.status.success() {
        true => Ok(text(&output.stdout)),
        false => Err(format!("{}: {}", output.status, text(&output.stderr))),
    }
}

/// A line with its numbers and gaps alike: the last digit differs between machines.
fn masked(line: &str) -> String {
    let mut masked = String::new();
    for word in line.split_whitespace() {
        let digits: String = word
            .chars()
            .filter(|letter| !letter.is_ascii_digit())
            .collect();
        let bare = digits.trim_matches(['.', '-', '+', '\u{2212}', 'e', ',', '%']);
        let is_number = digits.len() < word.len() && bare.is_empty();
        masked += if is_number { "#" } else { &digits };
        masked.push(' ');
    }
    masked
}

/// The first line that was not printed; a line of three dots stands for any.
pub fn strange<'a>(written: &'a str, printed: &str) -> Option<&'a str> {
    let printed: Vec<String> = printed.lines().map(masked).collect();
    let held = |line: &&str| *line == "..." || printed.contains(&masked(line));
    written.lines().find(|line| !held(line))
}

/// The block with the figures of today; as it was where it leaves lines out.
pub fn fresh(written: &str, printed: &str) -> String {
    let whole = !written.lines().any(|line| line == "...");
    match whole {
        true => printed.trim_matches('\n').to_string() + "\n",
        false => written.to_string(),
    }
}
