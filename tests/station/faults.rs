//! What disables moves, and that nothing but a request enables them.

use quell::service::contract::{
    Accepted, EnableState, FaultKind, MoveEnd, Phase, Request, ServiceError, ShapingChange,
};
use quell::service::following::{FOLLOWED, healthy};

use super::world::{
    LIMITS, PERIOD, STANDSTILL, WATCHDOG, World, config, first_beyond_limits, stopping,
};

fn state(world: &World) -> EnableState {
    world.snapshot().enable.state
}

/// Moves at full speed, from which something takes it.
fn moving(data: &std::path::Path) -> World {
    let mut world = World::commanded(config(data), true);
    world.go(3.0);
    world.steps(60);
    assert_eq!(world.joint().phase, Phase::Moving);
    world
}

/// Stopped within the limits for this reason, at rest from now on, and deaf to moves.
fn stopped(world: &mut World, fault: FaultKind, before: usize) -> f64 {
    world.steps(150);
    let sent = world.sent().split_off(before);
    assert_eq!(first_beyond_limits(&sent, true), None);
    let (_, last) = world.last().expect("setpoints");
    assert!(last.velocity == 0.0 && last.position < 2.9, "{last:?}");
    let view = world.snapshot().enable.clone();
    assert_eq!(
        (view.state, view.fault),
        (EnableState::Faulted, Some(fault))
    );
    world.go(0.1);
    let answered = world.steps(50);
    let refused = answered[0].answer.clone().expect_err("a fault");
    assert!(refused.to_string().contains(&view.reason), "{refused}");
    // It is not enabled over a fault.
    world.ask(Request::Enable);
    let answered = world.steps(1);
    assert!(matches!(
        answered[0].answer,
        Err(ServiceError::Faulted { .. })
    ));
    assert_eq!(world.last().map(|(_, sent)| sent), Some(last));
    // Rung out, the move says why it ended.
    world.steps(200);
    let snapshot = world.snapshot();
    let done = snapshot.moves.last().expect("a move");
    assert!(done.interrupted);
    assert_eq!(done.ended, Some(MoveEnd::Fault));
    assert_eq!(done.fault.as_deref(), Some(&*view.reason));
    last.position
}

/// Reset, enabled, and asked to, it moves again, and not before.
fn moves_again(world: &mut World, rests: f64) {
    world.ask(Request::Reset);
    world.steps(2 * STANDSTILL);
    assert_eq!(state(world), EnableState::Disabled);
    let at = world.last().expect("setpoints").1.position;
    assert!((at - rests).abs() < 1e-9, "{at} {rests}");
    world.ask(Request::Enable);
    let answered = world.steps(100);
    let enabled = Accepted::EnableState {
        state: EnableState::Enabled,
    };
    assert_eq!(answered[0].answer, Ok(enabled));
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(at));
    world.go(0.2);
    world.steps(400);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.2));
}

#[test]
fn nothing_moves_after_the_start_until_somebody_enables() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::start(config(data.path()), 1e9, 0.0, true);
    world.ask(Request::Enable);
    let answered = world.steps(1);
    assert!(matches!(
        answered[0].answer,
        Err(ServiceError::NoMeasurement { .. })
    ));
    world.steps(STANDSTILL);
    world.go(0.5);
    let answered = world.steps(100);
    let refused = answered[0].answer.clone().expect_err("disabled");
    assert!(
        refused
            .to_string()
            .starts_with("moves are not enabled: the service has started; "),
        "{refused}"
    );
    assert!(world.sent().iter().all(|(_, sent)| sent.position == 0.0));
    moves_again(&mut world, 0.0);
    // A life after that begins disabled, whatever the last one was.
    let at = world.robot.position;
    drop(world);
    let mut world = World::start(config(data.path()), 1e9, at, true);
    world.steps(STANDSTILL + 20);
    assert_eq!(state(&world), EnableState::Disabled);
    world.go(0.5);
    assert!(world.steps(100)[0].answer.is_err());
    assert!(world.sent().iter().all(|(_, sent)| sent.position == at));
}

#[test]
fn to_disable_stops_what_moves_and_what_was_asked_before() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = moving(data.path());
    world.go(-1.0);
    world.ask(Request::Disable);
    // Asked after it, but nobody has enabled since.
    world.go(-1.0);
    let answered = world.steps(150);
    assert!(answered[0].answer.is_ok() || answered[1].answer.is_ok());
    assert_eq!(answered.iter().filter(|one| one.answer.is_err()).count(), 2);
    let (_, last) = world.last().expect("setpoints");
    assert!(last.velocity == 0.0 && last.position > 0.0, "{last:?}");
    assert_eq!(state(&world), EnableState::Disabled);
    moves_again(&mut world, last.position);
}

