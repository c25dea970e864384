//! The last line of a verb: the command to run next, ready to be typed.

use quell_shapers::Mode;
use std::ffi::OsStr;
use std::fmt::Write;

/// `Next: quell ...` and a line end. Words that a shell would split are quoted.
pub fn command<W: AsRef<OsStr>>(words: impl IntoIterator<Item = W>) -> String {
    line("Next", words)
}

/// The same after a step that comes first: `Then: quell ...`.
pub fn then<W: AsRef<OsStr>>(words: impl IntoIterator<Item = W>) -> String {
    line("Then", words)
}

/// Modes as the options of a command.
pub fn modes(modes: &[Mode]) -> impl Iterator<Item = String> {
    let value = |mode: &Mode| format!("{:.4},{:.5}", mode.hertz(), mode.damping_ratio());
    modes
        .iter()
        .flat_map(move |mode| ["--mode".into(), value(mode)])
}

fn line<W: AsRef<OsStr>>(word: &str, words: impl IntoIterator<Item = W>) -> String {
    let mut line = format!("{word}: quell");
    for word in words {
        let _ = write!(line, " {}", quoted(&word.as_ref().to_string_lossy()));
    }
    line + "\n"
}

/// The word, quoted if a shell would not take it literally.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./,:=+@%".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_takes_each_word_as_one() {
        let line = command(["identify", "my run.csv", "it's", "arm#2", "8.1,0.02"]);
        assert_eq!(
            line,
            "Next: quell identify 'my run.csv' 'it'\\''s' 'arm#2' 8.1,0.02\n"
        );
    }
}
