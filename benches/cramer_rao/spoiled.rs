//! Each estimator under the disturbances of real sensors.

use crate::draw::Case;
use crate::statistics::{percentile, share};
use quell::estimators::{ESTIMATORS, EstimatorEntry, Sample, Settings};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const TRIALS: u64 = 500;
const PERIODS: f64 = 3.0;
/// Lag-one correlation of coloured noise, of the same level as the white.
const CORRELATION: f64 = 0.8;
/// Deviations of the noise by which an outlier is off, and how many there are.
const OUTLIER: f64 = 30.0;
const OUTLIERS: f64 = 0.01;
/// Share of samples that do not come.
const MISSING: f64 = 0.2;
/// Offset, and drift over all periods, as a share of the amplitude.
const SHARE: f64 = 0.1;

pub type Spoil = fn(&Case, Vec<Sample>, &mut ChaCha8Rng) -> Vec<Sample>;

pub const SPOILS: [(&str, Spoil); 6] = [
    ("white noise alone", |_, samples, _| samples),
    ("coloured noise", coloured),
    ("1 % outliers", |case, mut samples, random| {
        for sample in &mut samples {
            if random.random::<f64>() < OUTLIERS {
                let sign = if random.random() { 1.0 } else { -1.0 };
                sample.deformation += sign * OUTLIER * case.noise;
            }
        }
        samples
    }),
    ("20 % missing", |_, mut samples, random| {
        samples.retain(|_| random.random::<f64>() >= MISSING);
        samples
    }),
    ("constant offset", |case, mut samples, _| {
        for sample in &mut samples {
            sample.deformation += SHARE * case.amplitude;
        }
        samples
    }),
    ("drifting sensor", |case, mut samples, _| {
        let length = PERIODS / case.mode.hertz();
        for sample in &mut samples {
            sample.deformation += SHARE * case.amplitude * sample.time / length;
        }
        samples
    }),
];

/// The white noise, run through a filter of first order that keeps its variance.
fn coloured(case: &Case, samples: Vec<Sample>, _: &mut ChaCha8Rng) -> Vec<Sample> {
    let fresh = (1.0 - CORRELATION * CORRELATION).sqrt();
    let mut state: Option<f64> = None;
    let clean = case.clean(samples.len() as f64 * case.mode.hertz() / case.rate);
    samples
        .iter()
        .zip(&clean)
        .map(|(sample, clean)| {
            let white = sample.deformation - clean.deformation;
            let noise = match state {
                Some(last) => CORRELATION * last + fresh * white,
                None => white,
            };
            state = Some(noise);
            Sample {
                deformation: clean.deformation + noise,
                ..*sample
            }
        })
        .collect()
}

/// The results of all cases: errors of `ln f` (%) and `xi`, and stated deviations that hold.
#[derive(Default)]
struct Outcome {
    errors: [Vec<f64>; 2],
    answers: usize,
    inside: usize,
}

fn run(line: &EstimatorEntry, spoil: Spoil) -> Outcome {
    let mut outcome = Outcome::default();
    for case in (0..TRIALS).filter_map(Case::draw) {
        let mut random = ChaCha8Rng::seed_from_u64(case.seed ^ 0x5eed);
        // An offset that nobody zeroed may be as large as the vibration.
        let mut estimator = (line.build)(&Settings {
            offset_std: Some(case.amplitude),
            ..case.settings(false)
        });
        for sample in spoil(&case, case.measured(PERIODS), &mut random) {
            estimator.observe(sample);
        }
        let Some(found) = estimator.estimate() else {
            outcome
                .errors
                .iter_mut()
                .for_each(|e| e.push(f64::INFINITY));
            continue;
        };
        let [f, xi] = case.error(found.mode).map(f64::abs);
        let stated = found.natural_frequency_std / found.mode.natural_frequency();
        outcome.answers += 1;
        outcome.inside += usize::from(f <= 1.96 * stated);
        outcome.errors[0].push(100.0 * f);
        outcome.errors[1].push(xi);
    }
    outcome
}

/// Errors of each estimator under each spoil.
pub fn print() {
    println!();
    println!(
        "Errors after {PERIODS} periods, median and 90th percentile of {TRIALS} cases, offset and noise unknown; silent: no"
    );
    println!(
        "estimate, %; inside: within 1.96 stated deviations of f, % (only the likelihood states its error)."
    );
    println!(
        "Coloured: correlation {CORRELATION} from sample to sample. Outliers: {OUTLIER} deviations. Offset, and drift over all"
    );
    println!("periods: {SHARE} of the amplitude.");
    println!(
        "{:20}{:22}{:>8}{:>8}{:>10}{:>8}{:>9}{:>8}",
        "", "", "f, %", "90 %", "xi", "90 %", "silent", "inside"
    );
    for (name, spoil) in SPOILS {
        for line in ESTIMATORS {
            let mut outcome = run(line, spoil);
            let [f, xi] = &mut outcome.errors;
            let silent = share(f.len() - outcome.answers, f.len());
            let inside = match line.states_error {
                true => format!("{:.1}", share(outcome.inside, outcome.answers)),
                false => "-".to_owned(),
            };
            println!(
                "{name:20}{:22}{:8.2}{:8.2}{:10.4}{:8.4}{silent:9.1}{inside:>8}",
                line.name,
                percentile(f, 50.0),
                percentile(f, 90.0),
                percentile(xi, 50.0),
                percentile(xi, 90.0),
            );
        }
    }
}
