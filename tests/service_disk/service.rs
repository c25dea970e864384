//! The whole service on a disk that is full: required or not, state and recordings.

use std::net::SocketAddr;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};

use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::contract::{
    Accepted, DiskPart, DiskState, ErrorKind, Handle, Phase, Request, ServiceError, Snapshot,
};
use quell::service::disk::Disk;
use quell::service::recorder::Recorder;
use quell::service::{Service, start_on};

use super::faulty::Faulty;

/// Longest that anything here is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

struct Running {
    disk: Faulty,
    service: Service,
    handle: Handle,
    runtime: tokio::runtime::Runtime,
}

/// The embedded arm, whose moves must be recorded or need not, on a disk that works at first.
fn running(data: &Path, required: bool) -> Running {
    let overrides = Overrides {
        robot: Some(RobotKind::Embedded),
        data: Some(data.to_path_buf()),
        udp: Some(SocketAddr::from(([127, 0, 0, 1], 0))),
        ..Overrides::default()
    };
    let mut config = Config::load(None, &overrides).expect("defaults");
    config.real_time = false;
    config.recording.required = required;
    let disk = Faulty::new(|_, _| false);
    let opened = Disk::of(data, Arc::new(disk.clone())).expect("a free folder");
    let service = start_on(config, opened).expect("a service");
    let handle = service.handle();
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(1)
        .build()
        .expect("a runtime");
    let shelf = service.shelf().expect("a shelf");
    runtime.block_on(async { Recorder::start(&handle, shelf) });
    let running = Running {
        disk,
        service,
        handle,
        runtime,
    };
    running.wait("it is commanded", |s| s.joints[0].phase == Phase::Rest);
    running.wait("it is enabled", |_| running.ask(Request::Enable).is_ok());
    running
}

impl Running {
    fn wait(&self, what: &str, holds: impl Fn(&Snapshot) -> bool) -> Arc<Snapshot> {
        let since = Instant::now();
        loop {
            let snapshot = self.handle.snapshot();
            if !snapshot.joints.is_empty() && holds(&snapshot) {
                return snapshot;
            }
            assert!(since.elapsed() < PATIENCE, "{what}: {snapshot:#?}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    fn ask(&self, request: Request) -> Result<Accepted, ServiceError> {
        self.runtime.block_on(self.handle.ask(request))
    }

    fn go(&self, target: f64) -> Result<u64, ServiceError> {
        let joint = "joint_1".into();
        let shaper = None;
        match self.ask(Request::Move {
            joint,
            target,
            shaper,
        })? {
            Accepted::Move { id, .. } => Ok(id),
            other => panic!("{other:?}"),
        }
    }

    /// The name of a move's recording, once the move has ended.
    fn recording(&self, id: u64) -> Option<String> {
        let of = |s: &Snapshot| s.moves.iter().find(|done| done.id == id).cloned();
        let snapshot = self.wait("the move ends", |s| of(s).is_some());
        of(&snapshot).and_then(|done| done.recording)
    }
}

fn failing(what: DiskPart) -> impl Fn(&Snapshot) -> bool {
    move |snapshot| snapshot.disk.faults.iter().any(|fault| fault.what == what)
}

fn fine(snapshot: &Snapshot) -> bool {
    snapshot.disk.state == DiskState::Fine
}

#[test]
fn where_recordings_are_required_no_move_begins_without_one() {
    let data = tempfile::tempdir().expect("a folder");
    let running = running(data.path(), true);
    let recordings = data.path().join("recordings");
    running
        .disk
        .refuse(move |_, path| path.starts_with(&recordings));
    // That the disk is full is known once something was to be written; that move goes on.
    let first = running.go(0.5).expect("taken");
    running.wait("it is told", failing(DiskPart::Recordings));
    assert_eq!(running.recording(first), None);
    let error = running.go(0.0).expect_err("refused");
    assert_eq!(error.kind(), ErrorKind::Storage);
    let words = error.to_string();
    for word in ["recording.required", "recordings/", "no storage space"] {
        assert!(words.contains(word), "{word} in {words}");
    }
    // A stop is never refused.
    assert!(running.ask(Request::Stop).is_ok());
    // Nobody moves, and yet it is found out that there is room again.
    running.disk.refuse(|_, _| false);
    running.wait("it is fine again", fine);
    let next = running.go(0.0).expect("taken");
    running.recording(next);
    let snapshot = running.wait("it is named", |s| {
        s.moves.last().is_some_and(|done| done.recording.is_some())
    });
    let name = snapshot
        .moves
        .last()
        .and_then(|done| done.recording.clone());
    assert_eq!(name, Some(format!("move-{next:06}")));
    running.service.stop();
}

#[test]
fn a_state_that_cannot_be_kept_is_told_and_kept_later() {
    let data = tempfile::tempdir().expect("a folder");
    let running = running(data.path(), false);
    running
        .disk
        .refuse(|_, path| path.to_string_lossy().contains("state.json"));
    let first = running.go(0.5).expect("taken");
    running.recording(first);
    let snapshot = running.wait("it is told", failing(DiskPart::State));
    let fault = &snapshot.disk.faults[0];
    assert!(fault.reason.contains("state.json"), "{fault:?}");
    let kept = || {
        let text = std::fs::read(data.path().join("state.json")).unwrap_or_default();
        let state: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
        state["last_move"].as_u64()
    };
    assert_eq!(kept(), None);
    running.disk.refuse(|_, _| false);
    running.wait("it is fine again", fine);
    assert_eq!(kept(), Some(first));
    running.service.stop();
}

#[test]
fn a_folder_that_vanishes_is_told_and_not_made_anew() {
    let data = tempfile::tempdir().expect("a folder");
    let folder = data.path().join("mounted");
    let running = running(&folder, false);
    // As a medium that is pulled out.
    let away = data.path().join("away");
    std::fs::rename(&folder, &away).expect("it goes");
    let first = running.go(0.5).expect("moves go on");
    running.wait("both are told", |s| {
        failing(DiskPart::Recordings)(s) && failing(DiskPart::State)(s)
    });
    assert_eq!(running.recording(first), None);
    assert!(!folder.exists(), "nothing is written to where it was");
    std::fs::rename(&away, &folder).expect("it comes back");
    running.wait("it is fine again", fine);
    running.service.stop();
}
