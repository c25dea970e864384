//! A joint that is not heard takes no move, and nothing that was asked before begins later.

use quell::service::contract::{
    Accepted, ErrorKind, FaultKind, Phase, Request, ServiceError, WatchdogState,
};

use super::world::{Answered, PERIOD, STANDSTILL, WATCHDOG, World, config};

/// Ticks after which a silence is known to the engine.
const NOTICED: usize = (WATCHDOG / PERIOD) as usize + 3;

fn is_not_enabled(answered: &Answered) -> bool {
    let refused = answered.answer.as_ref().err();
    refused.is_some_and(|error| {
        let kind = matches!(
            error,
            ServiceError::NotEnabled { .. } | ServiceError::Faulted { .. }
        );
        kind && error.kind() == ErrorKind::Conflict
    })
}

/// The fault that the service shows.
fn fault(world: &World) -> Option<FaultKind> {
    world.snapshot().enable.fault
}

#[test]
fn twenty_orders_to_a_joint_that_is_not_heard_move_nothing() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.robot.silent = true;
    world.steps(NOTICED);
    for order in 0..20 {
        world.go(0.5);
        let answered = world.steps(20);
        assert!(
            answered.len() == 1 && is_not_enabled(&answered[0]),
            "{order}"
        );
    }
    assert_eq!(world.joint().watchdog, WatchdogState::Stopped);
    assert_eq!(fault(&world), Some(FaultKind::LinkLost));
    world.ask(Request::Stop);
    let stopped = world.steps(2);
    let nothing_moves = Ok(Accepted::Stop {
        duration_s: 0.0,
        joints: Vec::new(),
    });
    assert!(stopped.len() == 1 && stopped[0].answer == nothing_moves);
    // It cannot be enabled unheard.
    world.enable();
    let answered = world.steps(2);
    assert!(matches!(
        answered[1].answer,
        Err(ServiceError::NotHeard { .. })
    ));
    // Heard again it takes no move, and nothing is made up for, until somebody enables.
    world.robot.silent = false;
    world.steps(100);
    world.go(0.5);
    let answered = world.steps(20);
    assert!(is_not_enabled(&answered[0]), "{:?}", answered[0].answer);
    assert!(world.sent().iter().all(|(_, sent)| sent.position == 0.0));
    assert_eq!(world.joint().watchdog, WatchdogState::Fine);
    world.enable();
    world.go(0.5);
    world.steps(200);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.5));
}

#[test]
fn a_move_is_stopped_by_a_silence_and_not_gone_on_with() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.go(1.5);
    world.steps(40);
    world.robot.silent = true;
    world.steps(NOTICED + 100);
    let at = world.last().expect("setpoints").1;
    assert!(at.velocity == 0.0 && at.position < 1.0, "{at:?}");
    world.robot.silent = false;
    world.steps(200);
    assert_eq!(world.last().map(|(_, sent)| sent), Some(at));
    assert_eq!(world.joint().phase, Phase::Rest);
}

#[test]
fn a_move_that_waits_when_the_silence_begins_is_refused() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    // The engine does not know yet that the tick hears nothing.
    world.robot.silent = true;
    world.steps(NOTICED - 4);
    world.engine_sleeps = 10;
    world.go(0.5);
    world.steps(9);
    world.station.answer();
    let answered = world.steps(20);
    assert!(answered.len() == 1 && is_not_enabled(&answered[0]));
    world.robot.silent = false;
    world.steps(100);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.0));
}

#[test]
fn a_joint_that_comes_back_elsewhere_is_not_sent_where_it_was() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    (world.robot.silent, world.robot.off) = (true, true);
    world.steps(NOTICED + 50);
    let before = world.sent().len();
    // Somebody has moved it by hand.
    (world.robot.position, world.robot.silent) = (0.2, false);
    world.robot.off = false;
    world.steps(3 * STANDSTILL);
    let sent = world.sent().split_off(before);
    assert!(!sent.is_empty());
    assert!(
        sent.iter().all(|(_, sent)| sent.position == 0.2),
        "{:?}",
        sent[0]
    );
    world.enable();
    world.go(0.4);
    world.steps(200);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.4));
}
