//! New targets in motion and jogs, once the modes are known: the trains are those of their ways.

use quell::service::between::inexact;
use quell::service::contract::{Phase, Request, ShapingChange};

use super::modes::{JERK, go, posed, run, settings_of, two, world, world_of};
use super::plant::PlantMode;
use super::world::{LIMITS, PERIOD, Sent, World};

/// Ticks after which the target changes: the arm is fast then.
const TURNED: usize = 80;

fn to(degrees: f64) -> Request {
    Request::Move {
        joint: "joint_1".into(),
        target: degrees.to_radians(),
        shaper: None,
    }
}

/// Moves that teach.
fn taught(data: &std::path::Path, modes: &[PlantMode]) -> World {
    let mut world = world(data, 9.0, modes);
    for degrees in [40.0_f64, 0.0, 50.0, 0.0] {
        go(&mut world, degrees.to_radians(), None);
    }
    world
}

/// The same arm and moves, and what is said of shaping.
fn said(data: &std::path::Path, modes: &[PlantMode], change: ShapingChange) -> World {
    let mut world = world(data, 9.0, modes);
    world.ask(Request::Shaping(change));
    world.steps(10);
    world
}

/// Peak of the true deformation after a move to 50 degrees that is sent elsewhere on its way, rad.
fn turned(world: &mut World, degrees: f64) -> f64 {
    let before = world.sent().len();
    world.ask(to(50.0));
    world.steps(TURNED);
    assert_eq!(world.joint().phase, Phase::Moving);
    let target = degrees.to_radians();
    let (_, left) = run(world, to(degrees), target);
    within_limits(&world.sent().split_off(before), target);
    go(world, 0.0, None);
    left
}

/// Limits are kept, and the end is the target to the bit.
fn within_limits(sent: &[Sent], target: f64) {
    assert_eq!(sent.last().map(|sent| sent.1.position), Some(target));
    for pair in sent.windows(2) {
        let [before, now] = [pair[0].1, pair[1].1];
        let jerk = (now.acceleration - before.acceleration) / PERIOD;
        let peaks = [
            now.velocity / LIMITS.velocity,
            now.acceleration / LIMITS.acceleration,
            jerk / JERK,
        ];
        assert!(
            peaks.iter().all(|peak| peak.abs() < 1.0 + 1e-6),
            "{peaks:?}"
        );
    }
}

#[test]
fn a_new_target_in_motion_is_shaped_for_its_way() {
    // One way to a target may suit a wrong train by chance.
    let targets = [
        [20.0, 35.0, 5.0],
        [25.0, 40.0, 10.0],
        [30.0, 12.0, 45.0],
        [10.0, 50.0, 20.0],
        [40.0, 22.0, 8.0],
        [15.0, 28.0, 42.0],
    ];
    for modes in [two().to_vec(), vec![posed()]] {
        let mut sums = [0.0; 3];
        for targets in targets {
            let left = left_of(&modes, targets);
            assert!(left[0] < 0.05 * left[2], "{targets:?}: {left:?}");
            for (sum, left) in sums.iter_mut().zip(left) {
                *sum += left;
            }
        }
        assert!(sums[0] < sums[1], "{sums:?}");
    }
}

/// What moves to targets, each given in motion, leave in all: with what was learned, with the fixed train of the belief, unshaped.
fn left_of(modes: &[PlantMode], targets: [f64; 3]) -> [f64; 3] {
    let folders = [(); 3].map(|()| tempfile::tempdir().expect("a folder"));
    let mut learned = taught(folders[0].path(), modes);
    let fixed = ShapingChange {
        adaptation: Some(false),
        ..ShapingChange::default()
    };
    let mut fixed = said(folders[1].path(), modes, fixed);
    let none = ShapingChange {
        enabled: Some(false),
        ..ShapingChange::default()
    };
    let mut unshaped = said(folders[2].path(), modes, none);
    let (mut sums, corrections) = ([0.0; 3], learned.joint().corrections);
    for degrees in targets {
        let left = [&mut learned, &mut fixed, &mut unshaped].map(|w| turned(w, degrees));
        for (sum, left) in sums.iter_mut().zip(left) {
            *sum += left;
        }
    }
    let corrected = learned.joint().corrections - corrections;
    println!("{targets:?}: {sums:?} rad, {corrected} corrections in motion");
    sums
}

/// Nothing is known of the joint but a wrong belief: its samples say on the way that two modes ring.
#[test]
fn two_modes_are_retuned_for_in_the_first_move() {
    let folders = [(); 3].map(|()| tempfile::tempdir().expect("a folder"));
    let fixed = ShapingChange {
        adaptation: Some(false),
        ..ShapingChange::default()
    };
    let none = ShapingChange {
        enabled: Some(false),
        ..ShapingChange::default()
    };
    let mut learned = world(folders[0].path(), 9.0, &two());
    let mut fixed = said(folders[1].path(), &two(), fixed);
    let mut unshaped = said(folders[2].path(), &two(), none);
    let target = 50_f64.to_radians();
    let left = [&mut learned, &mut fixed, &mut unshaped].map(|w| go(w, target, None).1);
    println!("{left:?} rad, {} corrections", learned.joint().corrections);
    assert!(learned.joint().corrections > 0);
    assert!(left[0] < 0.05 * left[2] && left[0] < left[1], "{left:?}");
    within_limits(&learned.sent(), target);
}

