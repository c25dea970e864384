//! Several modes, and modes that follow the pose: the service learns them between the moves, keeps them, and forgets them.

use std::f64::consts::TAU;
use std::path::Path;

use quell::service::config::Config;
use quell::service::contract::{
    Accepted, JointMap, MoveResult, Phase, Request, ShapingChange, Target,
};
use quell::service::following::FOLLOWED;
use quell_shapers::Mode;
use quell_trajectories::Limits;

use super::plant::{Faults, Plant, PlantMode, SERVO};
use super::world::{LIMITS, PERIOD, Sent, World, config};

const TARGETS: [f64; 8] = [60.0, 0.0, 30.0, 55.0, 10.0, 45.0, 5.0, 60.0];
/// rad/s^3.
pub const JERK: f64 = 6000.0;
/// Those of an industrial arm: 100 deg/s, 500 deg/s^2, 5000 deg/s^3.
const ORDINARY: Limits = Limits {
    velocity: 1.745,
    acceleration: 8.727,
    jerk: 87.27,
};
/// Ticks that anything here takes at most.
const PATIENCE: usize = 5_000;
/// Time, s, true motor position and deformation, rad, and whether the command moves.
type Traced = (f64, f64, f64, bool);
/// Ticks after which nothing rings on: five time constants and more.
const RUNG: usize = 1_500;
/// Ticks for which the arm is watched after a move.
const WATCHED: usize = 400;

pub fn settings_of(data: &Path, belief_hz: f64) -> Config {
    let mut config = config(data);
    let joint = &mut config.joints[0];
    joint.belief = Mode::from_hertz(belief_hz, 0.05).expect("a mode");
    // A ramp of 5 ms makes 19 Hz ring.
    joint.limits.jerk = JERK;
    joint.sensor_rate = 1.0 / PERIOD;
    joint.encoder_resolution = Faults::USUAL.resolution;
    config
}

pub fn world(data: &Path, belief_hz: f64, modes: &[PlantMode]) -> World {
    world_of(settings_of(data, belief_hz), modes)
}

pub fn world_of(config: Config, modes: &[PlantMode]) -> World {
    let mut world = World::start(config, 1e9, 0.0, true);
    world.robot.arm = Some(Plant::new(modes, Faults::USUAL, PERIOD, 0.0, 1));
    world.steps(100);
    world.enable();
    assert!(world.step().iter().all(|one| one.answer.is_ok()));
    world
}

pub fn two() -> [PlantMode; 2] {
    [
        PlantMode::new(8.0, 0.03, 1.0),
        PlantMode::new(19.0, 0.03, 1.0),
    ]
}

/// 8 Hz at 0 degrees, 11 Hz at 60.
pub fn posed() -> PlantMode {
    PlantMode {
        slope: 3.0 / 8.0 / 60f64.to_radians(),
        ..PlantMode::new(8.0, 0.03, 1.0)
    }
}

/// The same by its inertia.
fn folding() -> PlantMode {
    PlantMode {
        folds: true,
        ..posed()
    }
}

/// The result of a move, and the peak of the true deformation once the motor side stands, rad.
pub fn go(world: &mut World, target: f64, shaper: Option<&str>) -> (MoveResult, f64) {
    run(world, of_target(target, shaper), target)
}

fn of_target(target: f64, shaper: Option<&str>) -> Request {
    Request::Move {
        joint: "joint_1".into(),
        target,
        shaper: shaper.map(Into::into),
    }
}

/// The same of a move of several joints, of which there is one.
pub fn of_together(world: &mut World, target: f64) -> (MoveResult, f64) {
    let joint = "joint_1".to_owned();
    let targets = vec![Target { joint, target }];
    let request = Request::MoveTogether {
        targets,
        shaper: None,
        tolerance: None,
    };
    run(world, request, target)
}

/// The same of a request that moves to a target.
pub fn run(world: &mut World, request: Request, target: f64) -> (MoveResult, f64) {
    let (done, trace) = watch(world, request);
    (done, peak(&trace, target))
}

