//! Retuning in motion against a mode simulated in closed form.

mod common;

use common::{Joint, Move};
use quell_shapers::{
    AdaptiveFilter, CORRECTION_OVERSHOOT, Correction, GridTrain, Mode, MotionLimits, PeakRatios,
    Retune, RetuneOutcome, Setpoint, peak_ratios, shaper_by_name,
};

const XI: f64 = 0.084;

struct Run {
    sent: Vec<Setpoint>,
    /// Residual over that of the unshaped move at the same instant.
    left: f64,
    corrections: Vec<Correction>,
    peaks: PeakRatios,
}

struct Scenario<'a> {
    command: Move,
    tick: f64,
    truth: Mode,
    belief: GridTrain,
    /// When the filter is retuned, ticks, and for which mode.
    retunes: &'a [(usize, Mode)],
    shaper: &'a str,
    limits: MotionLimits,
}

impl Scenario<'_> {
    fn run(&self) -> Run {
        let mut filter = AdaptiveFilter::new(self.tick, 4000, 20000);
        filter.install(&self.belief).unwrap();
        let (mut shaped, mut unshaped) = (
            Joint::new(self.truth, self.tick),
            Joint::new(self.truth, self.tick),
        );
        let (mut sent, mut corrections) = (Vec::new(), Vec::new());
        let input = |k: usize| self.command.at(k as f64 * self.tick);
        let moving = self.command.ticks(self.tick);
        let last = self.retunes.last().map_or(0, |retune| retune.0);
        let mut k = 0;
        while k < moving.max(last + 2) || !filter.is_settled() {
            for (_, mode) in self.retunes.iter().filter(|(when, _)| *when == k) {
                let shaper = shaper_by_name(self.shaper).unwrap();
                let train = shaper.on_grid(*mode, self.tick).unwrap();
                let modes = [*mode];
                let request = Retune {
                    train: &train,
                    modes: &modes,
                    limits: self.limits,
                };
                let remaining = moving.saturating_sub(k);
                match filter.retune(&request, remaining, |ahead| input(k + ahead)) {
                    RetuneOutcome::Corrected(correction) => corrections.push(correction),
                    other => panic!("{other:?}"),
                }
            }
            k += 1;
            let out = filter.step(input(k));
            shaped.step(out.position);
            unshaped.step(input(k).position);
            sent.push(out);
            assert!(k < 20000, "does not settle");
        }
        // The last increment still shapes the slope of the next tick.
        shaped.step(sent.last().unwrap().position);
        unshaped.step(input(k + 1).position);
        let left = shaped.amplitude() / unshaped.amplitude();
        let peaks = peak_ratios(sent.iter().copied(), &self.limits, self.tick);
        Run {
            sent,
            left,
            corrections,
            peaks,
        }
    }
}

fn scenario<'a>(
    wrong: f64,
    shaper: &'a str,
    tick: f64,
    retunes: &'a [(usize, Mode)],
) -> Scenario<'a> {
    let truth = Mode::from_hertz(8.12, XI).unwrap();
    let wrong = Mode::from_hertz(8.12 * wrong, XI).unwrap();
    let belief = shaper_by_name(shaper)
        .unwrap()
        .on_grid(wrong, tick)
        .unwrap();
    let command = Move::PUBLISHED;
    Scenario {
        command,
        tick,
        truth,
        belief,
        retunes,
        shaper,
        limits: command.limits(),
    }
}

/// Velocity and acceleration sent are the derivatives of the position sent.
fn assert_consistent(run: &Run, limits: &MotionLimits, tick: f64) {
    let start = [Setpoint::default()];
    for pair in start.iter().chain(&run.sent).collect::<Vec<_>>().windows(2) {
        let [a, b] = [pair[0], pair[1]];
        // The error of the trapezoidal rule over a tick with jerk j is j h^3 / 12 for the position
        // and j h^2 / 2 for the velocity; twice that, because the jerk of a fade and of a step is
        // bounded only as sampled.
        let bound = 2.0 * CORRECTION_OVERSHOOT * limits.jerk * tick * tick;
        let position = b.position - a.position - 0.5 * tick * (a.velocity + b.velocity);
        assert!(position.abs() < bound * tick / 6.0, "position {position:e}");
        let velocity = b.velocity - a.velocity - 0.5 * tick * (a.acceleration + b.acceleration);
        assert!(velocity.abs() < bound / 2.0, "velocity {velocity:e}");
    }
}

#[test]
fn val_retune_in_motion_leaves_nothing() {
    let truth = Mode::from_hertz(8.12, XI).unwrap();
    for tick in [0.004, 0.001] {
        for shaper in ["zv", "zvd"] {
            for wrong in [0.75, 0.9, 1.1, 1.25] {
                for when in [0.1, 0.2, 0.3, 0.45, 0.7] {
                    let retunes = [((when / tick) as usize, truth)];
                    let scenario = scenario(wrong, shaper, tick, &retunes);
                    let run = scenario.run();
                    let without = Scenario {
                        retunes: &[],
                        ..scenario
                    };
                    let c = &run.corrections[0];
                    println!(
                        "{tick} {shaper} x{wrong} at {when}: {:.4} -> {:.1e}; fade {:.3} delay {:.3} n {} span {:.3} rest {:.3}; peaks {:.3} {:.3} {:.3}",
                        without.run().left,
                        run.left,
                        c.cross_fade,
                        c.delay,
                        c.steps,
                        c.duration,
                        when + c.until_rest,
                        run.peaks.velocity,
                        run.peaks.acceleration,
                        run.peaks.jerk
                    );
                    assert!(run.left < 1e-9, "{}", run.left);
                    assert!(run.peaks.worst() <= CORRECTION_OVERSHOOT + 1e-9);
                    assert_consistent(&run, &scenario.limits, tick);
                    assert_eq!(run.sent.last().unwrap().position, scenario.command.distance);
                }
            }
        }
    }
}
