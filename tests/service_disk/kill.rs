//! A service that is killed in mid-recording, and its next start.

use std::fs;
use std::time::{Duration, Instant};

use quell::recording::Recording;

use super::check_recording;
use super::client::Client;
use super::process::{enable, go, serve, until};

#[test]
fn a_recording_that_a_kill_cuts_opens_everywhere_after_the_next_start() {
    let data = tempfile::tempdir().expect("a folder");
    let mut process = serve(data.path());
    let mut client = Client::new(process.address);
    until(&mut client, "/api/state", "it is commanded", |state| {
        state["joints"][0]["phase"] == "rest"
    });
    enable(&mut client);
    let body = r#"{"joint": "joint_1", "target_deg": 60}"#;
    assert_eq!(client.post("/api/move", body).status, 200);
    let recordings = data.path().join("recordings");
    let grown = recordings.join(".unfinished-move-000001/recording.mcap");
    let since = Instant::now();
    // Two parts of it are on the disk, so that it does grow.
    let mut sizes = std::collections::BTreeSet::new();
    while sizes.len() < 2 && !recordings.join("move-000001").exists() {
        sizes.extend(fs::metadata(&grown).map(|data| data.len()));
        assert!(since.elapsed() < Duration::from_secs(120), "{sizes:?}");
        std::thread::sleep(Duration::from_millis(5));
    }
    process.child.kill().expect("it can be killed");
    process.child.wait().expect("it ends");
    let before = Recording::from_path(&grown).expect("it is readable up to the cut");
    assert!(mcap::Summary::read(&fs::read(&grown).expect("a file")).is_err());

    let again = serve(data.path());
    let mut client = Client::new(again.address);
    let list = until(&mut client, "/api/recordings", "it is listed", |list| {
        list[0]["name"] == "move-000001"
    });
    assert!(list[0]["duration_s"].as_f64() > Some(0.0), "{list}");
    let shelved = recordings.join("move-000001");
    check_recording(&shelved);
    let after = Recording::from_path(shelved.join("recording.mcap")).expect("a recording");
    assert_eq!(after.channels, before.channels);
    // Its name is not given to another move, although the state knows nothing of it.
    let next = go(&mut client, 20.0);
    assert_eq!(next["id"], 2, "{next}");
}

#[test]
fn a_state_names_no_recording_that_does_not_exist() {
    let data = tempfile::tempdir().expect("a folder");
    let process = serve(data.path());
    let mut client = Client::new(process.address);
    go(&mut client, 20.0);
    let recorded = until(&mut client, "/api/recordings", "it is listed", |list| {
        list[0]["name"] == "move-000001"
    });
    assert_eq!(recorded[0]["number"], 1);
    let state = client.get("/api/state").json();
    assert_eq!(state["moves"][0]["recording"], "move-000001");
    drop(process);
    // Somebody has removed it meanwhile.
    fs::remove_dir_all(data.path().join("recordings/move-000001")).expect("a folder");
    let again = serve(data.path());
    let mut client = Client::new(again.address);
    let state = until(&mut client, "/api/state", "it runs", |state| {
        state["moves"][0]["id"] == 1
    });
    assert!(state["moves"][0]["recording"].is_null(), "{state:#}");
}
