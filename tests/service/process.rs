//! The process itself: it starts, obeys SIGTERM, and keeps its state.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use quell::learning::Memory;
use quell::service::state::{State, StateFile};
use rustix::process::{Pid, Signal, kill_process};

#[test]
fn a_signal_ends_it_with_success_and_its_state_is_kept() {
    let data = tempfile::tempdir().expect("a folder");
    for start in 1..=2 {
        let mut process = Command::new(assert_cmd::cargo::cargo_bin!("quell"))
            .args([
                "serve",
                "--robot",
                "udp",
                "--udp",
                "127.0.0.1:0",
                "--http",
                "127.0.0.1:0",
            ])
            .arg("--data")
            .arg(data.path())
            .stdout(Stdio::piped())
            .spawn()
            .expect("it starts");
        let mut lines = BufReader::new(process.stdout.take().expect("a pipe")).lines();
        let first = lines.next().expect("a line").expect("text");
        assert!(first.contains("robot udp, 1000 Hz"), "{first}");
        let pid = Pid::from_child(&process);
        kill_process(pid, Signal::TERM).expect("it can be told");
        assert!(process.wait().expect("it ends").success());
        let state = std::fs::read(data.path().join("state.json")).expect("a state");
        let state: serde_json::Value = serde_json::from_slice(&state).expect("JSON");
        assert_eq!(state["starts"], start);
    }
    // A state that cannot be understood is set aside, and the service starts without it.
    std::fs::write(data.path().join("state.json"), "{\"version\":").expect("a file");
    let file = StateFile::within(data.path(), quell::service::disk::Disk::default());
    assert_eq!(file.load(), State::default());
    let aside = data.path().join("state.json.damaged");
    assert!(aside.exists());
    // A map that no learner takes is forgotten, and kept beside; the rest of the state stays.
    let mut state = State {
        last_move: 7,
        ..State::default()
    };
    let map = |unexplained| {
        Some(Memory {
            unexplained,
            ..Memory::default()
        })
    };
    for (name, unexplained) in [("joint_1", -1.0), ("joint_2", 0.5)] {
        let joint = state.joints.entry(name.into()).or_default();
        joint.map = map(unexplained);
    }
    file.save(&state).expect("saved");
    let saved = std::fs::read(data.path().join("state.json")).expect("a state");
    let loaded = file.load();
    assert_eq!(loaded.last_move, 7);
    assert_eq!(loaded.joints["joint_1"].map, None);
    assert_eq!(loaded.joints["joint_2"].map, map(0.5));
    assert_eq!(std::fs::read(aside).expect("the file"), saved);
}