/// Peak of the true deformation once the motor side of the move that runs stands at its target, rad.
pub fn rest_of(world: &mut World, target: f64) -> f64 {
    peak(&traced(world), target)
}

fn peak(trace: &[Traced], target: f64) -> f64 {
    let away = |(_, motor, ..): &Traced| (motor - target).abs() > 1e-6;
    let end = trace.iter().rposition(away).map_or(0, |last| last + 1);
    let after = trace[end..].iter();
    after.fold(0.0, |peak: f64, one| peak.max(one.2.abs()))
}

/// The result of a move, and the true deformation once the motor side stands, rad.
fn watched(world: &mut World, target: f64, shaper: Option<&str>) -> (MoveResult, Vec<Traced>) {
    watch(world, of_target(target, shaper))
}

fn watch(world: &mut World, request: Request) -> (MoveResult, Vec<Traced>) {
    world.ask(request);
    let begun = (0..PATIENCE)
        .find_map(|_| world.step().pop())
        .expect("an answer");
    let id = match begun.answer {
        Ok(Accepted::Move { id, .. }) => id,
        Ok(Accepted::Together { moves, .. }) => moves[0].id,
        other => panic!("{other:?}"),
    };
    let trace = traced(world);
    let done = world
        .snapshot()
        .moves
        .iter()
        .find(|done| done.id == id)
        .cloned();
    (done.expect("a result"), trace)
}

/// The motion until it has rung out.
fn traced(world: &mut World) -> Vec<Traced> {
    let (mut trace, mut quiet) = (Vec::new(), 0);
    while quiet < WATCHED {
        world.step();
        let arm = world.robot.arm.as_ref().expect("an arm");
        let (motor, deformation) = (arm.motor(), arm.deformation());
        let moves = world.last().is_some_and(|sent| sent.1.velocity != 0.0);
        trace.push((world.robot.time, motor, deformation, moves));
        quiet = if world.joint().phase == Phase::Rest {
            quiet + 1
        } else {
            0
        };
        assert!(trace.len() < PATIENCE, "the move does not end");
    }
    trace
}

/// Each move's share of what it leaves unshaped, %, and what the service said of it.
fn left(modes: &[PlantMode], belief_hz: f64) -> Vec<(f64, Option<f64>)> {
    let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let mut shaped = world(data.path(), belief_hz, modes);
    let mut unshaped = world(other.path(), belief_hz, modes);
    TARGETS
        .iter()
        .map(|degrees| {
            let target = degrees.to_radians();
            let (_, all) = go(&mut unshaped, target, Some("none"));
            let (told, left) = go(&mut shaped, target, None);
            let said = told.vibration_rad.zip(told.unshaped_vibration_rad);
            let said = said.map(|(left, all)| 100.0 * left / all);
            let learning = shaped.joint().learning;
            println!(
                "{:.2} % of {all:e}, told {said:.1?}, {:?}, {learning:?}",
                100.0 * left / all,
                told.unshaped_std_rad
            );
            (100.0 * left / all, said)
        })
        .collect()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}

/// Amplitude over a period of the slowest mode, from when the service listens.
fn amplitude(trace: &[Traced]) -> f64 {
    let moves = trace.iter().rfind(|one| one.3).expect("a move");
    let from = moves.0 + FOLLOWED;
    let inside = trace
        .iter()
        .filter(|one| (from..from + 0.125).contains(&one.0));
    let seen: Vec<f64> = inside.map(|one| one.2).collect();
    let mean = seen.iter().sum::<f64>() / seen.len() as f64;
    let square = seen.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / seen.len() as f64;
    (2.0 * square).sqrt()
}

