//! A move within a tolerance: as fast as that allows for what was learned, and never without it.

use quell::service::contract::{Accepted, Request, ServiceError};
use quell::tolerance::Tolerance;

use super::modes::{go, run, settings_of, two, world};
use super::world::World;

fn tolerance(residual: f64) -> Tolerance {
    Tolerance {
        residual: Some(residual),
        deviation: None,
    }
}

fn within(target: f64, residual: f64) -> Request {
    Request::MoveWithin {
        joint: "joint_1".into(),
        target,
        tolerance: tolerance(residual),
    }
}

/// The answer to a request.
fn answered(world: &mut World, request: Request) -> Result<Accepted, ServiceError> {
    world.ask(request);
    let mut steps = (0..5_000).filter_map(|_| world.step().pop());
    steps.next().expect("an answer").answer
}

/// Two modes, learned in three moves: the next one leaves no more than is allowed, and takes less time than the one with a train.
#[test]
fn a_move_within_a_tolerance_is_fast_and_leaves_no_more() {
    let [data, other] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    let mut arm = world(data.path(), 9.0, &two());
    let mut unshaped = world(other.path(), 9.0, &two());
    for degrees in [40.0_f64, 0.0, 40.0, 0.0] {
        go(&mut arm, degrees.to_radians(), None);
    }
    let target = 40_f64.to_radians();
    let (_, all) = go(&mut unshaped, target, Some("none"));
    let (shaped, _) = go(&mut arm, target, None);
    go(&mut arm, 0.0, None);
    let (done, left) = run(&mut arm, within(target, 0.05), target);
    println!(
        "{:.2} % of {all:e} rad, {} and {} s",
        100.0 * left / all,
        done.duration_s,
        shaped.duration_s
    );
    assert_eq!(done.shaper, "tolerance");
    assert_eq!(done.unshaped_rad, None);
    assert!(done.duration_s < 0.97 * shaped.duration_s);
    // Each mode keeps at most 5 %, and there are two.
    assert!(left < 0.1 * all, "{left} of {all}");
    // The next move is shaped as before.
    let (after, left) = go(&mut arm, 0.0, None);
    assert_eq!(after.shaper, "zvd");
    assert!(left < 0.02 * all, "{left} of {all}");
}

#[test]
fn a_tolerance_is_not_dropped() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::start(settings_of(data.path(), 9.0), 1e9, 0.0, true);
    world.steps(100);
    let refused = answered(&mut world, within(0.5, 0.05));
    assert!(
        matches!(refused, Err(ServiceError::NotEnabled { .. })),
        "{refused:?}"
    );
    world.enable();
    world.step();
    for (target, residual) in [(0.5, 1e-12), (0.5, -1.0)] {
        let refused = answered(&mut world, within(target, residual));
        assert!(
            matches!(refused, Err(ServiceError::Plan { .. })),
            "{refused:?}"
        );
    }
    let begun = answered(&mut world, within(0.5, 0.05));
    assert!(matches!(begun, Ok(Accepted::Move { .. })), "{begun:?}");
    let refused = answered(&mut world, within(0.2, 0.05));
    assert!(
        matches!(refused, Err(ServiceError::InMotion { .. })),
        "{refused:?}"
    );
}

/// A client that has gone does not see what moves: what it asked for and what has not begun does not begin.
#[test]
fn what_nobody_waits_for_any_more_does_not_begin() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::start(settings_of(data.path(), 9.0), 1e9, 0.0, true);
    world.steps(100);
    world.enable();
    world.step();
    for solved in [false, true] {
        world.ask(within(0.5, 0.05));
        if solved {
            // It is being solved.
            world.work();
        }
        assert_eq!(world.waiting().len(), 1);
        world.give_up();
        world.steps(1000);
        assert!(world.sent().iter().all(|(_, sent)| sent.position == 0.0));
    }
    world.go(0.5);
    world.give_up();
    world.steps(200);
    assert!(world.sent().iter().all(|(_, sent)| sent.position == 0.0));
    let begun = answered(&mut world, within(0.5, 0.05));
    assert!(matches!(begun, Ok(Accepted::Move { .. })), "{begun:?}");
}
