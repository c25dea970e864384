//! Properties over random modes, moves and moments.

mod common;

use common::{Joint, Move};
use proptest::prelude::*;
use quell_shapers::{
    AdaptiveFilter, CORRECTION_OVERSHOOT, ImpulseTrain, Mode, Retune, RetuneOutcome, SHAPERS,
    Setpoint, ShapingFilter, peak_ratios, residual_vibration, shaped_peak_ratios, shaper_by_name,
};

fn modes() -> impl Strategy<Value = Mode> {
    (1.0..40.0_f64, 0.0..0.3_f64).prop_map(|(hertz, xi)| Mode::from_hertz(hertz, xi).unwrap())
}

fn moves() -> impl Strategy<Value = Move> {
    (-2.0..2.0_f64, 0.02..0.2_f64, 0.0..0.2_f64, 0.0..0.3_f64)
        .prop_filter("a move", |values| values.0.abs() > 0.01)
        .prop_map(|(distance, j, a, v)| Move {
            distance,
            phases: [j, a, v],
        })
}

fn positive(limits: quell_shapers::MotionLimits) -> quell_shapers::MotionLimits {
    quell_shapers::MotionLimits {
        velocity: limits.velocity.abs(),
        acceleration: limits.acceleration.abs(),
        jerk: limits.jerk.abs(),
    }
}

