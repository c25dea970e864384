//! Entry times of all estimators in a free decay, beside the Cramer-Rao bound.
//!
//! `cargo bench --bench estimation`: no clock is read; the figures are periods, not seconds.

#[path = "../tests/generator/decay.rs"]
mod decay;
#[path = "../tests/generator/mod.rs"]
mod generator;

use decay::decay;
use generator::{Truth, add_noise, jerk_limited_move, respond, stamps};
use quell::estimators::{ESTIMATORS, Estimator, EstimatorEntry, Sample, Settings, cramer_rao};
use quell_shapers::Mode;

const TRUTH: Truth = Truth {
    frequency_hz: 8.12,
    damping_ratio: 0.084,
    across: false,
};
const NOISE: f64 = 10e-6;
const AMPLITUDE: f64 = 0.74e-3;
const TRIALS: u64 = 400;
/// Golden angle: phases that fill the circle evenly.
const PHASE: f64 = 2.399_963;
const RATES: [f64; 3] = [1000.0 / 3.0, 1000.0, 4000.0];

fn settings(trial: u64, rate: f64) -> Option<Settings> {
    let belief = 8.12 * [0.75, 0.85, 1.0, 1.15, 1.25][(trial % 5) as usize];
    let belief = Mode::from_hertz(belief, 0.084).ok()?;
    Some(Settings {
        noise_std: Some(NOISE),
        offset_std: Some(0.0),
        ..Settings::around(belief, 1.0 / rate)
    })
}

fn noisy_decay(trial: u64, rate: f64, periods: f64) -> Vec<Sample> {
    let phase = trial as f64 * PHASE;
    let mut samples = decay(
        &TRUTH,
        AMPLITUDE,
        phase,
        &stamps(rate, periods / TRUTH.frequency_hz),
    );
    add_noise(&mut samples, NOISE, trial);
    samples
}

fn inside(estimator: &dyn Estimator) -> bool {
    estimator.estimate().is_some_and(|estimate| {
        (estimate.mode.hertz() / TRUTH.frequency_hz - 1.0).abs() < 0.02
            && (estimate.mode.damping_ratio() - TRUTH.damping_ratio).abs() < 0.02
    })
}

/// Entries (periods, held to the end) and errors of `ln f` and `xi` at the end.
fn run(line: &EstimatorEntry, rate: f64, periods: f64) -> Vec<(f64, [f64; 2])> {
    let mut results = Vec::new();
    for trial in 0..TRIALS {
        let Some(settings) = settings(trial, rate) else {
            continue;
        };
        let mut estimator = (line.build)(&settings);
        let mut since = f64::INFINITY;
        for sample in noisy_decay(trial, rate, periods) {
            estimator.observe(sample);
            since = match inside(&*estimator) {
                true if since.is_infinite() => sample.time * TRUTH.frequency_hz,
                true => since,
                false => f64::INFINITY,
            };
        }
        let error = estimator.estimate().map_or([f64::INFINITY; 2], |e| {
            [
                (e.mode.hertz() / TRUTH.frequency_hz).ln(),
                e.mode.damping_ratio() - TRUTH.damping_ratio,
            ]
        });
        results.push((since, error));
    }
    results
}

fn percentile(values: &mut [f64], percent: usize) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() * percent / 100).min(values.len() - 1)]
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    f64::sqrt(sum / count)
}

/// Mean over phases of the bound (relative f, xi) after so many periods, the offset known.
fn bound(rate: f64, periods: f64) -> [f64; 2] {
    let mut sums = [0.0; 2];
    let mut count = 0.0;
    for trial in 0..24 {
        let phase = trial as f64 * PHASE;
        let times = stamps(rate, periods / TRUTH.frequency_hz);
        let samples = decay(&TRUTH, AMPLITUDE, phase, &times);
        let Ok(mode) = Mode::from_hertz(TRUTH.frequency_hz, TRUTH.damping_ratio) else {
            continue;
        };
        let Some(settings) = settings(2, rate) else {
            continue;
        };
        if let Some(bound) = cramer_rao(&samples, mode, NOISE, &settings) {
            sums[0] += (bound.natural_frequency_std / mode.natural_frequency()).powi(2);
            sums[1] += bound.damping_ratio_std.powi(2);
            count += 1.0;
        }
    }
    sums.map(|sum| f64::sqrt(sum / count))
}

