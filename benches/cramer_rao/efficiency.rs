//! Variance of the bound over that of the errors, and whether stated deviations are true.

use crate::draw::Case;
use crate::statistics::share;
use quell::estimators::ESTIMATORS;

const TRIALS: u64 = 4000;
/// Lengths of what is measured.
const PERIODS: [f64; 4] = [0.75, 1.0, 2.0, 4.0];
/// Upper ends of the classes: the larger of the bound's deviations of `ln f` and `xi`.
const CLASSES: [f64; 6] = [0.003, 0.01, 0.03, 0.1, 0.3, f64::INFINITY];

/// The results of the cases of one class.
#[derive(Default)]
struct Class {
    cases: usize,
    silent: usize,
    /// Squares of the errors over the bound, of `ln f` and `xi`.
    squares: [Vec<f64>; 2],
    inside: [usize; 2],
}

impl Class {
    /// Takes errors and stated deviations of one answer.
    fn add(&mut self, error: [f64; 2], stated: [f64; 2], bound: [f64; 2]) {
        for (k, squares) in self.squares.iter_mut().enumerate() {
            squares.push((error[k] / bound[k]).powi(2));
            self.inside[k] += usize::from(error[k].abs() <= 1.96 * stated[k]);
        }
    }

    fn join(&mut self, other: &Class) {
        self.cases += other.cases;
        self.silent += other.silent;
        for k in 0..2 {
            self.squares[k].extend(&other.squares[k]);
            self.inside[k] += other.inside[k];
        }
    }

    fn print(&self, name: &str) {
        let answers = self.squares[0].len();
        let efficiency = |k: usize| answers as f64 / self.squares[k].iter().sum::<f64>();
        println!(
            "{name:>16}{:8}{:8}   {:7.2} {:7.2}   {:7.1} {:7.1}",
            self.cases,
            self.silent,
            efficiency(0),
            efficiency(1),
            share(self.inside[0], answers),
            share(self.inside[1], answers),
        );
    }
}

fn name(class: usize) -> String {
    match CLASSES[class] {
        limit if limit.is_finite() => format!("bound < {:.1} %", 100.0 * limit),
        _ => "above, or none".to_owned(),
    }
}

/// All that is printed for one knowledge of the noise: classes at each of [`PERIODS`].
type Table = [[Class; CLASSES.len()]; PERIODS.len()];

fn run(case: &Case, noise_is_known: bool, table: &mut Table) {
    let mut estimator = (ESTIMATORS[0].build)(&case.settings(noise_is_known));
    let mut measured = case.measured(PERIODS[PERIODS.len() - 1]).into_iter();
    let mut taken = 0;
    for (classes, &periods) in table.iter_mut().zip(&PERIODS) {
        let clean = case.clean(periods);
        for sample in measured.by_ref().take(clean.len() - taken) {
            estimator.observe(sample);
        }
        taken = clean.len();
        let bound = case.bound(&clean);
        let worst = bound.map_or(f64::INFINITY, |[f, xi]| f.max(xi));
        let index = CLASSES.iter().position(|&limit| worst < limit);
        let class = &mut classes[index.unwrap_or(CLASSES.len() - 1)];
        class.cases += 1;
        match (estimator.estimate(), bound) {
            (Some(found), Some(bound)) => {
                let log_std = found.natural_frequency_std / found.mode.natural_frequency();
                let stated = [log_std, found.damping_ratio_std];
                class.add(case.error(found.mode), stated, bound);
            }
            _ => class.silent += 1,
        }
    }
}

/// The likelihood estimator in classes of the bound.
pub fn print() {
    println!();
    println!(
        "Likelihood: efficiency (variance of the bound over that of the errors), and percent of the errors"
    );
    println!(
        "within 1.96 stated deviations. {TRIALS} cases, the level of the noise given or learned; silent: no estimate."
    );
    for noise_is_known in [true, false] {
        let mut table = Table::default();
        for case in (0..TRIALS).filter_map(Case::draw) {
            run(&case, noise_is_known, &mut table);
        }
        let noise = if noise_is_known { "given" } else { "learned" };
        for (classes, periods) in table.iter().zip(PERIODS) {
            println!(
                "{:>16}{:>8}{:>8}   {:>15}   {:>15}",
                format!("{periods} periods, {noise}"),
                "cases",
                "silent",
                "efficiency f xi",
                "inside f xi, %"
            );
            let mut informative = Class::default();
            for (index, class) in classes.iter().enumerate() {
                class.print(&name(index));
                if CLASSES[index].is_finite() {
                    informative.join(class);
                }
            }
            informative.print("all below 30 %");
        }
    }
}