proptest! {
    /// Amplitudes add up to 1, times and delays ascend from 0, the design mode is left with nothing
    /// or with a hump's 5 %, and the grid keeps what the train promises.
    #[test]
    fn trains_and_grids(mode in modes(), rate in 200.0..4000.0_f64) {
        for shaper in SHAPERS {
            let train = shaper.design(mode).unwrap();
            let sum: f64 = train.impulses().iter().map(|impulse| impulse.amplitude).sum();
            prop_assert!((sum - 1.0).abs() < 1e-14);
            prop_assert!(train.impulses().is_sorted_by(|a, b| a.time < b.time));
            prop_assert_eq!(train.impulses()[0].time, 0.0);
            let grid = shaper.on_grid(mode, 1.0 / rate).unwrap();
            let sum: f64 = grid.taps().iter().map(|tap| tap.amplitude).sum();
            prop_assert!((sum - 1.0).abs() < 1e-14);
            prop_assert!(grid.taps().is_sorted_by(|a, b| a.delay < b.delay));
            let convex = grid.taps().iter().all(|tap| tap.amplitude >= 0.0);
            prop_assert!(convex || !shaper.is_convex());
            let v = |train: &ImpulseTrain| {
                residual_vibration(train, mode.natural_frequency(), mode.damping_ratio())
            };
            // Scaling the split taps back to sum 1 changes a hump by (omega T_s)^2 / 8 at most.
            let scale = 1.0 + (mode.natural_frequency() / rate).powi(2) / 8.0;
            prop_assert!(v(&grid.to_impulses()) <= v(&train) * scale + 1e-12);
        }
    }

    /// A shaped move keeps the limits that the move keeps, and ends on its target to the bit.
    #[test]
    fn convex_trains_keep_the_limits(mode in modes(), command in moves(), which in 0..7_usize) {
        let tick = 0.002;
        let shaper = SHAPERS.iter().filter(|shaper| shaper.is_convex()).nth(which).unwrap();
        let train = shaper.on_grid(mode, tick).unwrap();
        let mut filter = ShapingFilter::new(tick, 4000);
        filter.install(&train).unwrap();
        let limits = positive(command.limits());
        let end = command.ticks(tick) + train.duration_in_ticks() + 1;
        let sent: Vec<Setpoint> =
            (1..=end).map(|k| filter.step(command.at(k as f64 * tick))).collect();
        let peaks = peak_ratios(sent.iter().copied(), &limits, tick);
        prop_assert!(peaks.worst() <= 1.0 + 1e-9, "{peaks:?}");
        prop_assert!(filter.is_settled());
        prop_assert_eq!(sent[end - 1], Setpoint::at_rest(command.distance));
    }

    /// What UM-ZV makes of a move's limits is told before it is sent, and a stretched move keeps
    /// them.
    #[test]
    fn negative_impulses_are_checked(mode in modes(), command in moves()) {
        let tick = 0.001;
        let umzv = shaper_by_name("umzv").unwrap();
        let train = umzv.on_grid(mode, tick).unwrap();
        let limits = positive(command.limits());
        let sampled = |command: &Move| -> Vec<Setpoint> {
            (0..=command.ticks(tick)).map(|k| command.at(k as f64 * tick)).collect()
        };
        let peaks = shaped_peak_ratios(&train, &sampled(&command), &limits);
        prop_assert!(peaks.worst() <= train.gain() + 1e-9);
        // Three times slower in jerk is always enough: the gain is 3.
        let stretch = train.gain();
        let slower = Move { phases: command.phases.map(|phase| phase * stretch), ..command };
        let slowed = shaped_peak_ratios(&train, &sampled(&slower), &limits);
        prop_assert!(slowed.worst() <= 1.0 + 1e-9, "{slowed:?}");
    }

    /// Retunes at random moments, for random beliefs: continuous, within the limits, exactly on the
    /// target, and nothing is left of the mode that the last one was for.
    #[test]
    fn retunes_are_smooth_and_exact(
        truth in (4.0..15.0_f64, 0.0..0.2_f64),
        command in moves(),
        wrong in 0.75..1.25_f64,
        which in 0..7_usize,
        moments in prop::collection::vec((0.0..1.3_f64, 0.9..1.1_f64), 1..4),
    ) {
        let tick = 0.002;
        let truth = Mode::from_hertz(truth.0, truth.1).unwrap();
        let scaled = |by: f64| Mode::new(truth.natural_frequency() * by, truth.damping_ratio());
        let shaper = SHAPERS.iter().filter(|shaper| shaper.is_convex()).nth(which).unwrap();
        let limits = positive(command.limits());
        let mut filter = AdaptiveFilter::new(tick, 2000, 10000);
        filter.install(&shaper.on_grid(scaled(wrong).unwrap(), tick).unwrap()).unwrap();
        let mut joint = Joint::new(truth, tick);
        let mut unshaped = Joint::new(truth, tick);
        let moving = command.ticks(tick);
        let mut moments: Vec<(usize, f64)> =
            moments.iter().map(|(part, by)| ((part * moving as f64) as usize, *by)).collect();
        moments.sort_by_key(|moment| moment.0);
        let last = moments.len() - 1;
        let final_moment = moments[last].0;
        moments[last].1 = 1.0;
        let (mut k, mut sent, mut refused) = (0, vec![Setpoint::default()], false);
        while k < moving.max(final_moment) + 1 || !filter.is_settled() {
            for (index, (_, by)) in moments.iter().enumerate().filter(|(_, m)| m.0 == k) {
                let mode = scaled(*by).unwrap();
                let train = shaper.on_grid(mode, tick).unwrap();
                let modes = [mode];
                let request = Retune { train: &train, modes: &modes, limits };
                let remaining = moving.saturating_sub(k);
                let outcome =
                    filter.retune(&request, remaining, |i| command.at((k + i) as f64 * tick));
                refused |= index == last && matches!(outcome, RetuneOutcome::Refused(_));
            }
            k += 1;
            let input = command.at(k as f64 * tick);
            let out = filter.step(input);
            joint.step(out.position);
            unshaped.step(input.position);
            sent.push(out);
            prop_assert!(k < 10000);
        }
        joint.step(command.distance);
        unshaped.step(command.distance);
        prop_assert!(!refused);
        let peaks = peak_ratios(sent.iter().copied(), &limits, tick);
        prop_assert!(peaks.worst() <= CORRECTION_OVERSHOOT + 1e-9, "{peaks:?}");
        for pair in sent.windows(2) {
            // As far as the limits let position and velocity change in a tick.
            let bound = CORRECTION_OVERSHOOT * 1.01 * tick;
            prop_assert!((pair[1].position - pair[0].position).abs() <= bound * limits.velocity);
            prop_assert!((pair[1].velocity - pair[0].velocity).abs() <= bound * limits.acceleration);
        }
        prop_assert_eq!(sent[sent.len() - 1], Setpoint::at_rest(command.distance));
        // Rounding of positions of order 1 accumulates over some 1000 ticks; an unshaped vibration
        // may by chance be nothing, so the scale is the larger of it and a thousandth of the move.
        let scale = unshaped.amplitude().max(1e-3 * command.distance.abs());
        prop_assert!(joint.amplitude() < 1e-9 * scale, "{}", joint.amplitude() / scale);
    }
}
