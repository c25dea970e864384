//! Refusals, and their words.

use quell_trajectories::{AxisState, Limits, Planner, Trajectory};

const LIMIT: Limits = Limits {
    velocity: 1.0,
    acceleration: 2.0,
    jerk: 10.0,
};
const REST: AxisState = AxisState::at_rest(0.0);

fn planner() -> Planner {
    Planner::new(2).unwrap()
}

fn refused(from: AxisState, to: AxisState, limit: Limits) -> String {
    planner()
        .plan(&[REST, from], &[REST, to], &[LIMIT, limit])
        .unwrap_err()
        .to_string()
}

#[test]
fn the_axis_and_the_value_are_named() {
    let to = AxisState::at_rest(1.0);
    let rule = "it must be above 0 and below 1e9";
    for (value, text) in [
        (0.0, "0"),
        (-1.5, "-1.5"),
        (f64::NAN, "NaN"),
        (f64::INFINITY, "inf"),
    ] {
        let name = "axis 1";
        for (limit, what) in [
            (
                Limits {
                    velocity: value,
                    ..LIMIT
                },
                "velocity",
            ),
            (
                Limits {
                    acceleration: value,
                    ..LIMIT
                },
                "acceleration",
            ),
            (
                Limits {
                    jerk: value,
                    ..LIMIT
                },
                "jerk",
            ),
        ] {
            let expected = format!("{name}: {what} limit is {text}, {rule}");
            assert_eq!(refused(REST, to, limit), expected);
        }
    }
    assert_eq!(
        refused(AxisState::at_rest(f64::NAN), to, LIMIT),
        "axis 1: start position is NaN, it must be finite and within +-1e9"
    );
    assert_eq!(
        refused(
            REST,
            AxisState {
                acceleration: f64::NEG_INFINITY,
                ..to
            },
            LIMIT
        ),
        "axis 1: target acceleration is -inf, it must be finite and within +-1e9"
    );
}

#[test]
fn a_target_beyond_its_limits_is_refused() {
    let to = AxisState {
        velocity: -1.25,
        ..REST
    };
    assert_eq!(
        refused(REST, to, LIMIT),
        "axis 1: target velocity -1.25 is beyond the limit 1"
    );
    // 0.9 + 2^2 / (2 * 10) = 1.1: it was faster before.
    let to = AxisState {
        velocity: 0.9,
        acceleration: -2.0,
        ..REST
    };
    assert!(refused(REST, to, LIMIT).contains("from a velocity of 1.1, beyond the limit 1"));
}

#[test]
fn lengths_are_checked_before_ruckig_sees_them() {
    for axes in [0, 8, usize::MAX] {
        assert_eq!(
            Planner::new(axes).unwrap_err().to_string(),
            format!("a move has 1 to 7 axes, not {axes}")
        );
    }
    let planner = planner();
    let error = planner
        .plan(&[REST], &[REST, REST], &[LIMIT, LIMIT])
        .unwrap_err();
    assert_eq!(error.to_string(), "start states: 1 entries for 2 axes");
    let error = planner
        .plan(&[REST, REST], &[REST; 3], &[LIMIT, LIMIT])
        .unwrap_err();
    assert_eq!(error.to_string(), "target states: 3 entries for 2 axes");
    let error = planner.plan_stop(&[REST, REST], &[]).unwrap_err();
    assert_eq!(error.to_string(), "limits: 0 entries for 2 axes");
}

#[test]
fn too_long_is_said_and_so_is_a_bad_period() {
    let planner = Planner::new(1).unwrap();
    let far = AxisState::at_rest(1e4);
    let error = planner
        .plan(&[REST], &[far], &[LIMIT])
        .unwrap_err()
        .to_string();
    assert!(error.contains("longer than the 7600 s"), "{error}");

    let trajectory = planner
        .plan(&[REST], &[AxisState::at_rest(1.0)], &[LIMIT])
        .unwrap();
    for period in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(trajectory.sample(period).is_err());
    }
    assert!(
        trajectory
            .sample(1e-300)
            .unwrap_err()
            .to_string()
            .contains("more than 10000000")
    );
}

#[test]
fn plans_may_cross_threads() {
    fn shared<T: Send + Sync>(_: &T) {}
    let planner = Planner::new(1).unwrap();
    shared(&planner);
    let plan = move || {
        planner
            .plan(&[REST], &[AxisState::at_rest(1.0)], &[LIMIT])
            .unwrap()
    };
    let trajectory: Trajectory = std::thread::spawn(plan).join().unwrap();
    shared(&trajectory);
    shared(&trajectory.sample(0.01).unwrap());
}
