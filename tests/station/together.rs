//! Several joints in one move: they begin with one tick, end with one tick, and all move or none.

use std::pin::Pin;
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Waker};

use quell::service::clock::ServiceClock;
use quell::service::contract::{
    Accepted, Handle, LinkHealth, Measured, ModeValue, Phase, Quantity, Request, ServiceError,
    ShapingChange, Target,
};
use quell::service::disk::Disk;
use quell::service::link::RobotLink;
use quell::service::station::{RobotParts, Station};
use quell::tolerance::Tolerance;
use quell_shapers::Setpoint;

use super::world::{LIMITS, PERIOD, config};

const JOINTS: usize = 3;

/// The positions of motor sides that follow at once, and all setpoints: tick, joint, setpoint.
#[derive(Default)]
struct Arm {
    positions: [f64; JOINTS],
    sent: Vec<(f64, usize, Setpoint)>,
    silent: Option<usize>,
}

struct Wire(Arc<Mutex<Arm>>);

impl RobotLink for Wire {
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>) {
        let arm = self.0.lock().expect("no panic");
        let heard = (0..JOINTS).filter(|joint| arm.silent != Some(*joint));
        inbox.extend(heard.map(|joint| Measured {
            received: now,
            stamp: now,
            joint,
            quantity: Quantity::MotorPosition,
            value: [arm.positions[joint], 0.0, 0.0],
            refused: false,
        }));
    }

    fn carries_time(&self) -> bool {
        true
    }

    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint) {
        let mut arm = self.0.lock().expect("no panic");
        arm.positions[joint] = setpoint.position;
        arm.sent.push((now, joint, *setpoint));
    }

    fn counters(&self) -> LinkHealth {
        LinkHealth::default()
    }
}

type Answer = Result<Accepted, ServiceError>;

struct Bench {
    station: Station,
    handle: Handle,
    arm: Arc<Mutex<Arm>>,
    _data: tempfile::TempDir,
}

impl Bench {
    /// Joints of unlike modes, which are shaped by trains of unlike lengths.
    fn new() -> Self {
        let data = tempfile::tempdir().expect("a folder");
        let mut config = config(data.path());
        let one = config.joints[0].clone();
        config.joints = (0..JOINTS)
            .map(|index| {
                let mut joint = one.clone();
                joint.name = format!("joint_{}", index + 1);
                joint
            })
            .collect();
        let (clock, _) = ServiceClock::simulated(1e9);
        let arm: Arc<Mutex<Arm>> = Arc::default();
        let robot = RobotParts::over(Box::new(Wire(Arc::clone(&arm))));
        let station = Station::assemble(config, clock, robot, Disk::default());
        let station = station.expect("a station");
        let mut bench = Self {
            handle: station.handle(),
            station,
            arm,
            _data: data,
        };
        bench.steps(100);
        for (index, frequency_hz) in [6.0, 9.0, 14.0].into_iter().enumerate() {
            let change = ShapingChange {
                joint: Some(format!("joint_{}", index + 1)),
                mode: Some(ModeValue {
                    frequency_hz,
                    damping_ratio: 0.05,
                }),
                ..ShapingChange::default()
            };
            assert_eq!(bench.ask(Request::Shaping(change)), Ok(Accepted::Changed));
        }
        bench.ask(Request::Enable).expect("enabled");
        bench.steps(100);
        bench
    }

    fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.station.beat();
            self.station.work();
        }
    }

    fn begin(&self, request: Request) -> Pin<Box<dyn Future<Output = Answer>>> {
        let handle = self.handle.clone();
        let mut answer = Box::pin(async move { handle.ask(request).await });
        let mut context = Context::from_waker(Waker::noop());
        assert!(answer.as_mut().poll(&mut context).is_pending());
        answer
    }

    fn ask(&mut self, request: Request) -> Answer {
        let mut answer = self.begin(request);
        let mut context = Context::from_waker(Waker::noop());
        for _ in 0..1000 {
            self.steps(1);
            if let Poll::Ready(answer) = answer.as_mut().poll(&mut context) {
                return answer;
            }
        }
        panic!("nobody answers")
    }

    /// Sets out for these targets.
    fn go(&mut self, targets: &[f64]) -> Answer {
        self.ask(together(targets, None))
    }

    /// First and last time at which the command of a joint changes, and the largest share of a limit.
    fn span(&self, joint: usize) -> Option<([f64; 2], f64)> {
        let arm = self.arm.lock().expect("no panic");
        let own: Vec<_> = arm.sent.iter().filter(|sent| sent.1 == joint).collect();
        let changes = own
            .windows(2)
            .filter(|pair| pair[0].2.position != pair[1].2.position);
        let times: Vec<_> = changes.map(|pair| pair[1].0).collect();
        let share = own.iter().map(|(_, _, setpoint)| {
            let velocity = setpoint.velocity.abs() / LIMITS.velocity;
            velocity.max(setpoint.acceleration.abs() / LIMITS.acceleration)
        });
        Some(([*times.first()?, *times.last()?], share.fold(0.0, f64::max)))
    }
}

