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

/// A word that holds a number.
struct Figure {
    value: f64,
    /// One in its last digit; 0 of a whole number, which counts.
    last: f64,
    /// What stands around it.
    around: String,
}

fn figure(word: &str) -> Option<Figure> {
    let word = word.replace('\u{2212}', "-");
    let bare = word
        .trim_matches(['(', ')', '[', ']', ',', ';', ':', '%'])
        .trim_end_matches('.');
    let value = bare.parse().ok().filter(|value: &f64| value.is_finite())?;
    let (digits, power) = bare.split_once('e').unwrap_or((bare, "0"));
    let decimals = digits.split_once('.').map(|own| own.1.len() as i32);
    let last = decimals.map_or(0.0, |own| 10f64.powi(power.parse().unwrap_or(0) - own));
    Some(Figure {
        value,
        last,
        around: word.replacen(bare, "#", 1),
    })
}

/// Whether two lines say the same, gaps aside.
///
/// What is run has the same input and seed everywhere. Machines differ in fused operations and in their libraries of
/// functions: by some 1e-12, which a fit keeps below 1e-6. That is less than any figure shows, so that at most its last
/// digit falls to the other side of a rounding. A whole number is a count, and is equal.
fn alike(written: &str, printed: &str) -> bool {
    let words = [written, printed].map(|line| line.split_whitespace().collect::<Vec<_>>());
    let same = |written: &str, printed: &str| match (figure(written), figure(printed)) {
        (Some(own), Some(other)) => {
            // Half a digit more for what the sums in binary leave.
            own.around == other.around
                && (own.value - other.value).abs() <= 1.5 * own.last.min(other.last)
        }
        _ => written == printed,
    };
    words[0].len() == words[1].len() && words[0].iter().zip(&words[1]).all(|(w, p)| same(w, p))
}

/// A line without its figures.
fn masked(line: &str) -> String {
    let words = line.split_whitespace().map(|word| match figure(word) {
        Some(own) => own.around,
        None => word.to_string(),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// The first line that was not printed; a line of three dots stands for any.
pub fn strange<'a>(written: &'a str, printed: &str) -> Option<&'a str> {
    let held = |line: &&str| *line == "..." || printed.lines().any(|own| alike(line, own));
    written.lines().find(|line| !held(line))
}

/// The block with the figures of today; where it leaves lines out, it still does.
pub fn fresh(written: &str, printed: &str) -> String {
    if !written.lines().any(|line| line == "...") {
        return printed.trim_matches('\n').to_string() + "\n";
    }
    let renewed = written.lines().map(|line| {
        let held = printed.lines().any(|own| alike(line, own));
        let mut same = printed.lines().filter(|own| masked(own) == masked(line));
        same.next().filter(|_| !held).unwrap_or(line)
    });
    renewed.map(|line| format!("{line}\n")).collect()
}

#[test]
fn figures_are_alike_to_the_last_digit_and_counts_are_equal() {
    let written = "rms 8.54 urad, 1.00 times (2 effects); fit 98.02 %.";
    let alike = |printed: &str| alike(written, printed);
    assert!(alike(
        "rms 8.55 urad,  0.99 times (2 effects); fit 98.03 %."
    ));
    assert!(!alike(
        "rms 8.56 urad, 1.00 times (2 effects); fit 98.02 %."
    ));
    assert!(!alike(
        "rms 8.54 urad, 1.00 times (3 effects); fit 98.02 %."
    ));
    assert!(!alike(
        "rms 8.54 mrad, 1.00 times (2 effects); fit 98.02 %."
    ));
    let fresh = fresh("a 1.00\n...\n", "a 2.00\nb 1\n");
    assert_eq!(fresh, "a 2.00\n...\n");
}