/// What is told of moves that are shaped for a wrong mode is what the arm did, from a rest in which nothing rings on. What they
/// would have left unshaped is known as well as is told, but for the motor side, which does not follow quite what is planned:
/// `(w / w_s)^2` by a servo of `w_s`, and the decay of the two ticks by which it is late.
#[test]
fn what_a_move_has_left_is_told_as_the_arm_did_it() {
    let quick = LIMITS.acceleration;
    for (belief, modes, highest, acceleration) in [
        (10.0, two().to_vec(), 19.0, quick),
        (10.0, vec![posed()], 11.0, quick),
        (8.0, vec![posed()], 11.0, quick),
        (8.0, vec![posed()], 11.0, 0.3 * quick),
        (8.0, vec![folding()], 11.0, quick),
        (10.0, vec![folding()], 11.0, quick),
        (8.0, vec![folding()], 11.0, 0.3 * quick),
    ] {
        let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
        let [mut shaped, mut unshaped] = [&data, &other].map(|data| {
            let mut settings = settings_of(data.path(), belief);
            settings.joints[0].limits.acceleration = acceleration;
            settings.joints[0].limits.jerk *= (acceleration / quick).powi(4);
            world_of(settings, &modes)
        });
        shaped.ask(Request::Shaping(ShapingChange {
            adaptation: Some(false),
            ..ShapingChange::default()
        }));
        shaped.steps(2);
        for degrees in TARGETS {
            let target = degrees.to_radians();
            for world in [&mut shaped, &mut unshaped] {
                world.steps(RUNG);
            }
            let (_, all) = watched(&mut unshaped, target, Some("none"));
            let (told, left) = watched(&mut shaped, target, None);
            let [left, all] = [left, all].map(|after| amplitude(&after));
            let (told_left, told_all) = (
                told.residual_rad.expect("measured"),
                told.unshaped_rad.expect("known"),
            );
            let std = told.unshaped_std_rad.expect("known");
            println!(
                "left {left:.2e}, told {told_left:.2e}; unshaped {all:.2e}, told {told_all:.2e}, std {std:.1e}"
            );
            let w = TAU * highest;
            let follows = (w / SERVO.0).powi(2) + 0.03 * w * 2.0 * PERIOD;
            assert!(
                (told_all - all).abs() <= 3.0 * std + follows * all,
                "{degrees}: {told_all} {all}"
            );
            if acceleration == quick {
                assert!(
                    (told_left - left).abs() <= 0.1 * left,
                    "{degrees}: {told_left} {left}"
                );
            }
        }
    }
}

/// Milliseconds from the first change of the command to the last, and those of the train with which the move begins.
fn takes(belief_hz: f64, mode: PlantMode, target: f64, rule: Rule) -> [f64; 2] {
    let data = tempfile::tempdir().expect("a folder");
    let mut settings = settings_of(data.path(), belief_hz);
    settings.joints[0].limits = ORDINARY;
    settings.joints[0].adaptation = rule == Rule::Adaptive;
    let mut world = world_of(settings, &[mode]);
    let train = world.joint().train.times_s.last().copied();
    let before = world.sent().len();
    go(
        &mut world,
        target,
        (rule == Rule::Unshaped).then_some("none"),
    );
    let sent = world.sent().split_off(before);
    let changes = |pair: &[Sent]| pair[0].1.position != pair[1].1.position;
    let first = sent.windows(2).position(changes).expect("a move");
    let last = sent.windows(2).rposition(changes).expect("a move");
    [(last - first) as f64 * PERIOD, train.expect("a train")].map(|s| 1e3 * s)
}

#[derive(Clone, Copy, PartialEq)]
enum Rule {
    Unshaped,
    Fixed,
    Adaptive,
}

