//! The feed: moves that run follow it, within the limits, to the exact end, and leave no more vibration.

use proptest::prelude::*;
use quell::service::between::inexact;
use quell::service::contract::{Request, ServiceError, ShapingChange};
use quell_shapers::Setpoint;
use quell_trajectories::{AxisState, Limits, Planner, RateRamp};

use super::modes::{go, rest_of, two, world};
use super::world::{
    Answered, LIMITS, PERIOD, Sent, World, beyond_limits, config, first_beyond_limits, stopping,
};

fn feed(world: &mut World, percent: f64) {
    world.ask(Request::Feed {
        share: percent / 100.0,
    });
}

fn shaped_by(world: &mut World, rule: Option<&str>) {
    world.ask(Request::Shaping(ShapingChange {
        enabled: Some(rule.is_some()),
        kind: rule.map(Into::into),
        ..ShapingChange::default()
    }));
    let answered = world.steps(100);
    let taken = |one: &Answered| one.answer.is_ok();
    assert!(!answered.is_empty() && answered.iter().all(taken));
}

/// The first setpoint from which on the command stands still, after at most so many ticks.
fn until_rest(world: &mut World, most: usize) -> usize {
    for tick in 0..most {
        world.step();
        if world.last().is_some_and(|(_, sent)| sent.velocity == 0.0) && tick > 20 {
            return tick;
        }
    }
    panic!("it does not come to rest")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn whatever_the_feed_becomes_limits_and_end_are_kept(
        target in 0.1..3.0_f64,
        at_first in 10.0..=100.0_f64,
        changes in prop::collection::vec((1..120_usize, 5.0..=100.0_f64), 1..6),
        rule in prop::option::of(prop::sample::select(vec!["zvd", "ei3", "optimal"])),
        timed in any::<bool>(),
    ) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = World::commanded(config(data.path()), timed);
        shaped_by(&mut world, rule);
        feed(&mut world, at_first);
        world.go(target);
        for (ticks, percent) in changes {
            world.steps(ticks);
            feed(&mut world, percent);
        }
        world.steps(20);
        let slowest = 0.05;
        let most = (target / LIMITS.velocity + 0.5) / slowest / PERIOD;
        until_rest(&mut world, most as usize + 400);
        world.steps(200);
        prop_assert_eq!(world.last().map(|(_, sent)| sent.position), Some(target));
        prop_assert_eq!(first_beyond_limits(&world.sent(), timed), None);
    }
}

/// A command of a user to a joint in motion.
#[derive(Clone, Debug)]
enum Order {
    Feed(f64),
    Go(f64),
    Jog(f64),
    Stop,
}

fn order() -> impl Strategy<Value = Order> {
    prop_oneof![
        3 => prop_oneof![1.0..100.0_f64, Just(1.0), Just(100.0)].prop_map(Order::Feed),
        4 => (-1.5..=1.5_f64).prop_map(Order::Go),
        1 => (-LIMITS.velocity..LIMITS.velocity).prop_map(Order::Jog),
        2 => Just(Order::Stop),
    ]
}

/// Gives an order, and widens the hull of where the joint may go.
fn give(world: &mut World, order: &Order, number: u64, [low, high]: &mut [f64; 2]) {
    let [lowest, highest] = world.joint().range_rad;
    let mut may_go_to = |target: f64| (*low, *high) = (low.min(target), high.max(target));
    match *order {
        Order::Feed(percent) => feed(world, percent),
        Order::Stop => world.ask(Request::Stop),
        Order::Go(target) => {
            may_go_to(target);
            world.go(target);
        }
        Order::Jog(velocity) => {
            may_go_to(if velocity > 0.0 { highest } else { lowest });
            world.ask(Request::Jog {
                joint: "joint_1".into(),
                velocity,
                hold: number,
            });
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// A stop ends before the target of what it stops, so that no order leads beyond the targets.
    #[test]
    fn whatever_is_ordered_in_motion_no_target_is_passed(
        orders in prop::collection::vec((1..120_usize, order()), 2..9),
        rule in prop::option::of(prop::sample::select(vec!["zvd", "ei3", "optimal"])),
        timed in any::<bool>(),
    ) {
        let data = tempfile::tempdir().expect("a folder");
        let mut own = config(data.path());
        own.joints[0].range = [-1.5, 1.5];
        let mut world = World::commanded(own, timed);
        shaped_by(&mut world, rule);
        let mut hull = [0.0; 2];
        for (number, (ticks, order)) in orders.iter().enumerate() {
            give(&mut world, order, number as u64, &mut hull);
            world.steps(*ticks);
        }
        world.ask(Request::Stop);
        world.steps(300);
        let sent = world.sent();
        prop_assert!(sent.last().is_some_and(|(_, last)| last.velocity == 0.0));
        for pair in sent.windows(2) {
            prop_assert_eq!(beyond_limits(pair[0], pair[1], timed), None);
            let at = pair[1].1.position;
            let beyond = (hull[0] - at).max(at - hull[1]);
            prop_assert!(beyond <= inexact(LIMITS, PERIOD), "{} of {:?}", at, hull);
        }
        prop_assert_eq!(world.snapshot().enable.faults, 0);
    }
}

/// Where the last samples of a plan are between those of the move, a position is beside the plan by the interpolation's error.
#[test]
fn a_feed_that_rises_at_the_end_keeps_the_limits() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), false);
    shaped_by(&mut world, None);
    world.go(0.958_230_345_330_781);
    world.steps(42);
    feed(&mut world, 85.691_408_786_831_25);
    world.steps(97);
    feed(&mut world, 100.0);
    world.steps(300);
    assert_eq!(first_beyond_limits(&world.sent(), false), None);
}

