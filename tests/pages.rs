//! Pages as a person sees them: the curves are drawn, and no two names share a colour.

#[path = "absent/skipped.rs"]
mod skipped;

use skipped::skipped;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

/// The page of a verb that is run in a folder.
fn page(folder: &Path, verb: &str, file: &str) -> String {
    let mut command = Command::new(env!("CARGO_BIN_EXE_quell"));
    command.args([verb, "--out", "out"]).current_dir(folder);
    assert!(command.output().unwrap().status.success());
    std::fs::read_to_string(folder.join("out").join(file)).unwrap()
}

/// The page once its scripts have run; none, with a word, where there is no Chromium.
fn drawn(folder: &Path, file: &str) -> Option<String> {
    let mut command = Command::new("chromium");
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--dump-dom"]);
    command.arg(format!(
        "--user-data-dir={}",
        folder.join("profile").display()
    ));
    command.arg(format!(
        "file://{}",
        folder.join("out").join(file).display()
    ));
    let Ok(output) = command.output() else {
        skipped("there is no chromium: the pages are not drawn");
        return None;
    };
    Some(String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn every_chart_is_drawn() {
    let folder = TempDir::new().unwrap();
    for (verb, file) in [("compare", "compare.html"), ("move", "report.html")] {
        let charts = page(folder.path(), verb, file)
            .matches("id=\"plot-")
            .count();
        assert!(charts > 0, "{verb}");
        let Some(drawn) = drawn(folder.path(), file) else {
            return;
        };
        assert_eq!(drawn.matches("<canvas").count(), charts, "{verb}");
    }
}

#[test]
fn no_two_shapers_share_a_colour() {
    let folder = TempDir::new().unwrap();
    let page = page(folder.path(), "compare", "compare.html");
    let table = page.split("<table").nth(1).unwrap();
    let table = table.split("</table").next().unwrap();
    let colours: Vec<&str> = table.split("background:var(").skip(1).collect();
    let colours: Vec<&str> = colours
        .iter()
        .map(|rest| rest.split(')').next().unwrap())
        .collect();
    assert_eq!(colours.len(), quell::shapers::SHAPERS.len());
    assert_eq!(
        colours.iter().collect::<BTreeSet<_>>().len(),
        colours.len(),
        "{colours:?}"
    );
}