fn together(targets: &[f64], residual: Option<f64>) -> Request {
    let targets = targets.iter().enumerate().map(|(index, &target)| Target {
        joint: format!("joint_{}", index + 1),
        target,
    });
    Request::MoveTogether {
        targets: targets.collect(),
        shaper: None,
        tolerance: residual.map(|residual| Tolerance {
            residual: Some(residual),
            deviation: None,
        }),
    }
}

/// On a straight line, faster than with trains, within the limits, to the exact end.
#[test]
fn several_joints_move_within_a_tolerance() {
    let mut bench = Bench::new();
    let targets = [1.5, 0.4, -0.7];
    let Ok(Accepted::Together { duration_s, .. }) = bench.go(&targets) else {
        panic!("refused");
    };
    bench.steps(800);
    bench.go(&[0.0; JOINTS]).expect("a move");
    bench.steps(800);
    bench.arm.lock().expect("no panic").sent.clear();
    let within = bench.ask(together(&targets, Some(0.05)));
    let Ok(Accepted::Together {
        moves,
        duration_s: fast,
    }) = within
    else {
        panic!("{within:?}");
    };
    assert_eq!(moves.len(), JOINTS);
    assert!(fast < duration_s, "{fast} {duration_s}");
    bench.steps(800);
    let arm = bench.arm.lock().expect("no panic");
    assert_eq!(arm.positions, targets);
    for tick in arm.sent.chunks(JOINTS) {
        for (_, joint, setpoint) in tick {
            let share = setpoint.position / targets[*joint];
            let first = tick[0].2.position / targets[0];
            assert!((share - first).abs() < 1e-9, "{tick:?}");
            assert!(setpoint.velocity.abs() <= LIMITS.velocity * (1.0 + 1e-9));
            assert!(setpoint.acceleration.abs() <= LIMITS.acceleration * (1.0 + 1e-9));
        }
    }
}

/// At no feed nothing moves, nor does what had been asked for before when there is feed again.
#[test]
fn a_move_that_is_being_solved_does_not_survive_a_feed_of_none() {
    let mut bench = Bench::new();
    let mut asked = bench.begin(together(&[1.0, 1.0, 1.0], Some(0.05)));
    bench.station.answer();
    let _none = bench.begin(Request::Feed { share: 0.0 });
    let _full = bench.begin(Request::Feed { share: 1.0 });
    bench.station.answer();
    bench.steps(500);
    let mut context = Context::from_waker(Waker::noop());
    let answer = asked.as_mut().poll(&mut context);
    assert!(matches!(answer, Poll::Ready(Err(_))), "{answer:?}");
    assert_eq!(bench.arm.lock().expect("no panic").positions, [0.0; JOINTS]);
}

#[test]
fn they_begin_and_end_together_whatever_their_trains() {
    let mut bench = Bench::new();
    for targets in [[1.5, 0.1, -0.7], [0.0, 0.11, 0.02], [0.3, -1.0, 0.02]] {
        bench.arm.lock().expect("no panic").sent.clear();
        let Ok(Accepted::Together { moves, duration_s }) = bench.go(&targets) else {
            panic!("refused");
        };
        assert_eq!(moves.len(), JOINTS);
        bench.steps(800);
        let moving = (0..JOINTS).filter_map(|joint| bench.span(joint));
        let spans: Vec<_> = moving.collect();
        let (first, share) = spans[0];
        assert!(spans.len() >= 2 && share <= 1.0 + 1e-9);
        for (span, share) in &spans {
            // A plan ends between two ticks, and its last change may be below what a number shows.
            let apart = [span[0] - first[0], span[1] - first[1]];
            assert!(apart.iter().all(|by| by.abs() < 2.5 * PERIOD), "{spans:?}");
            assert!(*share <= 1.0 + 1e-9, "{spans:?}");
            let took = span[1] - span[0];
            assert!(
                (took - duration_s).abs() < 3.0 * PERIOD,
                "{took} {duration_s}"
            );
        }
        assert_eq!(bench.arm.lock().expect("no panic").positions, targets);
        let phases = bench.handle.snapshot();
        assert!(phases.joints.iter().all(|joint| joint.phase == Phase::Rest));
    }
}

/// A change of the feed on the way is that of all: they end with one tick still.
#[test]
fn they_follow_the_feed_together() {
    let mut bench = Bench::new();
    let targets = [1.5, 0.4, -0.7];
    bench.go(&targets).expect("a move");
    for share in [0.3, 0.8] {
        bench.steps(40);
        bench.ask(Request::Feed { share }).expect("a feed");
    }
    bench.steps(800);
    let spans: Vec<_> = (0..JOINTS).filter_map(|joint| bench.span(joint)).collect();
    for (span, share) in &spans {
        let apart = [0, 1].map(|end| span[end] - spans[0].0[end]);
        // The last changes of a slow plan are below what a number shows for longer.
        assert!(apart.iter().all(|by| by.abs() < 4.5 * PERIOD), "{spans:?}");
        assert!(*share <= 1.0 + 1e-9, "{spans:?}");
    }
    assert_eq!(bench.arm.lock().expect("no panic").positions, targets);
}

