//! The fastest move within a tolerance: what it leaves, where it goes, how it ends.

use proptest::prelude::*;
use quell_control::controller::plan_shaped;
use quell_control::tolerance::{Fastest, Moving, Tolerance, ToleranceError, fastest, share_left};
use quell_shapers::{Mode, Shaper, UncertainMode, Zvd, common_train};
use quell_trajectories::{Limits, Planner, SampledTrajectory};

const PERIOD: f64 = 1e-3;
/// Between the nodes of its own check, and of samples between which the acceleration is not quite linear.
const SLACK: (f64, f64) = (1.002, 1e-8);

fn uncertain(hertz: f64, damping: f64, std: f64) -> UncertainMode {
    let mode = Mode::from_hertz(hertz, damping).unwrap();
    UncertainMode {
        mode,
        natural_frequency_std: std * mode.natural_frequency(),
        damping_ratio_std: 0.1 * damping,
    }
}

fn moving(degrees: f64, modes: Vec<UncertainMode>) -> Moving {
    Moving {
        ends: [0.1, 0.1 + degrees.to_radians()],
        limits: Limits {
            velocity: 2.6,
            acceleration: 10.0,
            jerk: 80.0,
        },
        modes,
        lever: 1.5,
    }
}

/// Amplitude that a mode of the joint keeps: `q'' + 2 xi w q' + w^2 q = -a`, in tenths of a tick, each exact for an even acceleration.
fn rings(plan: &SampledTrajectory, w: f64, xi: f64) -> f64 {
    const FINER: usize = 10;
    let h = plan.period() / FINER as f64;
    let root = (1.0 - xi * xi).sqrt();
    let (sin, cos) = (w * root * h).sin_cos();
    let decay = (-xi * w * h).exp();
    let [mut q, mut v] = [0.0, 0.0];
    let ticks = plan
        .accelerations(0)
        .windows(2)
        .zip(plan.velocities(0).windows(2));
    for (ends, velocities) in ticks {
        // As the velocities say on the average: the jerk changes within a tick.
        let mean = (velocities[1] - velocities[0]) / plan.period();
        for k in 0..FINER {
            let share = (k as f64 + 0.5) / FINER as f64 - 0.5;
            let forced = -(mean + share * (ends[1] - ends[0])) / (w * w);
            let x = q - forced;
            q = forced + decay * (x * cos + (v / w + xi * x) / root * sin);
            v = decay * (v * cos - (xi * v + w * x) / root * sin);
        }
    }
    q.hypot((v + xi * w * q) / (w * root))
}

/// The largest over the box of a mode, looked at in other places than it was solved for.
fn worst(plan: &SampledTrajectory, known: &UncertainMode) -> f64 {
    rings_within(plan, known, 8)
}

/// The largest over the box of a mode, at so many frequencies to each side of the middle.
fn rings_within(plan: &SampledTrajectory, known: &UncertainMode, aside: i32) -> f64 {
    let (mode, std) = (known.mode, known.natural_frequency_std);
    let mut most: f64 = 0.0;
    for k in -aside..=aside {
        for side in [-2.0, 0.7, 2.0] {
            let share = f64::from(k) / f64::from(aside);
            let frequency = mode.natural_frequency() + 2.0 * share * std;
            let damping = mode.damping_ratio() + side * known.damping_ratio_std;
            most = most.max(rings(plan, frequency, damping));
        }
    }
    most
}

fn of_one(joint: &Moving, tolerance: Tolerance) -> Result<Fastest, ToleranceError> {
    fastest(core::slice::from_ref(joint), tolerance, PERIOD)
}

/// The move as fast as the limits allow.
fn unshaped(joint: &Moving) -> SampledTrajectory {
    of_one(joint, Tolerance::default()).unwrap().plans[0].clone()
}

/// It ends where it should, within the limits.
fn check_motion(plan: &SampledTrajectory, joint: &Moving) {
    let last = plan.samples() - 1;
    assert_eq!(plan.positions(0)[last], joint.ends[1]);
    assert_eq!(plan.velocities(0)[last], 0.0);
    let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let accelerations = plan.accelerations(0);
    let jerks = accelerations
        .windows(2)
        .map(|pair| (pair[1] - pair[0]) / PERIOD);
    let jerks: Vec<f64> = jerks.collect();
    assert!(most(plan.velocities(0)) <= joint.limits.velocity * (1.0 + 1e-8));
    assert!(most(accelerations) <= joint.limits.acceleration * (1.0 + 1e-8));
    assert!(most(&jerks) <= joint.limits.jerk * (1.0 + 1e-6));
}