/// A first move is longer than the unshaped one by the train of the belief, and by what is left of a correction at its end:
/// seven periods at most. Nothing waits for planning or learning.
#[test]
fn a_first_move_is_longer_by_its_train_and_its_correction() {
    let pairs = [
        (8.0, 8.0),
        (9.0, 8.0),
        (10.0, 8.0),
        (12.0, 8.0),
        (10.0, 9.0),
        (10.0, 12.0),
    ];
    for (belief, hertz) in pairs {
        for degrees in [8.0_f64, 15.0, 20.0, 25.0, 32.0, 56.0, 60.0] {
            let mode = PlantMode::new(hertz, 0.03, 1.0);
            let of = |rule| takes(belief, mode, degrees.to_radians(), rule);
            let [[unshaped, _], [fixed, train], [adaptive, _]] =
                [Rule::Unshaped, Rule::Fixed, Rule::Adaptive].map(of);
            println!(
                "belief {belief} Hz, mode {hertz} Hz, {degrees} deg: {unshaped:.0} ms unshaped, {fixed:.0} with the train \
                 of {train:.0}, {adaptive:.0} adaptive"
            );
            assert!((fixed - unshaped - train).abs() <= 1.0 + 1e3 * PERIOD);
            assert!(adaptive <= fixed + 7e3 / hertz, "{adaptive}");
        }
    }
}

/// A move that somebody wants unshaped rings on: nothing moves the joint after its end, though the standing train follows.
#[test]
fn an_unshaped_move_is_left_as_it_is() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = world(data.path(), 9.0, &[PlantMode::new(8.0, 0.03, 1.0)]);
    for degrees in [58.0_f64, 3.0, 9.0] {
        let target = degrees.to_radians();
        let before = world.sent().len();
        go(&mut world, target, Some("none"));
        world.steps(1000);
        let sent = world.sent().split_off(before);
        let arrived = sent.iter().position(|sent| sent.1.position == target);
        let after = &sent[arrived.expect("its end")..];
        assert!(
            after.iter().all(|sent| sent.1.position == target),
            "{degrees}"
        );
        assert!(
            world.joint().train.times_s.len() > 1,
            "the standing train is in force again"
        );
    }
}

#[test]
fn two_modes_are_shaped_for_after_a_move() {
    for belief in [8.0, 10.0] {
        let all = left(&two(), belief);
        assert!(
            median(all[2..].iter().map(|one| one.0)) <= 1.0,
            "{belief}: {all:?}"
        );
    }
}

#[test]
fn a_mode_that_follows_the_pose_is_shaped_for_along_the_way() {
    let all = left(&[posed()], 9.0);
    assert!(median(all[2..].iter().map(|one| one.0)) <= 1.0, "{all:?}");
}

/// What is kept is how well the modes are known, too; forgotten, nothing of it is left.
#[test]
fn the_map_survives_a_restart_and_is_forgotten() {
    let data = tempfile::tempdir().expect("a folder");
    let mut first = world(data.path(), 9.0, &two());
    for degrees in &TARGETS[..4] {
        go(&mut first, degrees.to_radians(), None);
    }
    let (before, arm) = (first.joint(), first.robot.arm.take());
    assert_eq!(before.learning.modes.len(), 2, "{:?}", before.learning);
    assert_eq!(before.map.modes.len(), 2);
    drop(first);

    let stands = arm.as_ref().map_or(0.0, Plant::motor);
    let mut again = World::start(settings_of(data.path(), 9.0), 1e9, stands, true);
    again.robot.arm = arm;
    again.steps(100);
    again.enable();
    assert!(again.step().iter().all(|one| one.answer.is_ok()));
    // But for the rounding of sums.
    let curves = |map: &JointMap| -> Vec<f64> {
        let points = map.modes.iter().flat_map(|mode| &mode.curve);
        points
            .flat_map(|at| [at.frequency_hz, at.frequency_std_hz])
            .collect()
    };
    let [kept, learned] = [again.joint().map, before.map].map(|map| curves(&map));
    assert_eq!(kept.len(), learned.len());
    for (kept, learned) in kept.iter().zip(&learned) {
        assert!((kept / learned - 1.0).abs() < 1e-6, "{kept} {learned}");
    }
    let unshaped = {
        let other = tempfile::tempdir().expect("a folder");
        let mut other = world(other.path(), 9.0, &two());
        for degrees in &TARGETS[..4] {
            go(&mut other, degrees.to_radians(), Some("none"));
        }
        go(&mut other, TARGETS[4].to_radians(), Some("none")).1
    };
    let (_, left) = go(&mut again, TARGETS[4].to_radians(), None);
    assert!(left <= 0.01 * unshaped, "{left:e} of {unshaped:e}");

    again.ask(Request::Forget {
        joint: "joint_1".into(),
    });
    again.steps(PATIENCE / 10);
    let forgotten = again.joint();
    assert!(forgotten.learning.modes.is_empty() && forgotten.map.modes.is_empty());
    assert!((forgotten.mode.expect("a mode").frequency_hz - 9.0).abs() < 1e-9);
    drop(again);
    let mut last = World::start(settings_of(data.path(), 9.0), 1e9, 0.0, true);
    last.steps(30);
    assert!(last.joint().map.modes.is_empty());
}

