//! The vibration of whole moves: a train that is retuned in motion is at no instant worse than one that is kept.

mod common;

use common::{Joint, Move};
use proptest::prelude::*;
use quell_shapers::{
    AdaptiveFilter, Mode, MotionLimits, Retune, SHAPERS, Setpoint, UncertainMode, peak_ratios,
};

/// The bound up to which the field takes vibration for none: 5 % of the unshaped.
const WORSE: f64 = 0.05;

#[derive(Debug)]
struct Case {
    command: Move,
    truth: Mode,
    /// Ratio of the believed frequency to the true one.
    wrong: f64,
    which: usize,
    tick: f64,
    /// When the estimate has converged, periods after the start.
    converged: f64,
    /// Relative error of the estimate's frequency, of which this is the standard deviation.
    error: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Filter {
    Unshaped,
    Kept,
    Adaptive,
}

struct Run {
    sent: Vec<Setpoint>,
    deformation: Vec<f64>,
    /// Amplitude of the vibration at the end.
    left: f64,
}

impl Case {
    fn limits(&self) -> MotionLimits {
        let limits = self.command.limits();
        MotionLimits {
            velocity: limits.velocity.abs(),
            acceleration: limits.acceleration.abs(),
            jerk: limits.jerk.abs(),
        }
    }

    fn in_ticks(&self, periods: f64) -> usize {
        (periods * self.truth.damped_period() / self.tick) as usize
    }

    /// The move, and twelve periods of rest.
    fn ticks(&self) -> usize {
        self.command.ticks(self.tick) + self.in_ticks(12.0)
    }

    fn estimate(&self) -> UncertainMode {
        let omega = self.truth.natural_frequency() * (1.0 + self.error);
        let std = self.error.abs().max(0.003);
        UncertainMode {
            mode: Mode::new(omega, self.truth.damping_ratio()).unwrap(),
            natural_frequency_std: std * omega,
            damping_ratio_std: std,
        }
    }

    fn run(&self, kind: Filter) -> Run {
        let (tick, shaper) = (self.tick, SHAPERS[self.which]);
        let mut filter = AdaptiveFilter::new(tick, 4000, 40000);
        let omega = self.truth.natural_frequency() * self.wrong;
        let wrong = Mode::new(omega, self.truth.damping_ratio()).unwrap();
        if kind != Filter::Unshaped {
            let train = shaper.on_grid(wrong, tick).unwrap();
            filter.install(&train).unwrap();
        }
        let known = self.estimate();
        let train = shaper.on_grid_for(&known, tick).unwrap();
        let request = Retune {
            train: &train,
            modes: &[known],
            limits: self.limits(),
            dead_band: 0.01,
            resolution: 0.0,
        };
        let (quarter, from) = (self.in_ticks(0.25).max(1), self.in_ticks(self.converged));
        let moving = self.command.ticks(tick);
        let mut joint = Joint::new(self.truth, tick);
        let (mut sent, mut deformation) = (Vec::new(), Vec::new());
        for k in 0..self.ticks() {
            let due = k >= from && (k - from).is_multiple_of(quarter) && !filter.is_correcting();
            if kind == Filter::Adaptive && due {
                let planned = |ahead: usize| self.command.at((k + ahead) as f64 * tick);
                filter.retune(&request, moving.saturating_sub(k), planned);
            }
            let out = filter.step(self.command.at((k + 1) as f64 * tick));
            joint.step(out.position);
            sent.push(out);
            deformation.push(joint.delta);
        }
        let left = joint.amplitude();
        Run {
            sent,
            deformation,
            left,
        }
    }

    /// Ticks at which neither the plan nor what the longest train makes of it accelerates.
    fn quiet(&self) -> Vec<bool> {
        let longest = self.in_ticks(2.0 / self.wrong.min(1.0));
        let mut since = usize::MAX;
        let ticks = (1..=self.ticks()).map(|k| self.command.at(k as f64 * self.tick));
        ticks
            .map(|now| {
                since = match now.acceleration == 0.0 {
                    true => since.saturating_add(1),
                    false => 0,
                };
                since > longest
            })
            .collect()
    }
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| value.abs().max(most))
}

/// Phases of a move of `distance` at limits of velocity, acceleration and jerk, as far as it reaches them.
fn planned(distance: f64, [v, a, j]: [f64; 3]) -> Move {
    let jerking = (a / j)
        .min((v / j).sqrt())
        .min((distance / (2.0 * j)).cbrt());
    let reached = j * jerking;
    let way = |even: f64| reached * (jerking + even) * (2.0 * jerking + even);
    let mut even = ((v - reached * jerking) / reached).max(0.0);
    if way(even) > distance {
        // way(even) = distance, a quadratic equation.
        let root = (0.25 * jerking * jerking + distance / reached).sqrt();
        even = (root - 1.5 * jerking).max(0.0);
    }
    let cruise = (distance - way(even)) / (reached * (jerking + even));
    Move {
        distance,
        phases: [jerking, even, cruise.max(0.0)],
    }
}

fn cases() -> impl Strategy<Value = Case> {
    let limits = (20.0..150.0_f64, 200.0..1500.0_f64, 3000.0..30_000.0_f64);
    let mode = (3.0..20.0_f64, 0.01..0.12_f64);
    let estimate = (0.75..1.25_f64, 1.0..6.0_f64, -0.01..0.01_f64);
    let tick = prop::sample::select(vec![0.001, 0.002, 0.004]);
    let convex = SHAPERS
        .iter()
        .enumerate()
        .filter(|(_, shaper)| shaper.is_convex());
    let convex: Vec<_> = convex.map(|(which, _)| which).collect();
    let all = (
        1.0..360.0_f64,
        limits,
        mode,
        estimate,
        tick,
        prop::sample::select(convex),
    );
    all.prop_map(|(degrees, limits, mode, estimate, tick, which)| {
        let limits = [limits.0, limits.1, limits.2].map(f64::to_radians);
        Case {
            command: planned(degrees.to_radians(), limits),
            truth: Mode::from_hertz(mode.0, mode.1).unwrap(),
            wrong: estimate.0,
            which,
            tick,
            converged: estimate.1,
            error: estimate.2,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// Beside the planned acceleration the joint is never deformed by 5 % of the unshaped peak more than with the
    /// train kept, within half a period; what is left at the end is no more either; and no setpoint exceeds a limit.
    #[test]
    fn adaptive_is_never_worse_than_not(case in cases()) {
        let [unshaped, kept, adaptive] =
            [Filter::Unshaped, Filter::Kept, Filter::Adaptive].map(|kind| case.run(kind));
        let most = WORSE * peak(&unshaped.deformation);
        let half = case.in_ticks(0.5);
        let quiet = case.quiet();
        for k in (0..case.ticks()).filter(|k| quiet[*k]) {
            let near = k.saturating_sub(half)..(k + half + 1).min(case.ticks());
            let other = peak(&kept.deformation[near]);
            let own = adaptive.deformation[k].abs();
            prop_assert!(own <= other + most, "{own} at tick {k}, {other} without, {most} allowed");
        }
        prop_assert!(adaptive.left <= kept.left + most, "{} and {}", adaptive.left, kept.left);
        let peaks = peak_ratios(adaptive.sent.iter().copied(), &case.limits(), case.tick);
        prop_assert!(peaks.worst() <= 1.0 + 1e-9, "{peaks:?}");
        let end = case.command.distance;
        prop_assert_eq!(adaptive.sent.last().map(|sent| sent.position), Some(end));
    }
}
