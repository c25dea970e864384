//! Several modes, and modes that follow the pose: the service learns them between the moves, keeps them, and forgets them.

use std::path::Path;

use quell::service::config::Config;
use quell::service::contract::{Accepted, MoveResult, Phase, Request, ShapingChange};
use quell_shapers::Mode;

use super::plant::{Faults, Plant, PlantMode};
use super::world::{PERIOD, World, config};

const FAULTS: Faults = Faults {
    noise: 10e-6,
    resolution: 1e-6,
    spikes: 0.0,
    lost: 0.0,
    lag: 0.0,
    friction: 0.0,
    backlash: 0.0,
};
const TARGETS: [f64; 8] = [60.0, 0.0, 30.0, 55.0, 10.0, 45.0, 5.0, 60.0];
/// Ticks that anything here takes at most.
const PATIENCE: usize = 5_000;
/// Ticks for which the arm is watched after a move.
const WATCHED: usize = 400;

fn settings(data: &Path, belief_hz: f64) -> Config {
    let mut config = config(data);
    let joint = &mut config.joints[0];
    joint.belief = Mode::from_hertz(belief_hz, 0.05).expect("a mode");
    joint.sensor_rate = 1.0 / PERIOD;
    joint.encoder_resolution = FAULTS.resolution;
    config
}

fn world(data: &Path, belief_hz: f64, modes: &[PlantMode]) -> World {
    let mut world = World::start(settings(data, belief_hz), 1e9, 0.0, true);
    world.robot.arm = Some(Plant::new(modes, FAULTS, PERIOD, 0.0, 1));
    world.steps(100);
    world.enable();
    assert!(world.step().iter().all(|one| one.answer.is_ok()));
    world
}

fn two() -> [PlantMode; 2] {
    [
        PlantMode::new(8.0, 0.03, 1.0),
        PlantMode::new(19.0, 0.03, 1.0 / 3.0),
    ]
}

/// 8 Hz at 0 degrees, 11 Hz at 60.
fn posed() -> PlantMode {
    PlantMode {
        slope: 3.0 / 8.0 / 60f64.to_radians(),
        ..PlantMode::new(8.0, 0.03, 1.0)
    }
}

/// The result of a move, and the peak of the true deformation once the motor side stands, rad.
fn go(world: &mut World, target: f64, shaper: Option<&str>) -> (MoveResult, f64) {
    world.ask(Request::Move {
        joint: "joint_1".into(),
        target,
        shaper: shaper.map(Into::into),
    });
    let begun = (0..PATIENCE)
        .find_map(|_| world.step().pop())
        .expect("an answer");
    let Ok(Accepted::Move { id, .. }) = begun.answer else {
        panic!("{:?}", begun.answer);
    };
    let (mut trace, mut quiet) = (Vec::new(), 0);
    while quiet < WATCHED {
        world.step();
        let arm = world.robot.arm.as_ref().expect("an arm");
        trace.push((arm.motor(), arm.deformation()));
        quiet = if world.joint().phase == Phase::Rest {
            quiet + 1
        } else {
            0
        };
        assert!(trace.len() < PATIENCE, "the move does not end");
    }
    let away = |(motor, _): &(f64, f64)| (motor - target).abs() > 1e-6;
    let end = trace.iter().rposition(away).map_or(0, |last| last + 1);
    let peak = trace[end..]
        .iter()
        .fold(0.0, |peak: f64, one| peak.max(one.1.abs()));
    let done = world
        .snapshot()
        .moves
        .iter()
        .find(|done| done.id == id)
        .cloned();
    (done.expect("a result"), peak)
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

    let mut again = World::start(settings(data.path(), 9.0), 1e9, 0.0, true);
    again.robot.arm = arm;
    again.steps(100);
    again.enable();
    again.step();
    assert_eq!(again.joint().map.modes, before.map.modes);
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
    let mut last = World::start(settings(data.path(), 9.0), 1e9, 0.0, true);
    last.steps(30);
    assert!(last.joint().map.modes.is_empty());
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