#[test]
fn a_joint_that_is_held_trips_within_the_time_that_its_speed_says() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = moving(data.path());
    let held = world.robot.position;
    let speed = world.joint().command_rad_s;
    world.robot.off = true;
    let (since, before) = (world.clock.now(), world.sent().len());
    while state(&world) == EnableState::Enabled {
        world.step();
        assert!(world.clock.now() - since < 1.0, "it does not trip");
    }
    // It moves on for the limit beyond what lag explains; the state is told every 50 ms.
    let took = world.clock.now() - since;
    let expected = FOLLOWED + healthy(LIMITS.acceleration) / speed;
    assert!(took < expected + 0.05 + 3.0 * PERIOD, "{took} {expected}");
    stopped(&mut world, FaultKind::FollowingError, before);
    // Nothing is sent that would move it when it is free again. Reset, it is commanded from where it stands.
    let sent = world.sent().len();
    world.steps(STANDSTILL);
    assert_eq!(world.sent().len(), sent);
    world.ask(Request::Reset);
    world.steps(2 * STANDSTILL);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(held));
    world.robot.off = false;
    moves_again(&mut world, held);
}

/// The slowest servo that follows in time is held to be healthy, at every speed and on the way to it.
#[test]
fn a_joint_that_lags_is_no_fault() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.robot.lag = FOLLOWED;
    for target in [1.5, -1.5, 0.0] {
        world.go(target);
        world.steps(600);
        assert_eq!(state(&world), EnableState::Enabled, "{target}");
    }
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.0));
}

#[test]
fn a_motor_side_that_repeats_itself_in_motion_is_a_fault() {
    let data = tempfile::tempdir().expect("a folder");
    let mut config = config(data.path());
    // So that the sensor is what is seen.
    config.joints[0].following_limit = 10.0;
    let mut world = World::commanded(config, true);
    world.go(3.0);
    world.steps(60);
    let before = world.sent().len();
    world.robot.off = true;
    world.steps(40);
    world.robot.off = false;
    let rests = stopped(&mut world, FaultKind::Sensor, before);
    moves_again(&mut world, rests);
}

#[test]
fn ticks_that_are_missed_for_as_long_as_a_robot_may_be_silent_are_a_fault() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = moving(data.path());
    let before = world.sent().len();
    let missed = (WATCHDOG / PERIOD) as usize + 2;
    world.miss(missed);
    let rests = stopped(&mut world, FaultKind::TickOverrun, before);
    moves_again(&mut world, rests);
    // A shorter time is bridged.
    world.go(3.0);
    world.steps(60);
    world.miss(missed - 4);
    world.steps(600);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(3.0));
}

/// The stop after a pause begins at once, and not when as many ticks have gone by as were missed.
#[test]
fn a_stop_after_a_long_pause_does_not_wait_for_as_long() {
    for missed in [30, 300, 900] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        let at = world.last().expect("setpoints").1.position;
        world.miss(missed);
        world.steps(400);
        // What it takes to stop, and what it goes until the plan begins and while the train lasts.
        let most = at + stopping() + (0.04 + 0.4) * LIMITS.velocity;
        let last = world.last().expect("setpoints").1;
        assert!(
            last.velocity == 0.0 && last.position < most,
            "{missed}: {last:?}"
        );
    }
}

/// However many orders wait for a tick that is stuck, what was taken back before it goes on does not begin.
#[test]
fn what_was_taken_back_while_the_tick_was_stuck_does_not_begin() {
    for (orders, taken_back) in (56..72).flat_map(|n| [(n, Request::Stop), (n, Request::Disable)]) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = World::commanded(config(data.path()), true);
        world.steps(20);
        let (at, before) = (world.robot.position, world.sent().len());
        for order in 0..orders {
            world.ask(Request::Shaping(ShapingChange {
                adaptation: Some(order % 2 == 1),
                ..ShapingChange::default()
            }));
            world.work();
        }
        world.go(1.0);
        world.work();
        world.ask(taken_back.clone());
        let answered = world.work();
        assert!(
            answered
                .iter()
                .any(|one| one.request == taken_back && one.answer.is_ok())
        );
        world.steps(200);
        let sent = world.sent().split_off(before);
        let moved = sent.iter().find(|(_, sent)| sent.position != at);
        assert_eq!(moved, None, "{taken_back:?} after {orders} orders");
        assert!(world.waiting().is_empty(), "everybody is answered");
        // Nothing is left that keeps it from moving.
        world.enable();
        world.steps(2);
        world.go(0.2);
        world.steps(400);
        assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.2));
    }
}

/// After missed ticks the setpoint is that of its own instant. A drive that takes it at once steps, and its sensor
/// says so.
#[test]
fn a_step_that_was_commanded_is_no_jump_of_the_sensor() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = moving(data.path());
    world.steps(60);
    let before = world.last().expect("setpoints").1;
    world.miss(5);
    world.steps(1);
    let step = world.last().expect("setpoints").1.position - before.position;
    // More than a reading may change by in a period.
    assert!(step > 4.0 * LIMITS.velocity * PERIOD, "{step}");
    world.steps(50);
    assert_eq!(state(&world), EnableState::Enabled);
    assert_eq!(world.snapshot().enable.faults, 0);
    // What nobody commanded is one.
    world.robot.position += step;
    world.steps(20);
    assert_eq!(world.snapshot().enable.fault, Some(FaultKind::Sensor));
}

