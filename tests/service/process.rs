//! The process itself: it starts, obeys SIGTERM, and keeps its state.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

use quell::learning::{Memory, ModeMemory, MoveMemory};
use quell::service::contract::ModeValue;
use quell::service::disk::Disk;
use quell::service::state::{LearnedMode, State, StateFile};
use rustix::process::{Pid, Signal, kill_process};

/// Control period, s.
const PERIOD: f64 = 0.001;

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
}

/// A state that cannot be understood is set aside, and the service starts without it. The second one does not replace
/// the first.
#[test]
fn each_damaged_state_is_kept_aside() {
    let data = tempfile::tempdir().expect("a folder");
    let file = StateFile::within(data.path(), Disk::default());
    for text in ["{\"version\":", "{\"version\": 1,"] {
        std::fs::write(data.path().join("state.json"), text).expect("a file");
        assert_eq!(file.load(PERIOD), State::default());
    }
    let aside = |name: &str| std::fs::read_to_string(data.path().join(name)).expect("a file");
    assert_eq!(aside("state.json.damaged"), "{\"version\":");
    assert_eq!(aside("state.json.damaged.2"), "{\"version\": 1,");
    // Where a file stands in place of the folder nothing can be kept, and the service starts nevertheless.
    let no_folder = data.path().join("state.json.damaged");
    let file = StateFile::within(&no_folder, Disk::default());
    assert_eq!(file.load(PERIOD), State::default());
}

/// A map with these figures of its only mode.
fn map(natural_frequency: f64, damping: f64) -> Option<Memory> {
    // A move that knows all of it to a hundredth: c = 1 at the four nodes.
    let said = MoveMemory {
        way: [0.0, 0.5],
        precision: vec![1e4, 0.0, 0.0, 0.0, 1e4, 0.0, 0.0, 1e4, 0.0, 1e4],
        vector: [1e4; 4],
        damping: [1e4, 1e4 * damping],
        ..MoveMemory::default()
    };
    let mode = ModeMemory {
        natural_frequency,
        share: [1.0, 1.0],
        moves: vec![said],
        ..ModeMemory::default()
    };
    Some(Memory {
        modes: vec![mode],
        unexplained: 0.5,
        ..Memory::default()
    })
}

/// Of a state, only what no arm has is forgotten: it is kept beside.
#[test]
fn modes_that_no_arm_has_are_not_remembered() {
    let data = tempfile::tempdir().expect("a folder");
    let file = StateFile::within(data.path(), Disk::default());
    let mut state = State {
        last_move: 7,
        ..State::default()
    };
    // rad/s; half of the control rate is 3142 rad/s.
    let maps = [
        ("sound", 50.0, 0.02, true),
        ("undamped", 50.0, -0.01, true),
        ("zero", 0.0, 0.02, false),
        ("negative", -50.0, 0.02, false),
        ("above_half_the_rate", 3150.0, 0.02, false),
        ("overdamped", 50.0, 1.1, false),
        ("negative_damping", 50.0, -0.1, false),
    ];
    for (name, w, xi, _) in maps {
        state.joints.entry(name.into()).or_default().map = map(w, xi);
    }
    let joint = state.joints.entry("sums".into()).or_default();
    joint.map = map(50.0, 0.02).map(|map| Memory {
        unexplained: -1.0,
        ..map
    });
    let modes = [
        (8.0, 0.03),
        (0.0, 0.03),
        (500.0, 0.03),
        (8.0, 1.0),
        (8.0, -0.1),
    ];
    let learned = |n: usize, frequency_hz, damping_ratio| LearnedMode {
        payload_kg: n as f64,
        mode: ModeValue {
            frequency_hz,
            damping_ratio,
        },
        unix_time_s: 0.0,
    };
    let joint = state.joints.entry("modes".into()).or_default();
    joint.modes = modes
        .iter()
        .enumerate()
        .map(|(n, (f, xi))| learned(n, *f, *xi))
        .collect();
    file.save(&state).expect("saved");
    let saved = std::fs::read(data.path().join("state.json")).expect("a state");
    // However often it is read before the next one is saved, it is kept once.
    for _ in 0..2 {
        let loaded = file.load(PERIOD);
        assert_eq!(loaded.last_move, 7);
        for (name, w, xi, sound) in maps {
            let left = loaded.joints[name]
                .map
                .as_ref()
                .expect("its sums are valid");
            let expected = map(w, xi).filter(|_| sound).unwrap_or(Memory {
                unexplained: 0.5,
                ..Memory::default()
            });
            assert_eq!(left, &expected, "{name}");
        }
        assert_eq!(loaded.joints["sums"].map, None);
        assert_eq!(loaded.joints["modes"].modes, vec![learned(0, 8.0, 0.03)]);
    }
    assert_eq!(
        std::fs::read(data.path().join("state.json.damaged")).expect("a file"),
        saved
    );
    assert!(!data.path().join("state.json.damaged.2").exists());
}
