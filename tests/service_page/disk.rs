//! The page while a disk is full.

use std::process::{Command, Stdio};

use super::browser::Browser;
use super::process::{Process, announced};
use super::{RESTS, enable, travel, until};

#[test]
fn a_full_disk_is_told_on_the_page() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut browser) = Browser::start(&folder.path().join("profile")) else {
        return;
    };
    // The system lets the process write no more than 6 KiB into a file: a state, and no recording of a move.
    // By default a file that is too long ends the process.
    let limited = "trap '' XFSZ; ulimit -S -f 6; exec \"$@\"";
    let mut command = Command::new("bash");
    command.args(["-c", limited, "bash", env!("CARGO_BIN_EXE_quell")]);
    command.args(["serve", "--http", "127.0.0.1:0", "--data"]);
    command.arg(folder.path().join("data"));
    let mut process = Process(command.stdout(Stdio::piped()).spawn().unwrap());
    let page = announced(process.0.stdout.take().unwrap(), "http://");
    browser.open(&page);
    until(&mut browser, RESTS);
    enable(&mut browser);
    travel(&mut browser, 40, 1);
    browser.until(
        "document.querySelector('#trouble').textContent.includes('Moves are not recorded since ')",
    );
    assert!(browser.text("#trouble").contains("too large"));
    // What was not recorded cannot be chosen.
    assert_eq!(
        browser.value("document.querySelectorAll('#recordings button').length"),
        serde_json::json!(0)
    );
    browser.assert_sound();
}