/// Drives that are switched on again find the joint commanded where somebody has put it meanwhile.
#[test]
fn a_joint_that_is_moved_while_no_move_may_begin_is_commanded_where_it_stands() {
    for disabled in [true, false] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        if disabled {
            world.ask(Request::Disable);
            world.steps(150);
        }
        world.robot.off = true;
        world.steps(150);
        for _ in 0..100 {
            world.robot.position -= 0.5 * PERIOD;
            world.step();
        }
        let expected = if disabled {
            EnableState::Disabled
        } else {
            EnableState::Faulted
        };
        assert_eq!(state(&world), expected);
        let stands = world.robot.position;
        world.steps(2 * STANDSTILL);
        let before = world.sent().len();
        world.robot.off = false;
        world.steps(STANDSTILL);
        let sent = world.sent().split_off(before);
        assert_eq!(sent.len(), STANDSTILL);
        let elsewhere = sent.iter().find(|(_, sent)| sent.position != stands);
        assert_eq!(elsewhere, None, "{expected:?}");
        moves_again(&mut world, stands);
    }
}

/// Where the sensor may be what has moved, nothing follows it until somebody has looked and reset.
#[test]
fn a_motor_side_that_jumps_at_rest_is_not_followed_before_a_reset() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.ask(Request::Disable);
    world.steps(20);
    world.robot.off = true;
    world.robot.position = 0.5;
    world.steps(10 * STANDSTILL);
    assert!(world.sent().iter().all(|(_, sent)| sent.position == 0.0));
    world.ask(Request::Enable);
    let refused = world.steps(1)[0].answer.clone().expect_err("it is off");
    assert!(
        matches!(refused, ServiceError::NotReady { .. }),
        "{refused}"
    );
    world.ask(Request::Reset);
    world.steps(2 * STANDSTILL);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.5));
    world.robot.off = false;
    moves_again(&mut world, 0.5);
}

/// Stamps that go back or leap are those of another clock, and no motion of the joint.
#[test]
fn a_robot_whose_clock_is_set_in_motion_is_not_stopped() {
    for leap in [2.0, -2.0, -8e4, 1e4] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        world.set_robot_clock(leap);
        world.steps(600);
        assert_eq!(state(&world), EnableState::Enabled, "{leap}");
        assert_eq!(world.last().map(|(_, sent)| sent.position), Some(3.0));
        assert_eq!(first_beyond_limits(&world.sent(), true), None);
    }
}

/// A robot that drops out in motion and comes back elsewhere, standing or not: nothing is sent to it until it stands, and
/// then the place where it stands. No request makes it jump.
#[test]
fn a_robot_that_comes_back_elsewhere_is_taken_over_where_it_stands() {
    for (away, coasts) in [(120, 0.0), (120, 0.5), (400, -0.5), (120, 0.1)] {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = moving(data.path());
        (world.robot.silent, world.robot.off) = (true, true);
        // The watchdog, and the brake and its train.
        world.steps((WATCHDOG / PERIOD) as usize + away);
        assert_eq!(state(&world), EnableState::Faulted);
        let rests = world.last().expect("setpoints").1;
        assert_eq!(rests.velocity, 0.0);
        world.robot.silent = false;
        world.robot.position -= 0.4;
        let before = world.sent().len();
        // While it coasts, somebody asks for all there is.
        for k in 0..if coasts == 0.0 { 0 } else { 150 } {
            world.robot.position += coasts * PERIOD;
            if k % 15 == 0 {
                world.enable();
                world.go(1.0);
            }
            world.step();
        }
        // After a long silence its clock is believed by the eighth sample; until then it is told where the command rests.
        let sent = world.sent().split_off(before);
        assert!(sent.len() < 8, "{away} {coasts}: {sent:?}");
        assert!(sent.iter().all(|(_, sent)| *sent == rests), "{sent:?}");
        let at = world.robot.position;
        let before = world.sent().len();
        world.ask(Request::Reset);
        world.steps(3 * STANDSTILL);
        let sent = world.sent().split_off(before);
        assert!(!sent.is_empty(), "{away} {coasts}");
        let elsewhere = sent
            .iter()
            .find(|(_, sent)| sent.position != at || sent.velocity != 0.0);
        assert_eq!(elsewhere, None, "{away} {coasts}");
        world.robot.off = false;
        let before = world.sent().len();
        world.enable();
        world.steps(2);
        world.go(0.2);
        world.steps(500);
        let sent = world.sent().split_off(before);
        assert_eq!(sent[0].1.position, at, "{away} {coasts}");
        assert_eq!(first_beyond_limits(&sent, true), None, "{away} {coasts}");
        assert_eq!(world.last().map(|(_, sent)| sent.position), Some(0.2));
    }
}