/// Distance of the tip from the straight line at the worst tick, as lever times angle; the line is looked at where a joint is on it.
fn departure(found: &Fastest, joints: &[Moving]) -> f64 {
    let at = |tick: usize| {
        let each = found.plans.iter().zip(joints);
        let shares = each.map(|(plan, joint)| {
            (plan.positions(0)[tick] - joint.ends[0]) / (joint.ends[1] - joint.ends[0])
        });
        let shares: Vec<f64> = shares.collect();
        let sum = |s: f64| -> f64 {
            let each = shares.iter().zip(joints);
            each.map(|(share, joint)| {
                joint.lever * ((share - s) * (joint.ends[1] - joint.ends[0])).abs()
            })
            .sum()
        };
        shares.iter().map(|s| sum(*s)).fold(f64::INFINITY, f64::min)
    };
    (0..found.plans[0].samples()).map(at).fold(0.0, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Of one joint, with one mode or two: limits, end, and no mode of the boxes keeps more than was allowed.
    #[test]
    fn a_joint_leaves_no_more_than_is_allowed(
        hertz in 4.0..16.0f64, ratio in 1.8..3.0f64, two: bool, damping in 0.005..0.1f64, std in 0.002..0.03f64,
        degrees in prop_oneof![3.0..90.0f64, -90.0..-3.0f64], residual in 0.01..0.2f64, millimetres in 0.02..5.0f64,
    ) {
        let mut modes = vec![uncertain(hertz, damping, std)];
        if two {
            modes.push(uncertain(ratio * hertz, damping, std));
        }
        let joint = moving(degrees, modes.clone());
        let metres = 1e-3 * millimetres;
        let found = of_one(&joint, Tolerance { residual: Some(residual), deviation: Some(metres) }).unwrap();
        let plan = &found.plans[0];
        check_motion(plan, &joint);
        let most = |plan: &SampledTrajectory| modes.iter().map(|known| worst(plan, known)).fold(0.0, f64::max);
        let straight = unshaped(&joint);
        let (left, all) = (most(plan), most(&straight));
        let (factor, rounding) = SLACK;
        // What the unshaped move leaves is looked at in fewer places here: it may be a little more there.
        prop_assert!(left <= residual * all * 1.02 + rounding, "{left} of {all}");
        prop_assert!(joint.lever * left <= metres * factor + rounding, "{left} rad");
        prop_assert!(left <= found.bounds.vibration / joint.lever * factor + rounding);
        prop_assert!(plan.samples() >= straight.samples());
    }

    /// Several joints end together, never beyond the millimetres of their path; without a deviation they are on it at every tick.
    #[test]
    fn joints_stay_within_the_deviation(
        first in 4.0..9.0f64, second in 9.0..16.0f64, degrees in 10.0..60.0f64, other in -60.0..-5.0f64,
        residual in 0.02..0.1f64, millimetres in 0.5..5.0f64,
    ) {
        let joints = [
            moving(degrees, vec![uncertain(first, 0.03, 0.01)]),
            moving(other, vec![uncertain(second, 0.02, 0.01)]),
        ];
        let with = |deviation| fastest(&joints, Tolerance { residual: Some(residual), deviation }, PERIOD).unwrap();
        let kept = with(None);
        prop_assert!(departure(&kept, &joints) < 1e-12);
        prop_assert_eq!(kept.bounds.departure, 0.0);
        let metres = 1e-3 * millimetres;
        let found = with(Some(metres));
        prop_assert!(departure(&found, &joints) <= metres);
        for (plan, joint) in found.plans.iter().zip(&joints) {
            check_motion(plan, joint);
            prop_assert_eq!(plan.samples(), found.plans[0].samples());
            let left = worst(plan, &joint.modes[0]);
            prop_assert!(joint.lever * left <= metres * SLACK.0 + SLACK.1, "{left}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5))]

    /// On moves of up to 60 s, at slow limits and fast, of one mode to three: never slower than with ZVD, and no more is left than that leaves.
    #[test]
    fn a_long_move_is_never_slower_than_with_zvd(
        speed in -2.0..0.5f64, seconds in 0.3..1.75f64, [rise, ramp] in [-1.3..0.7f64, -1.5..-0.3f64],
        hertz in 4.0..16.0f64, ratio in 1.5..2.5f64, count in 1..=3, damping in 0.005..0.1f64, std in 0.002..0.03f64,
    ) {
        let [velocity, seconds, rise, ramp] = [speed, seconds, rise, ramp].map(|power| 10_f64.powf(power));
        let acceleration = velocity / rise;
        let modes = (0..count).map(|k| uncertain(hertz * ratio.powi(k), damping, std));
        let joint = Moving {
            ends: [0.1, 0.1 + velocity * seconds],
            limits: Limits { velocity, acceleration, jerk: acceleration / ramp },
            modes: modes.collect(),
            lever: 1.5,
        };
        let each = joint.modes.iter().map(|known| Zvd.on_grid(known.mode, PERIOD).unwrap());
        let zvd = common_train(&each.collect::<Vec<_>>()).unwrap();
        let residual = share_left(&joint, &zvd).unwrap() * (1.0 + 1e-9);
        let found = of_one(&joint, Tolerance { residual: Some(residual), deviation: None }).unwrap();
        let plan = &found.plans[0];
        check_motion(plan, &joint);
        let straight = unshaped(&joint);
        prop_assert!(plan.samples() <= straight.samples() + zvd.duration_in_ticks());
        let most = |plan| joint.modes.iter().map(|known| rings_within(plan, known, 2)).fold(0.0, f64::max);
        let (left, all) = (most(plan), most(&straight));
        prop_assert!(left <= residual * all * 1.05 + SLACK.1, "{left} of {all}");
    }
}

/// A long slow move has few ramps: its steps are short there, and its duration does not matter.
#[test]
fn a_long_slow_move_is_within_the_tolerance() {
    let mut joint = moving(0.0, vec![uncertain(12.0, 0.03, 0.01)]);
    (joint.ends[1], joint.limits.velocity) = (joint.ends[0] + 1.5, 0.1);
    let tolerance = Tolerance {
        residual: Some(0.05),
        deviation: None,
    };
    let found = of_one(&joint, tolerance).unwrap();
    let more = found.duration() - of_one(&joint, Tolerance::default()).unwrap().duration();
    // ZVD adds a period.
    assert!(more < 0.5 / 12.0, "{more} s");
}

/// Every shaped plan is one of its candidates: what leaves as much as ZVD takes less time than ZVD.
#[test]
fn it_is_faster_than_zvd_at_what_zvd_leaves() {
    for (hertz, degrees, std) in [(4.0, 10.0, 0.01), (8.12, 30.0, 0.03), (12.0, 60.0, 0.005)] {
        let joint = moving(degrees, vec![uncertain(hertz, 0.03, std)]);
        let train = Zvd.on_grid(joint.modes[0].mode, PERIOD).unwrap();
        let planner = Planner::new(1).unwrap();
        let plan = plan_shaped(&planner, joint.ends, joint.limits, &train).unwrap();
        let zvd = (plan.plan.samples() - 1) as f64 * PERIOD + train.duration();
        let residual = Some(share_left(&joint, &train).unwrap());
        let found = of_one(
            &joint,
            Tolerance {
                residual,
                deviation: None,
            },
        )
        .unwrap();
        assert!(
            found.duration() < 0.95 * zvd,
            "{} of {zvd} s",
            found.duration()
        );
    }
}

/// A deviation lets each joint cancel its own mode: the move is shorter than on the path.
#[test]
fn a_deviation_is_of_use() {
    let joints = [
        moving(40.0, vec![uncertain(4.0, 0.03, 0.02)]),
        moving(-20.0, vec![uncertain(9.0, 0.02, 0.02)]),
    ];
    let with = |deviation| {
        let residual = Some(0.01);
        fastest(
            &joints,
            Tolerance {
                residual,
                deviation,
            },
            PERIOD,
        )
        .unwrap()
        .duration()
    };
    let [kept, little, much] = [None, Some(2e-4), Some(0.01)].map(with);
    // A tick for steps that lie elsewhere.
    assert!(
        much < kept - 0.02 && little <= kept + PERIOD,
        "{kept} {little} {much} s"
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let joint = moving(30.0, vec![uncertain(8.0, 0.03, 0.01)]);
    for (residual, deviation, what) in [
        (Some(0.0), None, "residual"),
        (Some(f64::NAN), None, "residual"),
        (None, Some(-1.0), "deviation"),
    ] {
        let error = of_one(
            &joint,
            Tolerance {
                residual,
                deviation,
            },
        )
        .unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
    let error = of_one(
        &joint,
        Tolerance {
            residual: Some(1e-9),
            deviation: None,
        },
    )
    .unwrap_err();
    let ToleranceError::Unattainable { needed, .. } = error else {
        panic!("{error}")
    };
    assert!(
        error.to_string().contains("needs a residual of 0."),
        "{error}"
    );
    // What it asks for is enough.
    let allowed = needed.unwrap().residual.map(|share| 1.01 * share);
    let tolerance = Tolerance {
        residual: allowed,
        deviation: None,
    };
    of_one(&joint, tolerance).unwrap();
    let error = of_one(&moving(0.0, vec![]), Tolerance::default()).unwrap_err();
    assert_eq!(error, ToleranceError::NoWay { index: 0 });
}
