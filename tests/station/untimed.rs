//! Setpoints that carry no time: a robot that follows each as it comes is never made to jump.

use proptest::prelude::*;
use quell_trajectories::Limits;

use super::world::{LIMITS, PERIOD, World, beyond_limits, config};

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    #[test]
    fn no_two_setpoints_are_further_apart_than_in_a_period_of_the_plan(
        gaps in prop::collection::vec((1..40usize, 0..9usize), 1..8),
    ) {
        let data = tempfile::tempdir().expect("a folder");
        let mut world = World::commanded(config(data.path()), false);
        let before = world.sent().len();
        world.go(0.8);
        for (steps, missed) in gaps {
            world.steps(steps);
            world.miss(missed);
        }
        world.steps(500);
        let sent = world.sent().split_off(before);
        let Limits { velocity, .. } = LIMITS;
        for pair in sent.windows(2) {
            let step = (pair[1].1.position - pair[0].1.position).abs();
            prop_assert!(step <= velocity * PERIOD * (1.0 + 1e-9), "a step of {step}: {pair:?}");
            prop_assert_eq!(beyond_limits(pair[0], pair[1], false), None);
        }
        prop_assert_eq!(sent.last().map(|(_, sent)| sent.position), Some(0.8));
    }
}
