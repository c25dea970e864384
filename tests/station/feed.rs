//! The feed: moves that run follow it, within the limits, to the exact end, and leave no more vibration.

use proptest::prelude::*;
use quell::service::contract::{Request, ShapingChange};

use super::modes::{go, rest_of, two, world};
use super::world::{LIMITS, PERIOD, Sent, World, beyond_limits, config};

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
    world.steps(100);
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
        rule in prop::option::of(prop::sample::select(vec!["zvd", "um_zv"])),
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
        for pair in world.sent().windows(2) {
            prop_assert_eq!(beyond_limits(pair[0], pair[1], timed), None);
        }
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
