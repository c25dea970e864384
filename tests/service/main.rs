//! The service as a whole: moves commanded, learned from, stopped, and remembered.

mod datagrams;
#[path = "../embedded/mod.rs"]
mod embedded;
mod faults;
mod guard;
mod missed;
mod process;
mod robot;
mod tick;

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::{Duration, Instant};

use quell::service::bridged::bridged;
use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::contract::{
    Accepted, Handle, ModeValue, MoveResult, Phase, Request, ServiceError, ShapingChange, Snapshot,
    Stopping, WatchdogState,
};
use quell::service::{Service, start};

use robot::{Received, UdpRobot};

const PERIOD: f64 = 0.001;
/// Longest that anything here is waited for.
const PATIENCE: Duration = Duration::from_secs(30);

/// The service's log, shown where a test fails.
fn log() {
    let log = tracing_subscriber::fmt().with_max_level(tracing::Level::DEBUG);
    // The first test of the process starts it.
    let _ = log.with_test_writer().try_init();
}

fn config(robot: RobotKind, data: &std::path::Path) -> Config {
    log();
    let overrides = Overrides {
        robot: Some(robot),
        data: Some(data.to_path_buf()),
        udp: Some(SocketAddr::from(([127, 0, 0, 1], 0))),
        ..Overrides::default()
    };
    let mut config = Config::load(None, &overrides).expect("defaults");
    // The tests of a machine shall not starve it.
    config.real_time = false;
    config
}

fn ask(handle: &Handle, request: Request) -> Result<Accepted, ServiceError> {
    let runtime = tokio::runtime::Builder::new_current_thread().build();
    runtime.expect("a runtime").block_on(handle.ask(request))
}

