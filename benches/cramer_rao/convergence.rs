//! How many periods each estimator needs.

use crate::draw::Case;
use crate::statistics::{percentile, share};
use quell::estimators::{ESTIMATORS, Estimator, EstimatorEntry};

const TRIALS: u64 = 500;
/// Periods that are waited for.
const PERIODS: f64 = 4.0;
/// Bounds of an estimate's error: relative in f, absolute in xi.
const WITHIN: f64 = 0.02;

fn is_within(case: &Case, estimator: &dyn Estimator) -> bool {
    estimator.estimate().is_some_and(|estimate| {
        let [f, xi] = case.error(estimate.mode);
        f.abs() < WITHIN && xi.abs() < WITHIN
    })
}

/// Periods until the estimate is within for good, and until it first calls itself converged.
fn run(case: &Case, line: &EstimatorEntry) -> [f64; 2] {
    let mut estimator = (line.build)(&case.settings(false));
    let (mut since, mut converged) = (f64::INFINITY, f64::INFINITY);
    for sample in case.measured(PERIODS) {
        estimator.observe(sample);
        let now = sample.time * case.mode.hertz();
        since = match is_within(case, &*estimator) {
            true => since.min(now),
            false => f64::INFINITY,
        };
        if estimator.estimate().is_some_and(|e| e.converged) {
            converged = converged.min(now);
        }
    }
    [since, converged]
}

/// Periods after which 1.96 deviations of the bound are within.
fn bound(case: &Case) -> f64 {
    let holds = |periods: f64| {
        let bound = case.bound(&case.clean(periods));
        bound.is_some_and(|std| std.iter().all(|std| 1.96 * std < WITHIN))
    };
    (2..=80)
        .map(|k| 0.05 * f64::from(k))
        .find(|&periods| holds(periods))
        .unwrap_or(f64::INFINITY)
}

fn print_line(name: &str, periods: &mut [f64]) {
    let never = periods.iter().filter(|p| p.is_infinite()).count();
    println!(
        "{name:34}{:9.2}{:9.2}{:9.2}{:9.2}{:9.1}",
        percentile(periods, 10.0),
        percentile(periods, 50.0),
        percentile(periods, 90.0),
        percentile(periods, 95.0),
        share(never, periods.len()),
    );
}

/// Percentiles of the periods that each estimator needs.
pub fn print() {
    println!();
    println!(
        "Periods until an estimate is within 2 % of f and 0.02 of xi for good, and until it first calls itself"
    );
    println!("converged; {TRIALS} cases of {PERIODS} periods, the level of the noise learned.");
    println!(
        "{:34}{:>9}{:>9}{:>9}{:>9}{:>9}",
        "", "10 %", "median", "90 %", "95 %", "never, %"
    );
    let cases: Vec<Case> = (0..TRIALS).filter_map(Case::draw).collect();
    let mut bounds: Vec<f64> = cases.iter().map(bound).collect();
    print_line("Cramer-Rao bound, 95 %", &mut bounds);
    for line in ESTIMATORS {
        let [mut within, mut converged]: [Vec<f64>; 2] = {
            let both: Vec<[f64; 2]> = cases.iter().map(|case| run(case, line)).collect();
            [0, 1].map(|k| both.iter().map(|pair| pair[k]).collect())
        };
        print_line(&format!("{}, within", line.name), &mut within);
        print_line(&format!("{}, converged", line.name), &mut converged);
    }
}
