//! Properties over random modes, moves and moments.

mod common;

use common::{Joint, Move};
use proptest::prelude::*;
use quell_shapers::{
    AdaptiveFilter, GridTrain, ImpulseTrain, Mode, MotionLimits, Refusal, Retune, RetuneOutcome,
    SHAPERS, Setpoint, ShapingFilter, UncertainMode, peak_ratios, residual_vibration,
    shaped_peak_ratios, shaper_by_name,
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

fn positive(limits: MotionLimits) -> MotionLimits {
    MotionLimits {
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
            let left = v(&grid.to_impulses());
            prop_assert!(left <= v(&train) * scale + 1e-12);
            let (omega, xi) = (mode.natural_frequency(), mode.damping_ratio());
            prop_assert!((grid.residual_vibration(omega, xi) - left).abs() < 1e-12);
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

    /// The peaks of a move shaped by UM-ZV are told before it is sent, and a stretched move keeps
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
    /// target; and the last one, to the truth, leaves no more of the mode than there would be without it.
    #[test]
    fn retunes_are_smooth_and_exact(
        truth in (4.0..15.0_f64, 0.0..0.2_f64),
        command in moves(),
        wrong in 0.75..1.25_f64,
        which in 0..7_usize,
        moments in prop::collection::vec((0.0..1.3_f64, 0.9..1.1_f64), 1..4),
    ) {
        let truth = Mode::from_hertz(truth.0, truth.1).unwrap();
        let run = Run { tick: 0.002, modes: vec![truth], command, wrong, which, moments };
        run.check()?;
    }

    /// As before for beliefs that are far off, slow, fast and two modes, and any rate of the ticks. What
    /// cannot be corrected is refused, and then the limits and the end are kept all the same.
    #[test]
    fn retunes_far_from_the_truth_keep_limits_and_ends(
        first in (1.5..25.0_f64, 0.0..0.3_f64),
        second in prop::option::of((1.3..3.0_f64, 0.0..0.3_f64)),
        ticks in 10.0..80.0_f64,
        command in moves(),
        wrong in 0.4..2.5_f64,
        which in 0..7_usize,
        moments in prop::collection::vec((0.0..2.0_f64, 0.5..2.0_f64), 1..6),
    ) {
        let mode = |hertz: f64, xi: f64| Mode::from_hertz(hertz, xi).unwrap();
        let second = second.map(|(ratio, xi)| mode(first.0 * ratio, xi));
        let modes: Vec<_> = [mode(first.0, first.1)].into_iter().chain(second).collect();
        // Ticks of the fastest mode's period, which a belief may take for 2.5 times as fast; not slower than
        // robots have.
        let fastest = modes.iter().map(|mode| mode.hertz()).fold(0.0, f64::max);
        let tick = (1.0 / (ticks * fastest)).min(0.008);
        Run { tick, modes, command, wrong, which, moments }.check()?;
    }
}

/// Amplitudes of each mode, shaped and unshaped.
type Amplitudes = Vec<(f64, f64)>;

/// A move during which the train is retuned.
#[derive(Debug)]
struct Run {
    tick: f64,
    modes: Vec<Mode>,
    command: Move,
    /// The frequencies of the first train, as a ratio to those of the modes.
    wrong: f64,
    which: usize,
    /// Retunes: when, as a share of the move, and to which ratio; the last one to 1.
    moments: Vec<(f64, f64)>,
}

impl Run {
    /// The modes with their frequencies changed, and the train for all of them.
    fn belief(&self, by: f64) -> (Vec<Mode>, GridTrain) {
        let mut convex = SHAPERS.iter().filter(|shaper| shaper.is_convex());
        let shaper = convex.nth(self.which).unwrap();
        let scaled = self.modes.iter();
        let scaled = scaled
            .map(|mode| Mode::new(mode.natural_frequency() * by, mode.damping_ratio()).unwrap());
        let scaled: Vec<_> = scaled.collect();
        let trains = scaled
            .iter()
            .map(|mode| shaper.on_grid(*mode, self.tick).unwrap());
        let train = trains.reduce(|all, train| all.convolve(&train).unwrap());
        (scaled, train.unwrap())
    }

    /// Ticks at which to retune, and to what, in order.
    fn moments(&self) -> Vec<(usize, f64)> {
        let moving = self.command.ticks(self.tick) as f64;
        let at = |(part, by): &(f64, f64)| ((part * moving) as usize, *by);
        let mut moments: Vec<_> = self.moments.iter().map(at).collect();
        moments.sort_by_key(|moment| moment.0);
        moments.last_mut().unwrap().1 = 1.0;
        moments
    }

    /// Checks all that was sent, and that the last retune leaves no more than without it.
    fn check(&self) -> Result<(), TestCaseError> {
        // A correction lasts seven periods and a quarter at most, of a mode as it is believed.
        let beliefs = self.moments.iter().map(|moment| moment.1);
        let slowest = beliefs.fold(self.wrong.min(1.0), f64::min);
        let soon = self.with_and_without(12.0)?;
        let settled = match soon {
            Some(soon) => Some(soon),
            None => self.with_and_without(12.0 / slowest)?,
        };
        prop_assert!(settled.is_some(), "a correction runs on");
        let (with, without) = settled.unwrap();
        for ((left, unshaped), (before, _)) in with.into_iter().zip(without) {
            // An unshaped vibration may by chance be nothing: then a thousandth of the move is the scale. The envelope
            // is compared within half a period, and each mode of several has its share of the dead band.
            let scale = unshaped.max(before).max(1e-3 * self.command.distance.abs());
            let half = (self.modes[0].decay_rate() * 0.5 * self.modes[0].damped_period()).exp();
            let allowed = before * half + 0.02 * scale * self.modes.len() as f64;
            prop_assert!(left <= allowed, "{left} of {unshaped}, {before} without");
        }
        Ok(())
    }

    /// What the move leaves with the last retune and without it, so many periods after the command; nothing where
    /// one of them has not settled by then.
    fn with_and_without(
        &self,
        wait: f64,
    ) -> Result<Option<(Amplitudes, Amplitudes)>, TestCaseError> {
        let moments = self.moments();
        let with = self.left(&moments, wait)?;
        let without = self.left(&moments[..moments.len() - 1], wait)?;
        Ok(with.zip(without))
    }

    /// Amplitudes that a move with retunes leaves of each mode, and that the unshaped one leaves, so many periods after
    /// the command; nothing where it has not settled by then.
    fn left(
        &self,
        moments: &[(usize, f64)],
        wait: f64,
    ) -> Result<Option<Amplitudes>, TestCaseError> {
        let Self { tick, command, .. } = *self;
        let limits = positive(command.limits());
        let mut filter = AdaptiveFilter::new(tick, 6000, 20000);
        filter.install(&self.belief(self.wrong).1).unwrap();
        let joints = || self.modes.iter().map(|mode| Joint::new(*mode, tick));
        let mut joints: Vec<_> = joints().zip(joints()).collect();
        let moving = command.ticks(tick);
        let mut sent = vec![Setpoint::default()];
        // As long with the last retune as without it.
        let longest = self.moments().last().unwrap().0.max(moving);
        let periods = |count: f64| (count * self.modes[0].damped_period() / tick) as usize;
        let end = longest + periods(wait);
        for k in 0..end {
            for (_, by) in moments.iter().filter(|moment| moment.0 == k) {
                let (modes, train) = self.belief(*by);
                let exact = |mode| UncertainMode {
                    mode,
                    natural_frequency_std: 0.0,
                    damping_ratio_std: 0.0,
                };
                let modes: Vec<_> = modes.into_iter().map(exact).collect();
                let request = Retune {
                    train: &train,
                    modes: &modes,
                    limits,
                    dead_band: 0.01,
                    resolution: 0.0,
                };
                let planned = |i| command.at((k + i) as f64 * tick);
                let outcome = filter.retune(&request, moving.saturating_sub(k), planned);
                let refused = matches!(
                    outcome,
                    RetuneOutcome::Refused(Refusal::Limits | Refusal::NotWorth(_) | Refusal::Busy)
                );
                let done = !matches!(outcome, RetuneOutcome::Refused(_));
                prop_assert!(done || refused, "{outcome:?}");
            }
            let input = command.at((k + 1) as f64 * tick);
            let out = filter.step(input);
            for (shaped, unshaped) in &mut joints {
                shaped.step(out.position);
                unshaped.step(input.position);
            }
            sent.push(out);
        }
        if !filter.is_settled() {
            return Ok(None);
        }
        self.check_sent(&sent, &limits)?;
        let amplitudes = joints
            .iter()
            .map(|(shaped, unshaped)| (shaped.amplitude(), unshaped.amplitude()));
        Ok(Some(amplitudes.collect()))
    }

    /// Limits, continuity and the end.
    fn check_sent(&self, sent: &[Setpoint], limits: &MotionLimits) -> Result<(), TestCaseError> {
        let peaks = peak_ratios(sent.iter().copied(), limits, self.tick);
        prop_assert!(peaks.worst() <= 1.0 + 1e-9, "{peaks:?}");
        // What is within a limit at both ends of a tick and changes by at most `rate` is above it by
        // `rate tick / 2` at most between, in the mean by half of that.
        let most = |limit: f64, rate: f64| self.tick * (limit + rate * self.tick / 4.0) + 1e-12;
        let velocity = most(limits.velocity, limits.acceleration);
        let acceleration = most(limits.acceleration, limits.jerk);
        for pair in sent.windows(2) {
            prop_assert!((pair[1].position - pair[0].position).abs() <= velocity);
            prop_assert!((pair[1].velocity - pair[0].velocity).abs() <= acceleration);
        }
        let end = sent[sent.len() - 1];
        prop_assert_eq!(end, Setpoint::at_rest(self.command.distance));
        Ok(())
    }
}

/// Beside a mode that rings for long one that damps well decides nothing of what is left.
#[test]
fn a_mode_that_damps_well_does_not_hide_the_other() {
    let mode = |hertz, xi| Mode::from_hertz(hertz, xi).unwrap();
    let run = Run {
        tick: 0.008,
        modes: vec![mode(2.9447314953, 0.0), mode(5.8688292781, 0.250625444)],
        command: Move {
            distance: 0.962275863,
            phases: [0.02, 0.0, 0.0],
        },
        wrong: 0.4,
        which: 0,
        moments: vec![(1.3563, 0.5), (0.0, 0.5)],
    };
    run.check().unwrap();
}