#[test]
fn none_moves_where_one_cannot() {
    let mut bench = Bench::new();
    let before = bench.arm.lock().expect("no panic").positions;
    let twice = Request::MoveTogether {
        targets: vec![
            Target {
                joint: "joint_1".into(),
                target: 0.1,
            };
            2
        ],
        shaper: None,
        tolerance: None,
    };
    assert!(matches!(bench.ask(twice), Err(ServiceError::Twice { .. })));
    assert!(matches!(
        bench.go(&[0.1, 100.0]),
        Err(ServiceError::Value { .. })
    ));
    // One of them moves already.
    let alone = Request::Move {
        joint: "joint_3".into(),
        target: 0.5,
        shaper: None,
    };
    bench.ask(alone).expect("a move");
    assert!(matches!(
        bench.go(&[0.1, 0.1, 0.1]),
        Err(ServiceError::InMotion { .. })
    ));
    bench.steps(400);
    // A stop comes before they could begin.
    let targets = ["joint_1", "joint_2"].map(|joint| Target {
        joint: joint.into(),
        target: 0.4,
    });
    let mut asked = bench.begin(Request::MoveTogether {
        targets: targets.to_vec(),
        shaper: None,
        tolerance: None,
    });
    bench.station.answer();
    // Before a tick has seen the plans.
    let _disabled = bench.begin(Request::Disable);
    bench.station.answer();
    bench.steps(300);
    let mut context = Context::from_waker(Waker::noop());
    let Poll::Ready(Err(_)) = asked.as_mut().poll(&mut context) else {
        panic!("it is refused");
    };
    let after = bench.arm.lock().expect("no panic").positions;
    assert_eq!(after, [before[0], before[1], 0.5]);
}

/// A fault of one joint ends the move of all.
#[test]
fn a_joint_that_falls_silent_stops_the_others() {
    let mut bench = Bench::new();
    bench.go(&[2.0, 2.0, 2.0]).expect("a move");
    bench.steps(60);
    bench.arm.lock().expect("no panic").silent = Some(1);
    bench.steps(300);
    let view = bench.handle.snapshot().enable.clone();
    assert_eq!(view.joint.as_deref(), Some("joint_2"), "{view:?}");
    let arm = bench.arm.lock().expect("no panic");
    let last = &arm.sent[arm.sent.len() - JOINTS..];
    for (_, joint, setpoint) in last {
        assert!(
            setpoint.velocity == 0.0 && setpoint.position < 1.9,
            "{joint}"
        );
    }
}

/// However it ends, a move on a straight line ends on it: none is further on its way than the others, and none goes beyond.
#[test]
fn a_move_on_a_straight_line_is_stopped_on_it() {
    type Ends = fn(&mut Bench);
    let ends: [Ends; 4] = [
        |bench| drop(bench.ask(Request::Stop)),
        |bench| drop(bench.ask(Request::Disable)),
        |bench| drop(bench.ask(Request::Feed { share: 0.0 })),
        |bench| bench.arm.lock().expect("no panic").silent = Some(1),
    ];
    let targets = [1.5, 0.4, -0.7];
    for (end, after) in ends
        .iter()
        .flat_map(|end| [20, 60, 110].map(|after| (end, after)))
    {
        let mut bench = Bench::new();
        let begun = bench.ask(together(&targets, Some(0.05)));
        assert!(matches!(begun, Ok(Accepted::Together { .. })), "{begun:?}");
        bench.steps(after);
        end(&mut bench);
        bench.steps(300);
        let arm = bench.arm.lock().expect("no panic");
        let mut last = [Setpoint::default(); JOINTS];
        for (time, joint, setpoint) in &arm.sent {
            let before = std::mem::replace(&mut last[*joint], *setpoint);
            let jump = setpoint.position - before.position;
            assert!(
                jump.abs() < 1.01 * LIMITS.velocity * PERIOD,
                "{time}: {jump}"
            );
            assert!(setpoint.acceleration.abs() <= LIMITS.acceleration * (1.0 + 1e-9));
        }
        for tick in arm.sent.chunks(JOINTS) {
            let shares = tick
                .iter()
                .map(|(_, joint, setpoint)| setpoint.position / targets[*joint]);
            let shares: Vec<_> = shares.collect();
            assert!((0.0..1.0).contains(&shares[0]), "after {after}: {tick:?}");
            let apart = shares.iter().map(|share| (share - shares[0]).abs());
            assert!(apart.fold(0.0, f64::max) < 1e-9, "after {after}: {tick:?}");
        }
        assert!(last.iter().all(|setpoint| setpoint.velocity == 0.0));
    }
}
