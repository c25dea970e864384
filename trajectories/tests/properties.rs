//! Random moves of 1 to 7 axes: limits, exact ends, continuity, a common end.

use proptest::prelude::*;
use quell_trajectories::{AxisState, Brake, Limits, Planner, Trajectory};

/// Ruckig states its own error of the limits as 1e-12; a state adds the rounding of its sums, so
/// this is a thousand roundings relative to the limit.
const RELATIVE: f64 = 1e-12;

#[derive(Clone, Copy, Debug)]
struct Axis {
    limits: Limits,
    from: AxisState,
    to: AxisState,
}

/// Limits over three decades, as from a slow gantry to a fast small robot.
fn limits() -> impl Strategy<Value = Limits> {
    let decades = (-1.0..1.0_f64, -0.5..1.5_f64, 0.0..2.5_f64);
    decades.prop_map(|(velocity, acceleration, jerk)| Limits {
        velocity: 10.0_f64.powf(velocity),
        acceleration: 10.0_f64.powf(acceleration),
        jerk: 10.0_f64.powf(jerk),
    })
}

fn axis(moving: bool) -> impl Strategy<Value = Axis> {
    let shares = (-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64);
    (limits(), -3.0..3.0_f64, -3.0..3.0_f64, shares).prop_map(move |(limits, from, to, share)| {
        let state = |position, velocity: f64, acceleration: f64| {
            if moving {
                inside(position, velocity, acceleration, limits)
            } else {
                AxisState::at_rest(position)
            }
        };
        Axis {
            limits,
            from: state(from, share.0, share.1),
            to: state(to, share.2, share.3),
        }
    })
}

/// A state from which no limit need be broken, before or after: the velocity leaves room for the
/// change `a^2 / 2 j` that the acceleration takes to vanish.
fn inside(position: f64, velocity: f64, acceleration: f64, limits: Limits) -> AxisState {
    let reach = limits
        .acceleration
        .min((limits.velocity * limits.jerk).sqrt());
    let acceleration = acceleration * reach;
    let room = limits.velocity - acceleration * acceleration / (2.0 * limits.jerk);
    AxisState {
        position,
        velocity: velocity * room,
        acceleration,
    }
}

fn problem() -> impl Strategy<Value = Vec<Axis>> {
    any::<bool>().prop_flat_map(|moving| prop::collection::vec(axis(moving), 1..=7))
}

fn columns(axes: &[Axis]) -> (Vec<AxisState>, Vec<AxisState>, Vec<Limits>) {
    let pick = |axis: &Axis| (axis.from, axis.to, axis.limits);
    let mut columns = (vec![], vec![], vec![]);
    for (from, to, limits) in axes.iter().map(pick) {
        columns.0.push(from);
        columns.1.push(to);
        columns.2.push(limits);
    }
    columns
}

fn within_limits(trajectory: &Trajectory, limits: &[Limits]) -> Result<(), TestCaseError> {
    for (axis, limit) in trajectory.axes().iter().zip(limits) {
        let slack = 1.0 + RELATIVE;
        for phase in axis.phases() {
            // A phase of length d knows its jerk to the rounding of acceleration over d.
            let rounding = RELATIVE * (limit.acceleration + limit.jerk * trajectory.duration());
            prop_assert!(phase.jerk.abs() <= limit.jerk * slack + rounding / phase.duration);
            let end = phase.state.after(phase.duration, phase.jerk);
            // Where the acceleration crosses zero the velocity has its extremum.
            let crossing = -phase.state.acceleration / phase.jerk;
            let inner = (0.0 < crossing && crossing < phase.duration)
                .then(|| phase.state.after(crossing, phase.jerk));
            for state in [Some(phase.state), Some(end), inner].into_iter().flatten() {
                let rounding = rounding * trajectory.duration().max(1.0);
                prop_assert!(state.velocity.abs() <= limit.velocity * slack + rounding);
                prop_assert!(state.acceleration.abs() <= limit.acceleration * slack + rounding);
            }
        }
    }
    Ok(())
}