/// Takes a fault back, if there is one, and lets moves begin.
fn enable(handle: &Handle) {
    let since = Instant::now();
    loop {
        ask(handle, Request::Reset).expect("a reset");
        match ask(handle, Request::Enable) {
            Ok(_) => return,
            Err(error) => assert!(since.elapsed() < PATIENCE, "{error}"),
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn go(handle: &Handle, target: f64, shaper: Option<&str>) -> u64 {
    let request = Request::Move {
        joint: "joint_1".into(),
        target,
        shaper: shaper.map(Into::into),
    };
    match ask(handle, request).expect("the move is taken") {
        Accepted::Move { id, .. } => id,
        other => panic!("{other:?}"),
    }
}

/// Has the service believe in a mode that is 25 % beside the arm's.
fn mislead(handle: &Handle) {
    let change = ShapingChange {
        mode: Some(ModeValue {
            frequency_hz: 10.15,
            damping_ratio: 0.084,
        }),
        ..ShapingChange::default()
    };
    assert_eq!(ask(handle, Request::Shaping(change)), Ok(Accepted::Changed));
}

fn wait(handle: &Handle, what: &str, holds: impl Fn(&Snapshot) -> bool) -> Arc<Snapshot> {
    let since = Instant::now();
    loop {
        let snapshot = handle.snapshot();
        if holds(&snapshot) {
            return snapshot;
        }
        assert!(since.elapsed() < PATIENCE, "{what}: {snapshot:#?}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn phase_is(phase: Phase) -> impl Fn(&Snapshot) -> bool {
    move |snapshot| {
        snapshot
            .joints
            .first()
            .is_some_and(|joint| joint.phase == phase)
    }
}

fn result(handle: &Handle, id: u64) -> MoveResult {
    let of = |snapshot: &Snapshot| snapshot.moves.iter().find(|m| m.id == id).cloned();
    let snapshot = wait(handle, "the move ends", |snapshot| of(snapshot).is_some());
    of(&snapshot).expect("it was just there")
}

/// No jump and no limit exceeded between any two setpoints that were sent one after the other, over the
/// time that went by between them.
fn check(sent: &[Received], snapshot: &Snapshot) {
    let [velocity, acceleration, jerk] = snapshot.joints[0].limits;
    let allowed = 1.0 + 1e-9;
    for pair in sent
        .windows(2)
        .filter(|pair| pair[1].seq == pair[0].seq + 1)
    {
        let [before, now] = [pair[0], pair[1]];
        assert!(now.velocity.abs() <= velocity * allowed, "{pair:?}");
        assert!(now.acceleration.abs() <= acceleration * allowed, "{pair:?}");
        let periods = ((now.t - before.t) / PERIOD).round();
        let gone = periods * PERIOD;
        let way = now.position - before.position;
        if periods as u64 > bridged(PERIOD) + 1 {
            // The robot has stopped meanwhile, and is led on from there.
            assert!(way.abs() <= jerk * PERIOD.powi(3), "{pair:?}");
            continue;
        }
        let change = (now.acceleration - before.acceleration) / gone;
        // Rounding of accelerations over a tick of 1 ms.
        assert!(
            change.abs() <= jerk * allowed + 1e-6,
            "jerk {change}: {pair:?}"
        );
        let mean = 0.5 * (before.velocity + now.velocity);
        let jump = way - gone * mean;
        // The trapezoidal rule's error where the jerk is bounded, and that of velocities between two samples.
        let bound = allowed * jerk * gone.powi(3) * (1.0 / 12.0 + 1.0 / 8.0) + 1e-14;
        assert!(
            jump.abs() <= bound,
            "the position jumps by {jump}: {pair:?}"
        );
    }
}

/// Whether by the stamps ticks were missed for so long that the robot has stopped meanwhile.
fn has_stood(sent: &[Received]) -> bool {
    let long = (bridged(PERIOD) as f64 + 1.5) * PERIOD;
    sent.windows(2).any(|pair| pair[1].t - pair[0].t > long)
}

fn udp(data: &std::path::Path) -> (Service, Handle, UdpRobot) {
    let service = start(config(RobotKind::Udp, data)).expect("a service");
    let address = service.udp_address().expect("a UDP link");
    let robot = UdpRobot::start(address, PERIOD);
    let handle = service.handle();
    wait(&handle, "the joint is commanded", phase_is(Phase::Rest));
    enable(&handle);
    (service, handle, robot)
}

#[test]
fn a_robot_over_udp_is_commanded_without_a_jump() {
    let data = tempfile::tempdir().expect("a folder");
    let (service, handle, robot) = udp(data.path());
    let unshaped = go(&handle, 0.5, Some("none"));
    let all = result(&handle, unshaped).residual_rad.expect("measured");
    for target in [0.0, 0.5] {
        let id = go(&handle, target, None);
        let moved = result(&handle, id);
        assert_eq!(moved.target_rad, target);
        assert_eq!(robot.last().map(|last| last.position), Some(target));
    }
    let last = handle.snapshot().moves.last().cloned().expect("a move");
    let left = last.residual_rad.expect("measured");
    // A gap that is too long to be made up for stops the robot, and that rings.
    if has_stood(&robot.received.lock().expect("no panic")) {
        println!(
            "ticks were missed for too long: what is left, {left:e} of {all:e}, is not judged"
        );
    } else {
        assert!(left <= 0.03 * all, "left {left:e} of {all:e}");
    }

    // Another target in mid-move, then a stop.
    let interrupted = go(&handle, -0.5, None);
    wait(&handle, "it moves", |snapshot| {
        snapshot.joints[0].command_rad_s < -0.5
    });
    let next = go(&handle, 0.8, None);
    assert!(result(&handle, interrupted).interrupted);
    wait(&handle, "it moves on", |snapshot| {
        snapshot.joints[0].command_rad_s > 0.5
    });
    let asked = handle.snapshot().unix_time_s;
    let stop = |handle| match ask(handle, Request::Stop).expect("a stop") {
        Accepted::Stop { duration_s, joints } => (duration_s, joints),
        other => panic!("{other:?}"),
    };
    let (duration, joints) = stop(&handle);
    let expected = Stopping {
        joint: "joint_1".into(),
        duration_s: Some(duration),
    };
    assert_eq!(joints, [expected]);
    let next = result(&handle, next);
    // It did not rest before it was said to; a busy machine may have stopped it later.
    let took = next.unix_time_s + next.duration_s - asked;
    assert!(
        duration > 0.0 && took >= 0.9 * duration,
        "{took} s, said {duration}"
    );
    assert_eq!(stop(&handle), (0.0, Vec::new()), "nothing moves any more");
    // No length is told of a joint whose arc nobody has described.
    let mut stream = handle.stream();
    let row = loop {
        // The next batch; a reader that is late loses some.
        match stream.blocking_recv() {
            Ok(batch) => match batch.ticks.last() {
                Some(row) => break *row,
                None => continue,
            },
            Err(error) => println!("{error}"),
        }
    };
    assert!(
        row.deformation.is_finite() && row.tip_deformation.is_nan(),
        "{row:?}"
    );
    assert!(next.interrupted && next.target_rad != 0.8, "{next:?}");

    let snapshot = handle.snapshot();
    check(&robot.received.lock().expect("no panic"), &snapshot);
    let link = &snapshot.link;
    let counted = [
        link.lost,
        link.doubled,
        link.reordered,
        link.malformed,
        link.unknown_joint,
    ];
    assert!(counted.iter().all(|count| *count > 0), "{link:?}");
    assert!(snapshot.tick.ticks > 1000 && snapshot.tick.records_lost == 0);

    // The end of the service in mid-move is a stop, too. It is far, so that it still moves on a busy machine.
    wait(&handle, "it rests", phase_is(Phase::Rest));
    go(&handle, -6.0, None);
    wait(&handle, "it moves", |snapshot| {
        snapshot.joints[0].command_rad_s < -0.5
    });
    service.stop();
    std::thread::sleep(Duration::from_millis(20));
    let end = robot.last().expect("setpoints");
    assert!(
        end.velocity == 0.0 && end.acceleration == 0.0 && end.position > -6.0,
        "{end:?}"
    );
    check(&robot.received.lock().expect("no panic"), &snapshot);
}

#[test]
fn a_robot_that_falls_silent_is_stopped() {
    let data = tempfile::tempdir().expect("a folder");
    let (_service, handle, robot) = udp(data.path());
    let id = go(&handle, 1.5, None);
    std::thread::sleep(Duration::from_millis(100));
    robot.be_silent(true);
    let stopped = |snapshot: &Snapshot| snapshot.joints[0].watchdog == WatchdogState::Stopped;
    let snapshot = wait(&handle, "the watchdog", stopped);
    assert!(snapshot.joints[0].adaptation_frozen);
    wait(&handle, "it rests", phase_is(Phase::Rest));
    assert!(result(&handle, id).interrupted);
    robot.be_silent(false);
    wait(&handle, "it is heard again", |snapshot| {
        snapshot.joints[0].watchdog == WatchdogState::Fine && !snapshot.joints[0].adaptation_frozen
    });
    check(
        &robot.received.lock().expect("no panic"),
        &handle.snapshot(),
    );
    let refused = ask(
        &handle,
        Request::Move {
            joint: "joint_1".into(),
            target: 0.0,
            shaper: None,
        },
    );
    assert!(matches!(refused, Err(ServiceError::NotEnabled { .. })));
    enable(&handle);
    let id = go(&handle, 0.0, None);
    assert_eq!(result(&handle, id).target_rad, 0.0);
}

#[test]
fn requests_that_make_no_sense_change_nothing() {
    let data = tempfile::tempdir().expect("a folder");
    let service = start(config(RobotKind::Embedded, data.path())).expect("a service");
    let handle = service.handle();
    wait(&handle, "the joint is commanded", phase_is(Phase::Rest));
    enable(&handle);
    let to = |joint: &str, target: f64, shaper: Option<&str>| {
        let request = Request::Move {
            joint: joint.into(),
            target,
            shaper: shaper.map(Into::into),
        };
        ask(&handle, request).expect_err("refused").to_string()
    };
    assert!(to("elbow", 0.0, None).contains("joint_1"));
    assert!(to("joint_1", f64::NAN, None).contains("NaN"));
    assert!(to("joint_1", 400_f64.to_radians(), None).contains("deg is 400"));
    assert!(to("joint_1", 0.5, Some("zzz")).contains("zvd"));
    let nothing = ask(&handle, Request::Shaping(ShapingChange::default()));
    assert_eq!(nothing, Err(ServiceError::Nothing));
    for mass in [-1.0, 1e300] {
        assert!(ask(&handle, Request::Payload { mass }).is_err());
    }
    let none = Request::MoveTogether {
        targets: Vec::new(),
        shaper: None,
        tolerance: None,
    };
    assert_eq!(ask(&handle, none), Err(ServiceError::NoJoints));
    let jog = Request::Jog {
        joint: "joint_1".into(),
        velocity: 2000_f64.to_radians(),
        hold: 1,
    };
    let refused = ask(&handle, jog).expect_err("refused").to_string();
    assert!(refused.contains("deg/s is 2000"), "{refused}");
    assert_eq!(handle.snapshot().joints[0].move_id, 0);
}

/// Whoever stops the demonstration finds shaper and adaptation as they were.
#[test]
fn a_demonstration_that_is_stopped_leaves_what_it_found() {
    let data = tempfile::tempdir().expect("a folder");
    let service = start(config(RobotKind::Embedded, data.path())).expect("a service");
    let handle = service.handle();
    let before = wait(&handle, "it rests", |snapshot| {
        phase_is(Phase::Rest)(snapshot) && snapshot.joints[0].motor_rad.is_some()
    });
    let before = &before.joints[0];
    assert!(before.adaptation);
    std::thread::scope(|scope| {
        let demo = scope.spawn(|| {
            let runtime = tokio::runtime::Builder::new_current_thread()
                .enable_time()
                .build();
            let shown = quell::service::demo::run(&handle);
            runtime.expect("a runtime").block_on(shown)
        });
        wait(&handle, "it moves", |snapshot| {
            phase_is(Phase::Moving)(snapshot) && !snapshot.joints[0].adaptation
        });
        ask(&handle, Request::Stop).expect("a stop");
        assert_eq!(demo.join().expect("no panic"), Err(ServiceError::Stopped));
    });
    // Its own mode is learned anew, or has been.
    wait(&handle, "it is as it was", |snapshot| {
        let now = &snapshot.joints[0];
        (now.shaper, now.shaping, now.adaptation) == (before.shaper, before.shaping, true)
    });
}