/// A robot that starts by its own clock and then goes by the stamps of the setpoints sets its clock back; or on.
#[test]
fn a_robot_whose_clock_was_set_is_learned_from() {
    for leap in [0.0, -8e4, -2.0, 1e4, 1.7e9] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = world(data.path(), 9.0, &two());
        go(&mut world, 0.2, None);
        world.set_robot_clock(leap);
        world.steps(RUNG);
        let before = world.joint().learning;
        for degrees in &TARGETS[..3] {
            let (told, _) = go(&mut world, degrees.to_radians(), None);
            assert!(told.residual_rad.is_some(), "{leap} {degrees}");
        }
        let after = world.joint().learning;
        assert_eq!(after.modes.len(), 2, "{leap}: {before:?} {after:?}");
    }
}

/// Nothing is solved for a robot whose moves are not enabled, and nothing is learned without adaptation.
#[test]
fn a_disabled_or_unadaptive_service_prescribes_nothing() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = world(data.path(), 9.0, &two());
    for degrees in &TARGETS[..2] {
        go(&mut world, degrees.to_radians(), None);
    }
    world.ask(Request::Disable);
    world.step();
    let before = world.joint();
    world.go(0.5);
    let answered = world.steps(20);
    assert!(
        answered.iter().all(|one| one.answer.is_err()),
        "moves are disabled"
    );
    assert_eq!(world.joint().learning, before.learning);
    assert_eq!(world.joint().train, before.train);

    world.enable();
    world.ask(Request::Shaping(ShapingChange {
        adaptation: Some(false),
        ..ShapingChange::default()
    }));
    world.steps(5);
    let map = world.joint().map;
    let (told, _) = go(&mut world, 0.7, None);
    assert!(!told.adaptive);
    assert_eq!(world.joint().map, map);
    // It is judged all the same.
    assert!(told.unshaped_vibration_rad.is_some());
}

/// A rule that is changed while an unshaped move runs or rings waits: the adaptation would cancel the vibration, by a
/// motion that nobody has asked for.
#[test]
fn an_unshaped_move_stays_so_whatever_is_changed_while_it_runs_or_rings() {
    let zvd = || {
        Request::Shaping(ShapingChange {
            kind: Some("zvd".into()),
            ..ShapingChange::default()
        })
    };
    for ticks in [5, 40, 100, 150, 180] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = world(data.path(), 10.0, &[PlantMode::new(8.0, 0.03, 1.0)]);
        world.ask(of_target(1.0, Some("none")));
        let begun = (0..PATIENCE).find_map(|_| world.step().pop());
        let Ok(Accepted::Move { duration_s, .. }) = begun.expect("an answer").answer else {
            panic!("no move");
        };
        let since = world.clock.now();
        world.steps(ticks);
        world.ask(zvd());
        world.steps(500 - ticks);
        let late =
            |(time, sent): &Sent| *time > since + duration_s + 2.0 * PERIOD && sent.position != 1.0;
        assert_eq!(world.sent().into_iter().find(late), None, "{ticks}");
        assert!(world.joint().mode.is_some());
        // Rung out, the train is in force.
        world.steps(RUNG);
        assert!(world.joint().train.times_s.len() > 1);
    }
}

