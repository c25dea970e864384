//! Random moves at rates that change on the way: limits, the exact end, the same path, and the closed form of a steady rate.

use proptest::prelude::*;
use quell_trajectories::{AxisState, Limits, Planner, Progress, RateRamp, SampledTrajectory};

const PERIOD: f64 = 0.001;
const LIMITS: [Limits; 2] = [
    Limits {
        velocity: 1.5,
        acceleration: 10.0,
        jerk: 600.0,
    },
    Limits {
        velocity: 3.0,
        acceleration: 6.0,
        jerk: 90.0,
    },
];

fn planned(targets: [f64; 2], share: f64) -> SampledTrajectory {
    let from = [AxisState::at_rest(0.0); 2];
    let to = targets.map(AxisState::at_rest);
    let limits = LIMITS.map(|limits| limits.slowed(share));
    let planner = Planner::new(2).expect("two axes");
    let plan = planner.plan(&from, &to, &limits).expect("a plan");
    plan.sample(PERIOD).expect("samples")
}

/// The shortest ramp that keeps the limits, and the rest of the move.
fn change(
    base: &SampledTrajectory,
    from: Progress,
    to: f64,
) -> Option<(RateRamp, SampledTrajectory)> {
    let mut ramps = base.rate_ramps(from, to);
    ramps.find_map(|ramp| Some((ramp, base.at_rate(&ramp, &LIMITS)?)))
}

/// Largest share of a limit, and of the distance between what velocity and position say.
fn peaks(plan: &SampledTrajectory) -> f64 {
    let mut most: f64 = 0.0;
    for (axis, limits) in LIMITS.iter().enumerate() {
        for tick in 1..plan.samples() {
            let states = [tick - 1, tick].map(|tick| plan.state(axis, tick).expect("a state"));
            let [before, now] = states;
            let jerk = (now.acceleration - before.acceleration) / PERIOD;
            let shares = [
                now.velocity / limits.velocity,
                now.acceleration / limits.acceleration,
                jerk / limits.jerk,
            ];
            most = shares
                .iter()
                .fold(most, |most, share| most.max(share.abs()));
            let mean = 0.5 * (before.velocity + now.velocity);
            let apart = now.position - before.position - mean * PERIOD;
            // The trapezoidal rule with a bounded jerk, and linear velocities between two samples of the move.
            assert!(apart.abs() < limits.jerk * PERIOD.powi(3) * (1.0 / 12.0 + 1.0 / 8.0) + 1e-12);
        }
    }
    most
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn it_keeps_limits_path_and_end(
        targets in [-2.0..2.0_f64, 0.02..2.0_f64],
        share in 0.2..=1.0_f64,
        changes in prop::collection::vec((0.0..0.5_f64, 0.05..=1.0_f64), 1..4),
    ) {
        let base = planned(targets, share);
        let mut ramp = RateRamp::steady(1.0);
        let mut whole = base.clone();
        let mut gone = 0;
        for (part, feed) in changes {
            // So many samples of what is left.
            let more = (part * (whole.samples() - gone) as f64) as usize;
            let since = ramp.after((more as f64) * PERIOD);
            if since.time >= base.duration() { break }
            if let Some((next, rest)) = change(&base, since, feed / share) {
                let here = whole.state(0, gone + more).expect("a state");
                let there = rest.state(0, 0).expect("a state");
                prop_assert!((here.position - there.position).abs() < 1e-12);
                prop_assert!((here.velocity - there.velocity).abs() < 1e-12);
                prop_assert!((here.acceleration - there.acceleration).abs() < 1e-9);
                whole = whole.then(gone + more, &rest);
                (ramp, gone) = (next, gone + more);
            }
        }
        prop_assert!(peaks(&whole) <= 1.0 + 2e-9, "{}", peaks(&whole));
        let last = whole.samples() - 1;
        for (axis, target) in targets.into_iter().enumerate() {
            prop_assert_eq!(whole.state(axis, last), Some(AxisState::at_rest(target)));
        }
    }

    /// At a steady rate the motion is that of the limits v r, a r^2, j r^3.
    #[test]
    fn val_a_steady_rate_is_that_of_slower_limits(target in 0.05..2.0_f64, rate in 0.1..1.0_f64) {
        let base = planned([target, 0.0], 1.0);
        let slow = base.at_rate(&RateRamp::steady(rate), &LIMITS).expect("within limits");
        let other = planned([target, 0.0], rate);
        prop_assert!(slow.samples().abs_diff(other.samples()) <= 1 + (1.0 / rate) as usize);
        for tick in 0..other.samples() {
            let [one, two] = [&slow, &other].map(|plan| plan.state(0, tick).expect("a state"));
            prop_assert!((one.position - two.position).abs() < LIMITS[0].jerk * PERIOD.powi(3));
            prop_assert!((one.velocity - two.velocity).abs() < LIMITS[0].jerk * PERIOD.powi(2));
        }
    }
}

/// A change in cruise is over within the time that the limits need; one while it brakes at its limit is refused.
#[test]
fn it_slows_where_the_limits_let_it() {
    let base = planned([2.0, 0.0], 1.0);
    let at = |time| Progress {
        time,
        rate: 1.0,
        slope: 0.0,
    };
    let (ramp, _) = change(&base, at(0.5 * base.duration()), 0.2).expect("a ramp");
    // The cubic's slope is at most 1.5 / D of its rise, and 1.2 rad/s are lost at 10 rad/s^2.
    let least: f64 = 1.5 * 1.2 / 10.0;
    assert!((least..1.6 * least).contains(&ramp.duration), "{ramp:?}");
    let braking = base.duration() - 0.07;
    let now = base.state(0, (braking / PERIOD) as usize).expect("a state");
    assert_eq!(now.acceleration, -10.0);
    assert_eq!(change(&base, at(braking), 0.2).map(|found| found.0), None);
}

/// A slow move that brakes with the whole limits does so within a period, or less, of one that is sped up.
#[test]
fn a_move_that_would_brake_between_two_samples_is_not_sped_up() {
    let planner = Planner::new(1).expect("an axis");
    let limits = LIMITS[0];
    for share in [0.2, 0.05, 0.01, 0.003] {
        let slow = Limits {
            velocity: share * limits.velocity,
            ..limits
        };
        let ends = [0.0, 0.3].map(AxisState::at_rest);
        let plan = planner.plan(&ends[..1], &ends[1..], &[slow]);
        let base = plan.expect("a plan").sample(PERIOD).expect("samples");
        let from = Progress {
            time: 0.5 * base.duration(),
            rate: 1.0,
            slope: 0.0,
        };
        for ramp in base.rate_ramps(from, 1.0 / share) {
            let Some(rest) = base.at_rate(&ramp, &[limits]) else {
                continue;
            };
            for pair in rest.velocities(0).windows(2) {
                let mean = (pair[1] - pair[0]) / PERIOD;
                assert!(
                    mean.abs() <= limits.acceleration * (1.0 + 1e-6),
                    "{share} {mean}"
                );
            }
        }
    }
}
