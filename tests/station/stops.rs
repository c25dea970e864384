//! A stop does not wait behind moves, and what was asked before it does not begin after it.

use quell::service::contract::{Accepted, Phase, Request, ServiceError};

use super::world::{World, config};

/// Moves that wait while the engine does something else.
const MOVES: usize = 20;

#[test]
fn no_move_that_was_asked_before_a_stop_begins_after_it() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    for _ in 0..MOVES {
        world.go(0.5);
    }
    world.ask(Request::Stop);
    // It is not held back by the stop: nothing has to be stopped.
    world.go(-0.3);
    let answered = world.steps(200);
    assert_eq!(answered.len(), MOVES + 2);
    for answer in answered {
        match (answer.number, &answer.request) {
            (_, Request::Stop) => {
                let Ok(Accepted::Stop { joints, .. }) = answer.answer else {
                    panic!("{:?}", answer.answer);
                };
                assert!(joints.is_empty(), "no move was begun before it: {joints:?}");
            }
            (number, _) if number < MOVES => {
                assert_eq!(answer.answer, Err(ServiceError::Stopped), "{number}");
            }
            _ => assert!(answer.answer.is_ok(), "{:?}", answer.answer),
        }
    }
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(-0.3));
    assert!(world.sent().iter().all(|(_, sent)| sent.position <= 0.0));
}

#[test]
fn moves_that_wait_do_not_delay_the_stop_of_one_that_runs() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.go(1.5);
    world.steps(40);
    for _ in 0..MOVES {
        world.go(-1.0);
    }
    world.ask(Request::Stop);
    let answered = world.steps(1);
    let stopped = answered.iter().find(|one| one.request == Request::Stop);
    let Some(Ok(Accepted::Stop { joints, .. })) = stopped.map(|one| &one.answer) else {
        panic!("the stop is answered at once");
    };
    assert_eq!(joints.len(), 1);
    world.steps(200);
    let at = world.last().expect("setpoints").1;
    assert!(at.velocity == 0.0 && at.position < 1.0, "{at:?}");
}

/// A client that has the answer to a move finds it in the state, and does not take the joint for at rest.
#[test]
fn a_move_that_was_answered_is_in_the_state() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    for (id, target) in [(1, 0.5), (2, -0.5)] {
        world.go(target);
        let answer = (0..50).find_map(|_| world.step().pop());
        assert!(answer.is_some_and(|one| one.answer.is_ok()));
        let joint = world.joint();
        assert_eq!((joint.phase, joint.move_id), (Phase::Moving, id));
        assert_eq!(joint.target_rad, target);
        world.steps(20);
    }
}

/// A client that stops, lets go of a jog, or sets the feed to 0 finds the joint stopping, and what it changed changed.
#[test]
fn what_was_answered_is_in_the_state() {
    let data = tempfile::tempdir().expect("a folder");
    let jog = |velocity| Request::Jog {
        joint: "joint_1".into(),
        velocity,
        hold: 1,
    };
    for stop in [
        Request::Stop,
        Request::Disable,
        Request::Feed { share: 0.0 },
        jog(0.0),
    ] {
        let mut world = World::commanded(config(data.path()), true);
        world.ask(jog(0.5));
        world.steps(50);
        world.ask(stop.clone());
        assert!(world.step().iter().all(|one| one.answer.is_ok()));
        assert_eq!(world.joint().phase, Phase::Stopping, "{stop:?}");
        world.steps(200);
        assert_eq!(world.joint().phase, Phase::Rest, "{stop:?}");
        world.ask(Request::Payload { mass: 7.5 });
        world.step();
        assert_eq!(world.snapshot().payload_kg, Some(7.5));
    }
}