/// The share that a move has left is that of its end, however long it cruises: what rings from its start is another figure. An unshaped
/// move is told as it rings, although its mode is far from the believed one.
#[test]
fn the_share_that_is_left_of_a_long_move_is_that_of_its_end() {
    let slow = Limits {
        velocity: 0.5,
        acceleration: 3.0,
        jerk: 100.0,
    };
    let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let [mut shaped, mut unshaped] = [&data, &other].map(|data| {
        let mut settings = settings_of(data.path(), 8.0);
        settings.joints[0].limits = slow;
        settings.joints[0].adaptation = false;
        world_of(settings, &[posed()])
    });
    for degrees in [60.0_f64, 0.0, 60.0] {
        let target = degrees.to_radians();
        for world in [&mut shaped, &mut unshaped] {
            world.steps(RUNG);
        }
        let (plain, all) = watched(&mut unshaped, target, Some("none"));
        let (told, left) = watched(&mut shaped, target, None);
        let [left, all] = [left, all].map(|after| amplitude(&after));
        let said = plain.residual_rad.expect("measured");
        assert!(
            (said / all - 1.0).abs() < 0.1,
            "{degrees}: {said:e} {all:e}"
        );
        if degrees > 0.0 {
            let share = told.residual_rad.expect("measured") / told.unshaped_rad.expect("known");
            let truth = left / all;
            assert!(
                (share / truth - 1.0).abs() < 0.15,
                "{degrees}: {share} {truth}"
            );
            let way =
                told.vibration_rad.expect("measured") / told.unshaped_vibration_rad.expect("known");
            assert!(way < 0.5 * share, "{degrees}: {way} {share}");
        }
    }
}

/// Ten moves within 30 degrees, then one to 60, where the mode has never been seen.
#[test]
fn a_pose_never_visited_is_shaped_for_as_the_map_predicts() {
    const SEEN: [[f64; 10]; 2] = [
        [10.0, 25.0, 5.0, 30.0, 12.0, 28.0, 0.0, 20.0, 8.0, 30.0],
        [30.0, 15.0, 28.0, 5.0, 20.0, 10.0, 25.0, 2.0, 30.0, 0.0],
    ];
    let programmes = SEEN.iter().flat_map(|seen| [(seen, 8.0), (seen, 10.0)]);
    for ((seen, belief), mode) in programmes.flat_map(|one| [(one, posed()), (one, folding())]) {
        for limits in [None, Some(ORDINARY)] {
            let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
            let [mut shaped, mut unshaped] = [&data, &other].map(|data| {
                let mut settings = settings_of(data.path(), belief);
                settings.joints[0].limits = limits.unwrap_or(settings.joints[0].limits);
                world_of(settings, &[mode])
            });
            let mut go = |degrees: f64| {
                let target = degrees.to_radians();
                for world in [&mut shaped, &mut unshaped] {
                    world.steps(RUNG);
                }
                let (_, all) = go(&mut unshaped, target, Some("none"));
                let (told, left) = go(&mut shaped, target, None);
                (left, all, told)
            };
            for degrees in seen {
                go(*degrees);
            }
            let (left, all, told) = go(60.0);
            let [said, std] =
                [told.unshaped_rad, told.unshaped_std_rad].map(Option::unwrap_or_default);
            let words = format!(
                "from {} deg, belief {belief} Hz, folds {}, {}: {:.2} % of {all:.2e} rad, told {said:.2e} std {std:.1e}",
                seen[9],
                mode.folds,
                if limits.is_none() {
                    "quick"
                } else {
                    "ordinary"
                },
                100.0 * left / all
            );
            println!("{words}");
            assert!(left <= 0.04 * all, "{words}");
        }
    }
}
