//! The embedded arm: what is learned of it makes the next move calm, and outlives a kill in mid-move.

use std::path::Path;

use quell::service::config::{Config, Overrides, RobotKind};
use quell::service::contract::{Accepted, ModeValue, MoveResult, Phase, Request, ShapingChange};

use super::world::World;

/// Ticks that anything here takes at most.
const PATIENCE: usize = 20_000;

fn embedded(data: &Path) -> World {
    let overrides = Overrides {
        robot: Some(RobotKind::Embedded),
        data: Some(data.to_path_buf()),
        ..Overrides::default()
    };
    let mut world = World::embedded(Config::load(None, &overrides).expect("defaults"));
    world.steps(100);
    assert_eq!(world.joint().phase, Phase::Rest);
    world.enable();
    world.steps(1);
    world
}

fn begin(world: &mut World, target: f64, shaper: Option<&str>) -> u64 {
    world.ask(Request::Move {
        joint: "joint_1".into(),
        target,
        shaper: shaper.map(Into::into),
    });
    for _ in 0..PATIENCE {
        if let Some(answered) = world.step().pop() {
            let Ok(Accepted::Move { id, .. }) = answered.answer else {
                panic!("{:?}", answered.answer);
            };
            return id;
        }
    }
    panic!("nobody answers")
}

fn go(world: &mut World, target: f64, shaper: Option<&str>) -> MoveResult {
    let id = begin(world, target, shaper);
    for _ in 0..PATIENCE {
        world.step();
        if let Some(done) = world.snapshot().moves.iter().find(|done| done.id == id) {
            return done.clone();
        }
    }
    panic!("the move does not end")
}

#[test]
fn what_is_learned_calms_the_next_move_and_outlives_a_kill() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = embedded(data.path());
    // A mode that is 25 % beside the arm's.
    world.ask(Request::Shaping(ShapingChange {
        mode: Some(ModeValue {
            frequency_hz: 10.15,
            damping_ratio: 0.084,
        }),
        ..ShapingChange::default()
    }));
    world.steps(1);
    let unshaped = go(&mut world, 0.5, Some("none"));
    assert!(!unshaped.interrupted && !unshaped.shaped && unshaped.target_rad == 0.5);
    go(&mut world, 0.0, None);
    let next = go(&mut world, 0.5, None);
    assert!(next.shaped && next.adaptive);
    let [all, left] = [&unshaped, &next].map(|done| done.residual_rad.expect("measured"));
    assert!(left <= 0.03 * all, "left {left:e} of {all:e}");
    // What the plan would have left unshaped agrees with what such a move did leave; the servo (30 Hz)
    // passes 8 Hz within a quarter.
    let forecast = next.unshaped_rad.expect("a forecast");
    assert!(
        (forecast / all - 1.0).abs() < 0.25,
        "{forecast:e} for {all:e}"
    );
    let learned = world.joint().mode.expect("a mode");
    assert!(
        (learned.frequency_hz / 8.12 - 1.0).abs() < 0.02,
        "{learned:?}"
    );

    // Killed in mid-move.
    let last = begin(&mut world, 0.0, None);
    world.steps(200);
    let before = world.joint();
    assert_eq!(before.phase, Phase::Moving);
    let known = next.modes.clone();
    drop(world);
    let mut again = embedded(data.path());
    assert_eq!(again.joint().mode, before.mode);
    // What is in force is shown before the first move.
    assert!(!known.is_empty());
    assert_eq!(again.joint().learning.modes, known);
    let first = go(&mut again, 0.5, None);
    assert!(first.id > last, "the number of a move is not given twice");
    let left = first.residual_rad.expect("measured");
    assert!(left <= 0.03 * all, "left {left:e} of {all:e}");
}

/// A load that is gripped lowers the mode: the first move with it learns that, the next ones are calm.
#[test]
fn a_mode_that_jumps_is_followed() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = embedded(data.path());
    for target in [0.5, 0.0] {
        go(&mut world, target, None);
    }
    let free = world.joint().mode.expect("a mode").frequency_hz;
    world.ask(Request::Payload { mass: 20.0 });
    world.steps(1);
    let unshaped = go(&mut world, 0.5, Some("none"));
    go(&mut world, 0.0, None);
    let next = go(&mut world, 0.5, None);
    let [all, left] = [&unshaped, &next].map(|done| done.residual_rad.expect("measured"));
    assert!(left <= 0.03 * all, "left {left:e} of {all:e}");
    let loaded = world.joint().mode.expect("a mode").frequency_hz;
    assert!(loaded < 0.95 * free, "{free} Hz, {loaded} Hz loaded");
}

/// A long move is judged in cruise, too: the adaptive one is never worse than the one that keeps a wrong belief.
#[test]
fn the_whole_of_a_long_move_is_judged() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = embedded(data.path());
    let unshaped = go(&mut world, 2.9, Some("none"));
    let all = unshaped.vibration_rad.expect("measured");
    assert!(
        all >= unshaped.residual_rad.expect("measured"),
        "{unshaped:?}"
    );
    let believe = |adaptation: bool| {
        Request::Shaping(ShapingChange {
            mode: Some(ModeValue {
                frequency_hz: 10.15,
                damping_ratio: 0.084,
            }),
            adaptation: Some(adaptation),
            ..ShapingChange::default()
        })
    };
    world.ask(believe(false));
    world.steps(1);
    let kept = go(&mut world, 0.0, None);
    world.ask(believe(true));
    world.steps(1);
    let adaptive = go(&mut world, 2.9, None);
    assert!(!kept.adaptive && adaptive.adaptive);
    let [kept, adaptive_one] = [&kept, &adaptive].map(|done| done.vibration_rad.expect("measured"));
    assert!(
        adaptive_one <= kept + 0.05 * all,
        "{adaptive_one:e}, {kept:e} kept, {all:e} unshaped"
    );
    // The servo (30 Hz) passes 8 Hz within a quarter.
    let forecast = adaptive.unshaped_vibration_rad.expect("a forecast");
    assert!(
        (forecast / all - 1.0).abs() < 0.25,
        "{forecast:e} for {all:e}"
    );
}