/// Periods after which 1.96 standard deviations of the bound fit into 2 % of f and 0.02 of xi.
fn bound_entry(rate: f64) -> f64 {
    (10..200)
        .map(|k| f64::from(k) * 0.01)
        .find(|&periods| {
            let [f, xi] = bound(rate, periods);
            1.96 * f < 0.02 && 1.96 * xi < 0.02
        })
        .unwrap_or(f64::INFINITY)
}

fn free_decay() {
    println!(
        "Free decay, 8.12 Hz, xi 0.084, noise 10 um on 0.74 mm, zero known, {TRIALS} phases, belief within 25 %."
    );
    println!(
        "Periods until the estimate is within 2 % of f and 0.02 of xi and stays there (4 periods)."
    );
    println!("Efficiency: variance of the bound over that of the errors at one period, f / xi.");
    println!(
        "{:22}{:>8}{:>9}{:>9}{:>9}{:>8}  {:>15}",
        "", "rate", "median", "95 %", "worst", "never", "efficiency"
    );
    for rate in RATES {
        println!(
            "{:22}{rate:6.0}Hz{:>9}{:9.2}",
            "Cramer-Rao, 95 %",
            "",
            bound_entry(rate)
        );
        let [f, xi] = bound(rate, 1.0);
        for line in ESTIMATORS {
            let results = run(line, rate, 4.0);
            let mut entries: Vec<f64> = results.iter().map(|result| result.0).collect();
            let never = entries.iter().filter(|entry| entry.is_infinite()).count();
            let short = run(line, rate, 1.0);
            let efficiency = [
                (f / rms(short.iter().map(|result| result.1[0]))).powi(2),
                (xi / rms(short.iter().map(|result| result.1[1]))).powi(2),
            ];
            println!(
                "{:22}{rate:6.0}Hz{:9.2}{:9.2}{:9.2}{never:8}  {:7.2} {:7.2}",
                line.name,
                percentile(&mut entries, 50),
                percentile(&mut entries, 95),
                percentile(&mut entries, 100),
                efficiency[0],
                efficiency[1],
            );
        }
    }
}

fn motion() {
    println!();
    println!(
        "Jerk-limited moves of 30 degrees in 0.36 to 0.44 s at 333 Hz, noise 5 to 20 um at 1.8 m,"
    );
    println!(
        "both dampers. Entry as a part of the move's duration; after the end of the move: late."
    );
    println!(
        "{:22}{:>9}{:>9}{:>9}{:>8}",
        "", "median", "90 %", "worst", "late"
    );
    for line in ESTIMATORS.iter().filter(|line| line.uses_motion) {
        let mut entries: Vec<f64> = Vec::new();
        for trial in 0..TRIALS {
            let truth = Truth {
                across: trial % 2 == 0,
                ..TRUTH
            };
            let duration = 0.36 + 0.08 * (trial as f64 / TRIALS as f64);
            let jerk_time = duration / (4.0 + (trial % 7) as f64);
            let segments = jerk_limited_move(0.1, duration, jerk_time, 30_f64.to_radians());
            let mut samples = respond(&truth, &segments, &stamps(RATES[0], 1.2));
            let noise = [5e-6, 10e-6, 20e-6][(trial % 3) as usize] / 1.8;
            add_noise(&mut samples, noise, trial);
            let Some(settings) = settings(trial, RATES[0]) else {
                continue;
            };
            let mut estimator = (line.build)(&Settings {
                noise_std: None,
                offset_std: None,
                ..settings
            });
            let mut since = f64::INFINITY;
            for sample in samples {
                estimator.observe(sample);
                since = match inside(&*estimator) {
                    true => since.min((sample.time - 0.1) / duration),
                    false => f64::INFINITY,
                };
            }
            entries.push(since);
        }
        let late = entries.iter().filter(|&&entry| entry > 1.0).count();
        println!(
            "{:22}{:9.2}{:9.2}{:9.2}{late:8}",
            line.name,
            percentile(&mut entries, 50),
            percentile(&mut entries, 90),
            percentile(&mut entries, 100),
        );
    }
}

fn main() {
    free_decay();
    motion();
}