/// Someone slows the robot and turns it: it brakes as it can, and then goes at the feed.
#[test]
fn a_turn_at_a_low_feed_brakes_with_the_whole_limits() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    shaped_by(&mut world, None);
    world.go(3.0);
    world.steps(120);
    let turned_at = world.last().expect("setpoints").1;
    assert_eq!(turned_at.velocity, LIMITS.velocity);
    feed(&mut world, 10.0);
    world.go(-1.0);
    world.steps(1500);
    let velocity = LIMITS.velocity;
    // What it takes to stop, and what it goes until the plan begins.
    let most = turned_at.position + stopping() + 0.03 * velocity;
    let sent = world.sent();
    assert!(sent.iter().all(|(_, sent)| sent.position < most), "{most}");
    let last = sent.last().expect("setpoints").1;
    assert!((last.velocity + 0.1 * velocity).abs() < 1e-9, "{last:?}");
    // The feed is followed later, too, though the plan brakes with the whole limits.
    feed(&mut world, 100.0);
    world.steps(100);
    let last = world.last().expect("setpoints").1;
    assert!((last.velocity + velocity).abs() < 1e-9, "{last:?}");
    world.steps(600);
    assert_eq!(world.last().map(|(_, sent)| sent.position), Some(-1.0));
}

/// So near that only the whole limits stop there from the feed's speed: it crawls, and goes on when the feed rises.
#[test]
fn a_turn_at_a_low_feed_follows_the_feed_when_it_rises() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    shaped_by(&mut world, None);
    world.go(-0.67);
    world.steps(40);
    feed(&mut world, 1.0);
    world.steps(14);
    world.go(-0.5);
    world.steps(60);
    let crawls = world.last().expect("setpoints").1;
    feed(&mut world, 51.0);
    world.steps(150);
    let last = world.last().expect("setpoints").1;
    assert!(
        crawls.position > -0.5 && last == Setpoint::at_rest(-0.5),
        "{crawls:?} {last:?}"
    );
    assert_eq!(first_beyond_limits(&world.sent(), true), None);
}

/// Stopped early in a move, a train of negative impulses went beyond the target and the limits.
#[test]
fn a_shaper_of_negative_impulses_is_refused() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.ask(Request::Shaping(ShapingChange {
        kind: Some("umzv".into()),
        ..ShapingChange::default()
    }));
    world.ask(Request::Move {
        joint: "joint_1".into(),
        target: 0.5,
        shaper: Some("umzv".into()),
    });
    let answered = world.steps(2);
    assert_eq!(answered.len(), 2);
    for one in answered {
        let shaper = "umzv".to_owned();
        assert_eq!(one.answer, Err(ServiceError::NegativeShaper { shaper }));
    }
}

