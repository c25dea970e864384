//! A real limit: the system lets the process write no more than some kilobytes into a file.

use std::fs::File;
use std::process::Command;

use rustix::process::{Pid, Resource, Rlimit, prlimit};

use super::check_recording;
use super::client::Client;
use super::process::{arguments, go, start, until};

/// Longest file, blocks of 1024 bytes: more than a state, less than a move.
const BLOCKS: u32 = 6;

#[test]
fn a_disk_that_takes_no_moves_is_told_everywhere_and_moves_go_on() {
    let data = tempfile::tempdir().expect("a folder");
    // By default a file that is too long ends the process.
    let limited = format!("trap '' XFSZ; ulimit -S -f {BLOCKS}; exec \"$@\"");
    let mut command = Command::new("bash");
    command.args(["-c", &limited, "bash", env!("CARGO_BIN_EXE_quell")]);
    // The log is on that disk, too: what cannot be logged ends nothing.
    let log = File::create(data.path().join("log")).expect("a log");
    let process = start(command.args(arguments(data.path())).stderr(log));
    let mut client = Client::new(process.address);
    let state = until(&mut client, "/api/state", "it runs", |state| {
        state["joints"][0]["phase"] == "rest"
    });
    assert_eq!(state["disk"]["state"], "fine", "{state:#}");

    let done = go(&mut client, 40.0);
    assert_eq!(done["interrupted"], false, "{done}");
    let state = until(&mut client, "/api/state", "it is lost", |state| {
        state["disk"]["recordings_lost"] == 1
    });
    assert_eq!(state["disk"]["state"], "failing", "{state:#}");
    let fault = &state["disk"]["faults"][0];
    assert_eq!(fault["what"], "recordings");
    assert!(fault["since_unix_time_s"].as_f64() > Some(1e9), "{fault}");
    let reason = fault["reason"].as_str().expect("a reason");
    assert!(reason.contains("too large"), "{reason}");
    assert!(state["moves"][0]["recording"].is_null(), "{state:#}");
    let metrics = client.get("/metrics").text();
    for line in [
        "quell_disk_failing{what=\"recordings\"} 1\n",
        "quell_disk_failing{what=\"state\"} 0\n",
        "quell_recordings_lost_total 1\n",
    ] {
        assert!(metrics.contains(line), "{line} in {metrics}");
    }
    let refused = client.post("/api/recordings", r#"{"recording": false}"#);
    assert_eq!(refused.status, 409, "{}", refused.text());

    // There is room again: that is told, and the next move is recorded whole. Of the first one there may
    // be a part, if the disk had taken one before it was too long.
    let limit = Rlimit {
        current: None,
        maximum: None,
    };
    let lifted = prlimit(
        Some(Pid::from_child(&process.child)),
        Resource::Fsize,
        limit,
    );
    lifted.expect("it can be lifted");
    until(&mut client, "/api/state", "it is fine again", |state| {
        state["disk"]["state"] == "fine"
    });
    go(&mut client, 0.0);
    let state = until(
        &mut client,
        "/api/state",
        "the next one is named",
        |state| state["moves"][1]["recording"] == "move-000002",
    );
    assert_eq!(state["disk"]["recordings_lost"], 1);
    let shelf = data.path().join("recordings");
    // It is named from when it grows on the disk.
    let list = until(&mut client, "/api/recordings", "it is whole", |list| {
        let mut listed = list.as_array().into_iter().flatten();
        listed.any(|entry| entry["name"] == "move-000002")
    });
    check_recording(&shelf.join("move-000002"));
    for done in state["moves"].as_array().expect("moves") {
        let name = done["recording"].as_str();
        let listed = list.as_array().expect("a list").iter();
        let is_there = { listed }.any(|entry| entry["name"].as_str() == name);
        assert!(name.is_none() || is_there, "{done} is not in {list}");
    }
}