/// Held for half a second and let go of, at places all over the range.
#[test]
fn a_jog_is_shaped_for_wherever_it_ends() {
    let folders = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let mut learned = taught(folders[0].path(), &[posed()]);
    let none = ShapingChange {
        enabled: Some(false),
        ..ShapingChange::default()
    };
    let mut unshaped = said(folders[1].path(), &[posed()], none);
    let mut sums = [0.0; 2];
    for (press, tenths) in [(1, 5), (2, 8), (3, 3)] {
        for (sum, world) in sums.iter_mut().zip([&mut learned, &mut unshaped]) {
            *sum += jogged(world, press, tenths);
        }
    }
    println!("{sums:?} rad");
    assert!(sums[0] < 0.05 * sums[1], "{sums:?}");
}

/// Peak of the true deformation once the motor side stands, rad.
fn jogged(world: &mut World, press: u64, tenths: usize) -> f64 {
    let word = |velocity| Request::Jog {
        joint: "joint_1".into(),
        velocity,
        hold: press,
    };
    for _ in 0..tenths {
        world.ask(word(0.6));
        world.steps((0.1 / PERIOD) as usize);
    }
    world.ask(word(0.0));
    let mut trace = Vec::new();
    for _ in 0..(2.0 / PERIOD) as usize {
        world.step();
        let arm = world.robot.arm.as_ref().expect("an arm");
        trace.push((arm.motor(), arm.deformation()));
    }
    assert_eq!(world.joint().phase, Phase::Rest);
    let last = trace[trace.len() - 1].0;
    let away = |(motor, _): &(f64, f64)| (motor - last).abs() > 1e-6;
    let end = trace.iter().rposition(away).map_or(0, |k| k + 1);
    trace[end..]
        .iter()
        .fold(0.0, |peak: f64, one| peak.max(one.1.abs()))
}

/// A correction swings around a target that is the end of the range, and leaves less to a stop and to a new target.
#[test]
fn corrections_and_orders_on_the_way_stay_in_the_range() {
    let end = 40_f64.to_radians();
    let mut corrections = 0;
    for ticks in (20..260).step_by(20) {
        for order in [None, Some(to(1.0)), Some(Request::Stop)] {
            let data = tempfile::tempdir().expect("a folder");
            let mut own = settings_of(data.path(), 9.0);
            own.joints[0].range = [0.0, end];
            let mut world = world_of(own, &[PlantMode::new(8.0, 0.03, 1.0)]);
            world.ask(to(40.0));
            world.steps(ticks);
            world.ask(order.unwrap_or_else(|| to(40.0)));
            world.steps(600);
            let positions = world.sent().into_iter().map(|(_, sent)| sent.position);
            let beyond = positions.map(|at| (at - end).max(-at)).fold(0.0, f64::max);
            assert!(beyond < 1e-9, "{ticks}: {beyond} rad");
            let joint = world.joint();
            assert_eq!(joint.phase, Phase::Rest, "{ticks}");
            assert_eq!(world.snapshot().enable.faults, 0, "{ticks}");
            corrections += joint.corrections;
        }
    }
    assert!(corrections > 0, "corrections are made");
}

/// Between the ends of the range: retunes in motion, and targets that turn at an end, are within what the gate at the tick
/// admits.
#[test]
fn no_correction_is_refused_at_the_end_of_the_range() {
    let ends = [0.0, 50f64.to_radians()];
    let mut changes = 0;
    for (belief, modes) in [
        (6.0, vec![PlantMode::new(8.0, 0.03, 1.0)]),
        (10.5, vec![PlantMode::new(8.0, 0.03, 1.0)]),
        (9.0, two().to_vec()),
        (10.0, vec![posed()]),
    ] {
        let data = tempfile::tempdir().expect("a folder");
        let mut settings = settings_of(data.path(), belief);
        settings.joints[0].range = ends;
        let limits = settings.joints[0].limits;
        let mut world = world_of(settings, &modes);
        for target in [ends[1], ends[0], ends[1], ends[0]] {
            go(&mut world, target, None);
            assert_eq!(world.last().map(|sent| sent.1.position), Some(target));
        }
        for ticks in [40, 80, 120] {
            world.ask(to(50.0));
            world.steps(ticks);
            run(&mut world, to(0.0), 0.0);
        }
        assert_eq!(world.snapshot().enable.faults, 0);
        let beyond = inexact(limits, PERIOD);
        let within = |sent: &Sent| (ends[0] - beyond..=ends[1] + beyond).contains(&sent.1.position);
        assert!(world.sent().iter().all(within));
        let joint = world.joint();
        changes += joint.retunes + joint.corrections;
    }
    assert!(changes > 0);
}
