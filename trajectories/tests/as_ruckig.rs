//! A plan is Ruckig's own, at any time in between, whatever was planned before.

use proptest::prelude::*;
use quell_trajectories::{AxisState, Limits, Planner};

/// The accuracy of Ruckig's own profiles (`profile.hpp`), in position and velocity; twice, for its error and ours.
const PRECISION: f64 = 2e-8;

/// A start, a target and limits. Half of the targets and starts are at rest.
type Axis = (AxisState, AxisState, Limits);

fn axis() -> impl Strategy<Value = Axis> {
    let decades = (-1.0..1.0_f64, -0.5..1.5_f64, 0.0..4.0_f64);
    let limits = decades.prop_map(|(velocity, acceleration, jerk)| Limits {
        velocity: 10.0_f64.powf(velocity),
        acceleration: 10.0_f64.powf(acceleration),
        jerk: 10.0_f64.powf(jerk),
    });
    let shares = || (any::<bool>(), -3.0..3.0_f64, -0.5..0.5_f64, -0.5..0.5_f64);
    (limits, shares(), shares()).prop_map(|(limits, from, to)| {
        // Slow enough that the acceleration can vanish before the velocity is at its limit.
        let reach = limits
            .acceleration
            .min((limits.velocity * limits.jerk).sqrt());
        let state = |(moving, position, velocity, acceleration): (bool, f64, f64, f64)| {
            let share = if moving { 1.0 } else { 0.0 };
            AxisState {
                position,
                velocity: share * velocity * limits.velocity,
                acceleration: share * acceleration * reach,
            }
        };
        let (from, mut to) = (state(from), state(to));
        to.position = from.position + 10.0_f64.powf(-3.0 + to.position);
        (from, to, limits)
    })
}

fn solve(axes: &[Axis]) -> ruckig::Trajectory {
    let mut input = ruckig::InputParameter::new(axes.len());
    for (i, (from, to, limits)) in axes.iter().enumerate() {
        input.current_position[i] = from.position;
        input.current_velocity[i] = from.velocity;
        input.current_acceleration[i] = from.acceleration;
        input.target_position[i] = to.position;
        input.target_velocity[i] = to.velocity;
        input.target_acceleration[i] = to.acceleration;
        input.max_velocity[i] = limits.velocity;
        input.max_acceleration[i] = limits.acceleration;
        input.max_jerk[i] = limits.jerk;
    }
    let mut trajectory = ruckig::Trajectory::new_direct(axes.len());
    let mut solver = ruckig::Ruckig::new_direct_and_offline(axes.len());
    assert_eq!(
        solver.calculate(&mut input, &mut trajectory),
        ruckig::Result::Working
    );
    trajectory
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn every_state_is_ruckigs(axes in prop::collection::vec(axis(), 1..=7)) {
        let (states, limits): (Vec<_>, Vec<_>) =
            axes.iter().map(|&(from, to, limits)| ((from, to), limits)).unzip();
        let (from, to): (Vec<_>, Vec<_>) = states.into_iter().unzip();
        let plan = Planner::new(axes.len()).unwrap().plan(&from, &to, &limits).unwrap();
        let expected = solve(&axes);
        // Positions count from the start in a plan, which rounds differently.
        prop_assert!((plan.duration() - expected.get_duration()).abs() <= 1e-9);
        for k in 0..50 {
            let time = (f64::from(k) + 0.37) / 50.0 * plan.duration();
            let (positions, velocities, accelerations) = expected.at_time(time);
            for (index, state) in plan.state_at(time).into_iter().enumerate() {
                prop_assert!((state.position - positions[index]).abs() <= PRECISION);
                prop_assert!((state.velocity - velocities[index]).abs() <= PRECISION);
                // A pulse of the acceleration that changes the velocity by less is within it, too.
                let pulse = (limits[index].jerk * PRECISION).sqrt();
                prop_assert!((state.acceleration - accelerations[index]).abs() <= pulse);
            }
        }
    }

    #[test]
    fn what_was_planned_before_changes_nothing(axes in prop::collection::vec(axis(), 2)) {
        let plan = |(from, to, limits): Axis| {
            let planner = Planner::new(1).unwrap();
            (planner.plan(&[from], &[to], &[limits]), planner.plan_stop(&[from], &[limits]))
        };
        let alone = std::thread::scope(|scope| scope.spawn(|| plan(axes[1])).join().unwrap());
        plan(axes[0]).0.unwrap();
        prop_assert_eq!(plan(axes[1]), alone);
    }
}