/// In cruise the command goes at the speed of the feed once the limits have let it, back and forth.
#[test]
fn a_move_that_runs_goes_on_at_the_feed() {
    let data = tempfile::tempdir().expect("a folder");
    let mut world = World::commanded(config(data.path()), true);
    world.go(3.0);
    world.steps(120);
    for percent in [40.0, 90.0, 20.0, 100.0] {
        feed(&mut world, percent);
        world.steps(90);
        let now = world.last().expect("setpoints").1;
        let share = now.velocity / LIMITS.velocity;
        assert!((share - 0.01 * percent).abs() < 1e-9, "{percent} {share}");
    }
    // At none it stops where it is, and does not go on by itself.
    feed(&mut world, 0.0);
    world.steps(300);
    let rest = world.last().expect("setpoints").1;
    assert!(rest.velocity == 0.0 && rest.position < 3.0, "{rest:?}");
    feed(&mut world, 100.0);
    world.steps(200);
    assert_eq!(world.last().map(|(_, sent)| sent), Some(rest));
}

/// Peak of the true deformation after a move whose feed changes on the way, rad.
fn left(world: &mut World, degrees: f64, changes: &[(usize, f64)]) -> f64 {
    let target = f64::to_radians(degrees);
    let before = world.sent().len();
    world.go(target);
    for &(ticks, percent) in changes {
        world.steps(ticks);
        feed(world, percent);
    }
    let left = rest_of(world, target);
    feed(world, 100.0);
    world.steps(10);
    let sent: Vec<Sent> = world.sent().split_off(before);
    assert_eq!(sent.last().map(|sent| sent.1.position), Some(target));
    left
}

#[test]
fn what_the_train_cancels_it_cancels_at_every_feed() {
    let changes: [&[(usize, f64)]; 3] = [
        &[(60, 30.0), (80, 100.0)],
        &[(30, 50.0), (25, 80.0)],
        &[(90, 10.0), (100, 60.0), (30, 90.0)],
    ];
    let mut sums = [0.0; 2];
    for (sum, shaped) in sums.iter_mut().zip([true, false]) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = world(data.path(), 9.0, &two());
        if shaped {
            for degrees in [40.0_f64, 0.0, 50.0, 0.0] {
                go(&mut world, degrees.to_radians(), None);
            }
        } else {
            shaped_by(&mut world, None);
        }
        for (degrees, changes) in [50.0, 5.0, 45.0].into_iter().zip(changes) {
            *sum += left(&mut world, degrees, changes);
        }
    }
    println!("{sums:?} rad");
    assert!(sums[0] < 0.02 * sums[1], "{sums:?}");
}

proptest! {
    /// Between two samples the velocity of a plan is linear, up to `j h^2 / 8` off. A stop that begins there passes the target
    /// by what the gate of the tick admits beyond the range, and no more, at whatever rates the move went.
    #[test]
    fn a_stop_of_a_move_whose_feed_has_changed_ends_within_what_the_gate_admits(
        (velocity, acceleration, jerk) in (-1.0..1.0_f64, -0.5..1.5_f64, 0.0..2.5_f64),
        (way, steps) in (0.01..3.0_f64, 30.0..3000.0_f64),
        (first, rates) in (0.05..=1.0_f64, prop::collection::vec((0.0..1.0_f64, 0.05..=1.0_f64), 1..4)),
    ) {
        let [velocity, acceleration, jerk] = [velocity, acceleration, jerk].map(|n| 10f64.powf(n));
        let limits = Limits { velocity, acceleration, jerk };
        let planner = Planner::new(1).expect("a planner");
        let [from, to] = [0.0, way].map(AxisState::at_rest);
        let plan = planner.plan(&[from], &[to], &[limits.slowed(first)]).expect("a plan");
        let period = plan.duration() / steps;
        let base = plan.sample(period).expect("samples");
        let (mut ramp, mut length) = (RateRamp::steady(1.0), base.samples());
        for (share, rate) in rates {
            let changed = RateRamp {
                from: ramp.after(period * (share * length as f64).floor()),
                to: rate / first,
                duration: 0.0,
            };
            let mut ramps = base.rate_ramps(changed.from, changed.to);
            let Some((next, rest)) = ramps.find_map(|ramp| Some((ramp, base.at_rate(&ramp, &[limits])?))) else {
                continue;
            };
            (ramp, length) = (next, rest.samples());
            let most = way + inexact(limits, period) + 1e-9;
            for state in (0..rest.samples()).filter_map(|sample| rest.state(0, sample)) {
                prop_assert!(state.stops_at(limits) <= most, "{state:?} {most}");
                prop_assert!(state.reaches(limits)[1] <= most, "{state:?} {most}");
            }
        }
    }
}
