//! A fault of the service: the engine takes another range for the joint's than the tick. The tick closes its gate.

use std::future::Future;
use std::path::Path;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use super::{RobotParts, Station};
use crate::service::clock::ServiceClock;
use crate::service::config::{Config, Overrides, RobotKind};
use crate::service::contract::{
    Accepted, EnableState, FaultKind, Handle, MoveEnd, Request, ServiceError,
};
use crate::service::disk::Disk;
use crate::service::recorder::Recorder;

/// Ticks that anything here takes at most.
const PATIENCE: usize = 20_000;
/// The tick lets commands be up to here, rad.
const HIGHEST: f64 = 0.4;

/// A station with the embedded arm, on a simulated clock.
fn station(data: &Path) -> Station {
    let overrides = Overrides {
        robot: Some(RobotKind::Embedded),
        data: Some(data.to_path_buf()),
        ..Overrides::default()
    };
    let mut config = Config::load(None, &overrides).expect("defaults");
    config.joints[0].range = [-HIGHEST, HIGHEST];
    let (clock, _) = ServiceClock::simulated(1e9);
    let robot = RobotParts::embedded(&config).expect("an arm");
    Station::assemble(config, clock, robot, Disk::default()).expect("a station")
}

fn step(station: &mut Station) {
    station.beat();
    station.work();
}

fn ask(station: &mut Station, handle: &Handle, request: Request) -> Result<Accepted, ServiceError> {
    let mut answer = pin!(handle.ask(request));
    let mut context = Context::from_waker(Waker::noop());
    for _ in 0..PATIENCE {
        if let Poll::Ready(answer) = answer.as_mut().poll(&mut context) {
            return answer;
        }
        step(station);
    }
    panic!("nobody answers")
}

fn to(target: f64) -> Request {
    Request::Move {
        joint: "joint_1".into(),
        target,
        shaper: None,
    }
}

#[test]
fn a_command_beyond_the_range_is_a_fault_that_brakes_and_is_told() {
    let data = tempfile::tempdir().expect("a folder");
    let mut station = station(data.path());
    let handle = station.handle();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build();
    let runtime = runtime.expect("a runtime");
    let recorder = {
        let _inside = runtime.enter();
        Recorder::start(&handle, station.shelf().expect("a shelf"))
    };
    (0..100).for_each(|_| step(&mut station));
    ask(&mut station, &handle, Request::Enable).expect("enabled");
    let refused = ask(&mut station, &handle, to(1.0)).expect_err("beyond the range");
    assert!(
        !matches!(refused, ServiceError::Faulted { .. }),
        "{refused}"
    );
    station.engine.mistake_range([-2.0, 2.0]);
    ask(&mut station, &handle, to(1.0)).expect("the engine does not know better");

    // The fault comes while it moves, and the brake ends in the range.
    let mut highest = f64::NEG_INFINITY;
    let mut tripped = None;
    for _ in 0..PATIENCE {
        step(&mut station);
        // The recorder takes what has come before it answers.
        assert!(runtime.block_on(recorder.end()).is_err());
        let snapshot = handle.snapshot();
        let joint = &snapshot.joints[0];
        highest = highest.max(joint.command_rad);
        if snapshot.enable.state == EnableState::Faulted && tripped.is_none() {
            tripped = Some(joint.command_rad_s);
        }
        if !snapshot.moves.is_empty() {
            break;
        }
    }
    assert!(
        tripped.is_some_and(|velocity| velocity > 0.0),
        "{tripped:?}"
    );

    // The reason is the same to whoever asks.
    let snapshot = handle.snapshot();
    let view = &snapshot.enable;
    assert_eq!(
        (view.fault, view.joint.as_deref()),
        (Some(FaultKind::Range), Some("joint_1"))
    );
    assert!(
        view.reason
            .starts_with("a command would have led joint_1 to "),
        "{}",
        view.reason
    );
    let done = snapshot.moves.last().expect("a move");
    assert_eq!((done.ended, done.interrupted), (Some(MoveEnd::Fault), true));
    assert_eq!(done.fault.as_deref(), Some(&*view.reason));
    let refused = ask(&mut station, &handle, to(0.0)).expect_err("a fault");
    assert!(refused.to_string().contains(&view.reason), "{refused}");

    // What was recorded of it is on the shelf.
    for _ in 0..4000 {
        step(&mut station);
        assert!(runtime.block_on(recorder.end()).is_err());
        highest = highest.max(handle.snapshot().joints[0].command_rad);
    }
    let snapshot = handle.snapshot();
    let joint = &snapshot.joints[0];
    assert!(
        joint.command_rad_s == 0.0 && highest > 0.0 && highest <= HIGHEST + 1e-9,
        "{highest}: {joint:?}"
    );
    let named = snapshot.moves[0].recording.clone().expect("a recording");
    let shelved = recorder.shelf().list().expect("a shelf");
    assert!(shelved.iter().any(|entry| entry.name == named), "{named}");

    // Reset and enabled, it goes where it may.
    station.engine.mistake_range([-HIGHEST, HIGHEST]);
    ask(&mut station, &handle, Request::Reset).expect("reset");
    ask(&mut station, &handle, Request::Enable).expect("enabled");
    ask(&mut station, &handle, to(0.0)).expect("a move");
}
