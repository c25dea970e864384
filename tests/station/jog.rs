//! A joint that is held moving, and moves at a share of full speed.

use quell::service::contract::{Accepted, Phase, Request, ServiceError};

use super::world::{LIMITS, PERIOD, STANDSTILL, World, config, first_beyond_limits};

/// Seconds after which a hold that is not renewed is over, as the interface says.
const HELD: f64 = 0.25;
const VELOCITY: f64 = 0.8;

fn jog(world: &mut World, velocity: f64, hold: u64) {
    world.ask(Request::Jog {
        joint: "joint_1".into(),
        velocity,
        hold,
    });
}

/// Held for so many tenths of a second.
fn hold(world: &mut World, number: u64, tenths: usize) -> Vec<Result<Accepted, ServiceError>> {
    let mut answers = Vec::new();
    for _ in 0..tenths {
        jog(world, VELOCITY, number);
        let answered = world.steps((0.1 / PERIOD) as usize);
        answers.extend(answered.into_iter().map(|one| one.answer));
    }
    answers
}

fn rests(world: &World) -> bool {
    world.last().is_some_and(|(_, sent)| sent.velocity == 0.0)
}

#[test]
fn it_moves_while_it_is_held_and_stops_when_nobody_says_so_any_more() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    assert!(hold(&mut world, 1, 15).iter().all(Result::is_ok));
    let (since, at) = world.last().expect("setpoints");
    assert!((at.velocity - VELOCITY).abs() < 1e-9, "{at:?}");
    // The client is lost: the last word was 0.1 s ago.
    while !rests(&world) {
        world.step();
        let gone = world.clock.now() - since;
        // The stop itself, planned ahead, and the longest train.
        let stop = VELOCITY / LIMITS.acceleration + LIMITS.acceleration / LIMITS.jerk;
        assert!(gone < HELD + stop + 0.02 + 0.4, "{gone}");
    }
    let rest = world.last().expect("setpoints").1.position;
    // Its hold is over, whatever it says later.
    let late = hold(&mut world, 1, 3);
    assert!(
        late.iter()
            .all(|answer| matches!(answer, Err(ServiceError::HoldOver { .. })))
    );
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(rest));
    assert_eq!(first_beyond_limits(&world.sent(), true), None);
}

#[test]
fn a_stop_ends_a_hold_and_its_client_cannot_go_on() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    hold(&mut world, 7, 5);
    world.ask(Request::Stop);
    let after = hold(&mut world, 7, 8);
    assert!(
        matches!(after[1], Err(ServiceError::HoldOver { .. })),
        "{after:?}"
    );
    assert!(rests(&world));
    assert_eq!(world.joint().phase, Phase::Rest);
    // Another press moves; somebody else's does not while it lasts.
    hold(&mut world, 8, 2);
    let other = hold(&mut world, 9, 1);
    assert!(
        matches!(other[0], Err(ServiceError::Held { .. })),
        "{other:?}"
    );
    jog(&mut world, 0.0, 8);
    world.steps(150);
    assert!(rests(&world));
    // Let go before the press was heard: it is over.
    jog(&mut world, 0.0, 20);
    let late = hold(&mut world, 20, 2);
    assert!(
        matches!(late[1], Err(ServiceError::HoldOver { .. })),
        "{late:?}"
    );
    // Disabled, none does.
    world.ask(Request::Disable);
    world.steps(1);
    let refused = hold(&mut world, 10, 2);
    assert!(
        refused
            .iter()
            .all(|answer| matches!(answer, Err(ServiceError::NotEnabled { .. })))
    );
}

/// When a command first and last changes, s, and its largest speed.
fn moved(world: &mut World, target: f64) -> (f64, f64) {
    let before = world.sent().len();
    world.go(target);
    world.steps(1200);
    let sent = world.sent().split_off(before);
    let changes: Vec<_> = sent
        .windows(2)
        .filter(|pair| pair[0].1.position != pair[1].1.position)
        .map(|pair| pair[1].0)
        .collect();
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(target));
    let speed = sent
        .iter()
        .map(|(_, sent)| sent.velocity.abs())
        .fold(0.0, f64::max);
    (changes[changes.len() - 1] - changes[0], speed)
}

/// Half the feed makes the plan twice as long; the train after it is as long as it was.
#[test]
fn the_feed_stretches_the_plan_and_not_the_train() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    let (full, speed) = moved(&mut world, 1.0);
    let train = world
        .joint()
        .train
        .times_s
        .last()
        .copied()
        .expect("a train");
    world.ask(Request::Feed { share: 0.5 });
    world.steps(1);
    let (half, slow) = moved(&mut world, 0.0);
    assert!(
        (half - train - 2.0 * (full - train)).abs() < 5.0 * PERIOD,
        "{full} {half} {train}"
    );
    assert!((slow / speed - 0.5).abs() < 1e-2, "{slow} {speed}");
    // At none what moves stops, and nothing begins.
    world.go(1.0);
    world.steps(60);
    world.ask(Request::Feed { share: 0.0 });
    world.steps(250);
    assert!(rests(&world));
    world.go(1.0);
    assert_eq!(world.steps(50)[0].answer, Err(ServiceError::NoFeed));
    world.ask(Request::Feed { share: 1.1 });
    // So slow that the plan of a move that runs is too long to be made while a stop may come.
    world.ask(Request::Feed { share: 1e-9 });
    let refused = world.steps(1);
    assert!(refused.len() == 2 && refused.iter().all(|one| one.answer.is_err()));
}

/// It begins beyond the end of its range: it may come back, not go on.
#[test]
fn a_jog_moves_only_in_its_direction() {
    let data = tempfile::tempdir().expect("a folder");
    let mut own = config(data.path());
    own.joints[0].range = [-0.2, 0.2];
    let mut world = World::start(own, 1e9, 0.35, true);
    world.steps(STANDSTILL);
    world.enable();
    world.steps(1);
    let refused = hold(&mut world, 1, 3);
    let no_room = |answer: &Result<_, _>| matches!(answer, Err(ServiceError::NoRoom { .. }));
    assert!(refused.iter().all(no_room), "{refused:?}");
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.35));
    jog(&mut world, -VELOCITY, 2);
    assert!(world.steps(60).iter().all(|one| one.answer.is_ok()));
    let at = world.last().expect("setpoints").1.position;
    assert!(at < 0.35, "{at}");
    world.steps(200);
    // At the end of the range there is no room, either.
    world.go(0.2);
    world.steps(300);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.2));
    assert!(hold(&mut world, 3, 1).iter().all(no_room));
    assert_eq!(world.snapshot().enable.faults, 0);
}
