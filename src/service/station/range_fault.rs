//! A fault of the service: the engine takes another range for the joint's than the tick. The tick closes its gate.

use std::future::Future;
use std::path::Path;
use std::pin::pin;
use std::sync::Arc;
use std::task::{Context, Poll, Waker};

use quell_trajectories::Limits;
use tokio::sync::broadcast::Receiver;

use super::{RobotParts, Station};
use crate::service::clock::ServiceClock;
use crate::service::config::{Config, Overrides, RobotKind};
use crate::service::contract::{
    Accepted, Batch, EnableState, FaultKind, Handle, MoveEnd, Request, ServiceError,
};
use crate::service::disk::Disk;
use crate::service::recorder::Recorder;

/// Ticks that anything here takes at most.
const PATIENCE: usize = 20_000;
/// The tick lets commands be up to here, rad.
const HIGHEST: f64 = 0.4;

/// A station with the embedded arm, on a simulated clock, and the most by which a control period can move the position
/// at which a command turns if it brakes, rad.
///
/// With the jerk `-J` for `t = (A + a) / J`, then `-A`, it turns at `x + v t + a t^2 / 2 - J t^3 / 6 + h^2 / 2 A`, where
/// `h = v + (a^2 - A^2) / 2 J`. The rate of this is `v + (t + h / A) a + (v + t a + h a / A) j / J`: where
/// `a <= A`, `j <= J` and `h <= v <= V` at most `4 V + 4 A^2 / J`.
fn station(data: &Path) -> (Station, f64) {
    let overrides = Overrides {
        robot: Some(RobotKind::Embedded),
        data: Some(data.to_path_buf()),
        ..Overrides::default()
    };
    let mut config = Config::load(None, &overrides).expect("defaults");
    config.joints[0].range = [-HIGHEST, HIGHEST];
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = config.joints[0].limits;
    let turns = 4.0 * (velocity + acceleration.powi(2) / jerk) * config.period;
    let (clock, _) = ServiceClock::simulated(1e9);
    let robot = RobotParts::embedded(&config).expect("an arm");
    let station = Station::assemble(config, clock, robot, Disk::default());
    (station.expect("a station"), turns)
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

/// The highest command of the ticks that have come, rad.
fn highest_of(stream: &mut Receiver<Arc<Batch>>) -> f64 {
    let batches = std::iter::from_fn(|| stream.try_recv().ok());
    let highest = |batch: Arc<Batch>| {
        let positions = batch.ticks.iter().map(|row| row.position);
        positions.fold(f64::NEG_INFINITY, f64::max)
    };
    batches.map(highest).fold(f64::NEG_INFINITY, f64::max)
}

#[test]
fn a_command_beyond_the_range_is_a_fault_that_brakes_and_is_told() {
    let data = tempfile::tempdir().expect("a folder");
    let (mut station, nearest) = station(data.path());
    let handle = station.handle();
    let mut stream = handle.stream();
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
        highest = highest.max(highest_of(&mut stream));
        let snapshot = handle.snapshot();
        let joint = &snapshot.joints[0];
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
        highest = highest.max(highest_of(&mut stream));
    }
    // It turns within the range. The command after the last that was admitted would have turned beyond: so it turns as
    // near to the end as a control period can move that.
    let snapshot = handle.snapshot();
    let joint = &snapshot.joints[0];
    assert_eq!(joint.command_rad_s, 0.0);
    assert!(
        (HIGHEST - nearest..=HIGHEST + 1e-9).contains(&highest),
        "{highest}: {nearest} {joint:?}"
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
