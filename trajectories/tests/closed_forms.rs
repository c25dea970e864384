//! Durations and states against formulas that can be written down by hand.

use quell_trajectories::{AxisState, Limits, Planner, Trajectory};

/// Ruckig works in double precision on numbers near one: some hundred roundings.
const TOLERANCE: f64 = 1e-12;

fn limits(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    Limits {
        velocity,
        acceleration,
        jerk,
    }
}

fn rest_to_rest(distance: f64, limit: Limits) -> Trajectory {
    let (from, to) = (AxisState::at_rest(0.0), AxisState::at_rest(distance));
    Planner::new(1)
        .unwrap()
        .plan(&[from], &[to], &[limit])
        .unwrap()
}

fn close(found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(
        error <= TOLERANCE * expected.abs().max(1.0),
        "{found} is not {expected}"
    );
}

#[test]
fn val_thirty_degrees_with_all_seven_phases() {
    // v >= a^2 / j and d >= v (v / a + a / j): T = d / v + v / a + a / j.
    let distance = 30.0_f64.to_radians();
    let (v, a, j) = (0.8, 4.0, 60.0);
    let trajectory = rest_to_rest(distance, limits(v, a, j));
    close(trajectory.duration(), distance / v + v / a + a / j);

    let phases = trajectory.axes()[0].phases();
    let ramp = a / j;
    let hold = v / a - a / j;
    let cruise = distance / v - v / a - a / j;
    let expected = [
        (ramp, j),
        (hold, 0.0),
        (ramp, -j),
        (cruise, 0.0),
        (ramp, -j),
        (hold, 0.0),
        (ramp, j),
    ];
    assert_eq!(phases.len(), 7);
    for (phase, (duration, jerk)) in phases.iter().zip(expected) {
        close(phase.duration, duration);
        // The jerk is a quotient of rounded states: acceleration's rounding over the duration.
        assert!(
            (phase.jerk - jerk).abs() <= 1e-11 * j,
            "{} is not {jerk}",
            phase.jerk
        );
    }
}

#[test]
fn val_no_cruise() {
    // d < v (v / a + a / j): the peak velocity p solves p (p / a + a / j) = d, T = 2 (p/a + a/j).
    let (distance, a, j) = (30.0_f64.to_radians(), 20.0, 400.0);
    let trajectory = rest_to_rest(distance, limits(10.0, a, j));
    let b = a * a / j;
    let peak = 0.5 * ((b * b + 4.0 * a * distance).sqrt() - b);
    close(trajectory.duration(), 2.0 * (peak / a + a / j));
    close(
        trajectory.axes()[0]
            .state_at(0.5 * trajectory.duration())
            .velocity,
        peak,
    );
}

#[test]
fn val_jerk_alone() {
    // Neither limit is reached: four equal phases of (d / 2 j)^(1/3).
    let (distance, j) = (30.0_f64.to_radians(), 60.0);
    let trajectory = rest_to_rest(distance, limits(100.0, 1000.0, j));
    let phase = (distance / (2.0 * j)).cbrt();
    close(trajectory.duration(), 4.0 * phase);
    let middle = trajectory.axes()[0].state_at(0.5 * trajectory.duration());
    close(middle.position, 0.5 * distance);
    close(middle.velocity, j * phase * phase);
}

#[test]
fn val_stop() {
    let limit = limits(3.0, 4.0, 10.0);
    let planner = Planner::new(1).unwrap();
    // 3 >= a^2 / j = 1.6: v / a + a / j; 1 is less: 2 sqrt(v / j).
    for (velocity, duration) in [
        (3.0, 3.0 / 4.0 + 4.0 / 10.0),
        (1.0, 2.0 * (1.0_f64 / 10.0).sqrt()),
    ] {
        let from = AxisState {
            position: 0.25,
            velocity,
            acceleration: 0.0,
        };
        let stop = planner.plan_stop(&[from], &[limit]).unwrap();
        close(stop.duration(), duration);
        let end = stop.end()[0];
        close(end.position, 0.25 + 0.5 * velocity * duration);
        assert_eq!((end.velocity, end.acceleration), (0.0, 0.0));
    }
}

#[test]
fn val_the_slowest_axis_sets_the_pace() {
    let limit = limits(1.0, 2.0, 10.0);
    let from = [AxisState::at_rest(0.0); 3];
    let to = [0.1, 1.0, -0.4].map(AxisState::at_rest);
    let trajectory = Planner::new(3)
        .unwrap()
        .plan(&from, &to, &[limit; 3])
        .unwrap();
    close(trajectory.duration(), 1.0 + 0.5 + 0.2);
    for (axis, target) in trajectory.axes().iter().zip(to) {
        // Still on its way a hundredth of the duration before the end, and there at the end.
        assert!(axis.state_at(0.99 * trajectory.duration()).velocity.abs() > 0.0);
        assert_eq!(axis.end(), target);
    }
}

#[test]
fn a_move_to_where_it_is_has_one_sample() {
    let trajectory = rest_to_rest(0.0, limits(1.0, 1.0, 1.0));
    assert_eq!(trajectory.duration(), 0.0);
    let sampled = trajectory.sample(0.001).unwrap();
    assert_eq!((sampled.samples(), sampled.positions(0)), (1, &[0.0][..]));
}