/// Each phase ends where the next begins, and the last ends at the end state, both within what
/// Ruckig states for its ends (1e-8 in position and velocity, 1e-10 in acceleration).
fn continuous(trajectory: &Trajectory) -> Result<(), TestCaseError> {
    for axis in trajectory.axes() {
        prop_assert!(axis.phases().len() <= 9, "{} phases", axis.phases().len());
        let starts = axis
            .phases()
            .iter()
            .map(|phase| phase.state)
            .skip(1)
            .chain([axis.end()]);
        for (phase, next) in axis.phases().iter().zip(starts) {
            let end = phase.state.after(phase.duration, phase.jerk);
            prop_assert!((end.position - next.position).abs() <= 2e-8);
            prop_assert!((end.velocity - next.velocity).abs() <= 2e-8);
            prop_assert!((end.acceleration - next.acceleration).abs() <= 2e-10);
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn a_move_keeps_its_limits_and_ends_exactly(axes in problem()) {
        let (from, to, limits) = columns(&axes);
        let trajectory = Planner::new(axes.len()).unwrap().plan(&from, &to, &limits).unwrap();
        within_limits(&trajectory, &limits)?;
        continuous(&trajectory)?;
        prop_assert_eq!(trajectory.end(), to.clone());
        prop_assert_eq!(trajectory.state_at(trajectory.duration()), to.clone());

        let sampled = trajectory.sample(0.001).unwrap();
        let last = sampled.samples() - 1;
        prop_assert!(last as f64 * 0.001 >= trajectory.duration());
        prop_assert!((last as f64 - 1.0) * 0.001 < trajectory.duration());
        for (index, target) in to.iter().enumerate() {
            prop_assert_eq!(sampled.state(index, last), Some(*target));
            prop_assert_eq!(sampled.state(index, usize::MAX), Some(*target));
            // The samples of an acceleration whose slope is limited.
            for pair in sampled.accelerations(index).windows(2) {
                let allowed = limits[index].jerk * 0.001 * (1.0 + 1e-6) + 1e-9;
                prop_assert!((pair[1] - pair[0]).abs() <= allowed);
            }
        }
    }

    #[test]
    fn a_new_target_in_mid_move_is_continuous(
        axes in problem(),
        share in 0.0..1.0_f64,
        new in -3.0..3.0_f64,
    ) {
        let (from, to, limits) = columns(&axes);
        let planner = Planner::new(axes.len()).unwrap();
        let running = planner.plan(&from, &to, &limits).unwrap();
        let time = share * running.duration();
        let targets: Vec<_> =
            to.iter().map(|state| AxisState::at_rest(state.position + new)).collect();
        let next = planner.plan(&running.state_at(time), &targets, &limits).unwrap();
        prop_assert_eq!(next.state_at(0.0), running.state_at(time));
        prop_assert_eq!(next.end(), targets);
        within_limits(&next, &limits)?;
        continuous(&next)?;
    }

    /// In closed form, where the planner asks Ruckig.
    #[test]
    fn a_state_tells_where_its_quickest_stop_ends(axes in problem(), slower in 0.05..1.0_f64) {
        let planner = Planner::new(1).unwrap();
        for Axis { from, limits, .. } in axes {
            prop_assert!(from.keeps(limits));
            let end = planner.plan_stop(&[from], &[limits]).unwrap().end()[0].position;
            prop_assert!((from.stops_at(limits) - end).abs() < 1e-7, "{from:?} {end}");
            let faster = AxisState { velocity: 1.01 * limits.velocity, ..from };
            prop_assert!(!faster.keeps(limits));
            let slowed = limits.slowed(slower);
            if from.keeps(slowed) {
                let end = planner.plan_stop(&[from], &[slowed]).unwrap().end()[0].position;
                prop_assert!((from.stops_at(slowed) - end).abs() < 1e-7, "{from:?} {end}");
            }
        }
    }

    /// Whatever a motion does within the limits, as long as it goes on to a side it will reach there what it had to before.
    #[test]
    fn a_motion_reaches_at_least_what_its_state_tells(
        axes in problem(),
        jerks in prop::collection::vec(-1.0..=1.0_f64, 40),
    ) {
        for Axis { from, limits, .. } in axes {
            let Limits { velocity, acceleration, jerk } = limits;
            let step = 0.1 * (acceleration / jerk).min((velocity / jerk).sqrt());
            let mut before = from;
            for share in &jerks {
                let after = (before.acceleration + share * jerk * step).clamp(-acceleration, acceleration);
                let now = before.after(step, (after - before.acceleration) / step);
                let (was, is) = (before.reaches(limits), now.reaches(limits));
                let turns = before.acceleration * now.acceleration < 0.0;
                if before.velocity >= 0.0 && now.velocity >= 0.0 && !turns {
                    prop_assert!(is[1] >= was[1] - 1e-9, "{before:?} {now:?}");
                }
                if before.velocity <= 0.0 && now.velocity <= 0.0 && !turns {
                    prop_assert!(is[0] <= was[0] + 1e-9, "{before:?} {now:?}");
                }
                before = now;
            }
        }
    }

    #[test]
    fn a_brake_stays_within_limits_and_range(
        axes in problem(),
        upward in any::<bool>(),
        room in 0.0..=1.0_f64,
    ) {
        for Axis { from, limits, .. } in axes {
            let [lowest, highest] = from.reaches(limits);
            let room = room * limits.acceleration.powi(3) / limits.jerk.powi(2);
            let range = match upward {
                true => [f64::NEG_INFINITY, highest + room],
                false => [lowest - room, f64::INFINITY],
            };
            let brake = Brake::within(from, limits, range);
            let period = (brake.duration() / 500.0).max(1e-6);
            let states: Vec<_> = (0..=501).map(|k| brake.after(f64::from(k) * period)).collect();
            prop_assert_eq!(states[0].velocity, from.velocity);
            for pair in states.windows(2) {
                let [before, now] = [pair[0], pair[1]];
                prop_assert!(range[0] - 1e-9 <= now.position && now.position <= range[1] + 1e-9);
                prop_assert!(now.acceleration.abs() <= limits.acceleration * (1.0 + 1e-9));
                let jerk = (now.acceleration - before.acceleration) / period;
                let rounding = 1e-9 + 1e-12 * limits.acceleration / period;
                prop_assert!(jerk.abs() <= limits.jerk * (1.0 + 1e-9) + rounding);
                let follows = before.after(period, jerk).position - now.position;
                prop_assert!(follows.abs() <= limits.jerk * period.powi(3) + 1e-12);
            }
            prop_assert_eq!(states[501], AxisState::at_rest(states[501].position));
            prop_assert!(brake.after(0.999_999_9 * brake.duration()).velocity.abs() < 1e-5 * limits.velocity);
        }
    }

    #[test]
    fn a_stop_ends_at_rest_as_quickly_as_the_slowest_axis_can(
        axes in problem(),
        share in 0.0..1.0_f64,
    ) {
        let (from, to, limits) = columns(&axes);
        let planner = Planner::new(axes.len()).unwrap();
        let running = planner.plan(&from, &to, &limits).unwrap();
        let now = running.state_at(share * running.duration());
        let stop = planner.plan_stop(&now, &limits).unwrap();
        continuous(&stop)?;
        prop_assert!(stop.end().iter().all(|end| end.velocity == 0.0 && end.acceleration == 0.0));
        let alone = |index: usize| {
            let one = Planner::new(1).unwrap();
            one.plan_stop(&now[index..=index], &limits[index..=index]).unwrap().duration()
        };
        let slowest = (0..axes.len()).map(alone).fold(0.0, f64::max);
        prop_assert!((stop.duration() - slowest).abs() <= 1e-9 * slowest.max(1.0));
    }

    #[test]
    fn a_start_beyond_its_limits_is_brought_back(axes in problem(), excess in 1.0..3.0_f64) {
        let (mut from, to, limits) = columns(&axes);
        for (state, limit) in from.iter_mut().zip(&limits) {
            state.velocity = excess * limit.velocity;
        }
        let trajectory = Planner::new(axes.len()).unwrap().plan(&from, &to, &limits).unwrap();
        prop_assert_eq!(trajectory.end(), to);
        continuous(&trajectory)?;
        for (axis, limit) in trajectory.axes().iter().zip(&limits) {
            let mut back = false;
            for phase in axis.phases() {
                let inside = phase.state.velocity.abs() <= limit.velocity * (1.0 + 1e-9);
                prop_assert!(inside || !back, "beyond the limit again");
                back |= inside;
            }
        }
    }

    #[test]
    fn whatever_comes_in_nothing_crashes(
        lengths in (0..10_usize, 0..10_usize, 0..10_usize, 0..10_usize),
        values in prop::collection::vec(any::<f64>(), 9),
        place in 0..9_usize,
    ) {
        let sane = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 2.0, 10.0];
        // Half of the entries sane, so that some problems get past the first check.
        let value = |k: usize| if k == place { values[k] } else { sane[k] };
        let from = AxisState { position: value(0), velocity: value(1), acceleration: value(2) };
        let to = AxisState { position: value(3), velocity: value(4), acceleration: value(5) };
        let limit = Limits { velocity: value(6), acceleration: value(7), jerk: value(8) };
        if let Ok(planner) = Planner::new(lengths.0) {
            let (from, to, limit) =
                (vec![from; lengths.1], vec![to; lengths.2], vec![limit; lengths.3]);
            let planned = planner.plan(&from, &to, &limit);
            let even = lengths.1 == lengths.0 && lengths.2 == lengths.0 && lengths.3 == lengths.0;
            prop_assert!(even || planned.is_err());
            let _ = planner.plan_stop(&from, &limit);
        }
    }
}
