//! Two close modes: how often they are separated, how exactly, and how often one mode is told as two.

use crate::draw::Case;
use crate::spoiled::SPOILS;
use crate::statistics::{percentile, share};
use quell::estimators::{
    Bound, Estimate, EstimatorEntry, Sample, Settings, estimator, two_mode_cramer_rao,
};
use quell_shapers::Mode;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const TRIALS: u64 = 500;
/// Ratios of the frequencies.
const RATIOS: [f64; 4] = [1.10, 1.15, 1.3, 2.0];
/// Lengths of what is measured, in periods of the slower mode.
const PERIODS: [f64; 4] = [2.0, 3.0, 4.0, 6.0];
/// Bound of a standard deviation of `ln f`, over the spacing, above which nobody can separate.
const SEPARABLE: f64 = 0.25;

/// Two free decays in one.
struct Couple {
    /// The slower one, in its noise; its belief is one of the middle of both.
    first: Case,
    second: Case,
    ratio: f64,
}

impl Couple {
    /// The couple of a seed: amplitudes 0.1 to 2 mm, their ratio 0.3 to 3, damping ratios of their own.
    fn draw(seed: u64, ratio: f64) -> Option<Self> {
        let first = Case::draw(seed)?;
        let mut random = ChaCha8Rng::seed_from_u64(seed ^ 0x2_0de5);
        let mut between =
            |low: f64, high: f64| -> f64 { low * (high / low).powf(random.random::<f64>()) };
        let amplitude = loop {
            let amplitude = first.amplitude * between(0.3, 3.0);
            if (0.1e-3..=2e-3).contains(&amplitude) {
                break amplitude;
            }
        };
        let hertz = first.mode.hertz();
        let wrong = first.belief.hertz() / hertz * ratio.sqrt();
        let belief = Mode::from_hertz(hertz * wrong, first.belief.damping_ratio()).ok()?;
        let second = Case {
            mode: Mode::from_hertz(ratio * hertz, between(0.005, 0.15)).ok()?,
            amplitude,
            phase: random.random_range(0.0..core::f64::consts::TAU),
            ..first
        };
        Some(Self {
            first: Case { belief, ..first },
            second,
            ratio,
        })
    }

    fn add(&self, mut samples: Vec<Sample>, periods: f64) -> Vec<Sample> {
        let more = self.second.clean(periods * self.ratio);
        for (sample, more) in samples.iter_mut().zip(&more) {
            sample.deformation += more.deformation;
        }
        samples
    }

    fn modes(&self) -> [Mode; 2] {
        [self.first.mode, self.second.mode]
    }

    fn spacing(&self) -> f64 {
        self.ratio.ln()
    }

    fn settings(&self) -> Settings {
        self.first.settings(false)
    }

    /// Bounds of `ln f` of both, and of `xi`.
    fn bound(&self, clean: &[Sample]) -> Option<[[f64; 2]; 2]> {
        let settings = self.first.settings(true);
        let modes = self.modes();
        let bounds = two_mode_cramer_rao(clean, modes, self.first.noise, &settings)?;
        let relative = |m: usize| {
            let Bound {
                natural_frequency_std,
                damping_ratio_std,
            } = bounds[m];
            [
                natural_frequency_std / modes[m].natural_frequency(),
                damping_ratio_std,
            ]
        };
        let both = [relative(0), relative(1)];
        both.iter()
            .flatten()
            .all(|std| std.is_finite())
            .then_some(both)
    }

    fn is_separable(&self, bound: Option<[[f64; 2]; 2]>) -> bool {
        bound.is_some_and(|b| b[0][0].max(b[1][0]) < SEPARABLE * self.spacing())
    }

    /// The mode whose decay has more energy, `A^2 / (4 xi w)`, over the length.
    fn stronger(&self) -> &Case {
        let energy = |case: &Case| {
            let lost = 2.0 * case.mode.decay_rate();
            let length = PERIODS[3] / self.first.mode.hertz();
            case.amplitude.powi(2) * (1.0 - (-lost * length).exp()) / lost
        };
        match energy(&self.second) > energy(&self.first) {
            true => &self.second,
            false => &self.first,
        }
    }
}

/// The results of the couples of a ratio at one length.
#[derive(Default)]
struct Outcome {
    couples: usize,
    told: usize,
    separated: usize,
    /// Squares of errors over bounds, of `ln f` and `xi`.
    squares: [Vec<f64>; 2],
    inside: [usize; 2],
    /// Errors of the stronger mode's f, %, by two modes and by one.
    stronger: [Vec<f64>; 2],
}

impl Outcome {
    fn add(&mut self, couple: &Couple, found: Option<[Estimate; 2]>, bound: Option<[[f64; 2]; 2]>) {
        let Some(found) = found else { return };
        self.told += 1;
        let errors = [
            couple.first.error(found[0].mode),
            couple.second.error(found[1].mode),
        ];
        let half = 0.5 * couple.spacing();
        self.separated += usize::from(errors.iter().all(|error| error[0].abs() < half));
        for m in 0..2 {
            let std = found[m].natural_frequency_std / found[m].mode.natural_frequency();
            let stated = [std, found[m].damping_ratio_std];
            for k in 0..2 {
                let inside = errors[m][k].abs() <= 1.96 * stated[k];
                self.inside[k] += usize::from(inside);
                if let Some(bound) = bound {
                    self.squares[k].push((errors[m][k] / bound[m][k]).powi(2));
                }
            }
        }
    }

    fn print(&mut self, name: &str) {
        let told = self.told;
        let efficiency =
            |k: usize| self.squares[k].len() as f64 / self.squares[k].iter().sum::<f64>();
        println!(
            "{name:>20}{:8}{:9.1}{:11.1}   {:6.2} {:5.2} {:7.2} {:5.2}   {:6.1} {:5.1}   {:6.2} {:6.2}   {:6.2} {:6.2}",
            self.couples,
            share(told, self.couples),
            share(self.separated, self.couples),
            efficiency(0),
            efficiency(1),
            self.median_efficiency(0),
            self.median_efficiency(1),
            share(self.inside[0], 2 * told),
            share(self.inside[1], 2 * told),
            percentile(&mut self.stronger[0], 50.0),
            percentile(&mut self.stronger[0], 90.0),
            percentile(&mut self.stronger[1], 50.0),
            percentile(&mut self.stronger[1], 90.0),
        );
    }

    /// The median of a chi-squared of one degree, 0.455, over that of the squares: blind to a few that went
    /// elsewhere.
    fn median_efficiency(&self, k: usize) -> f64 {
        0.455 / percentile(&mut self.squares[k].clone(), 50.0)
    }
}

fn two() -> Option<&'static EstimatorEntry> {
    estimator("two_mode_likelihood")
}

/// Outcomes at each of [`PERIODS`], of what can be separated and of what cannot.
fn run(couple: &Couple, outcomes: &mut [[Outcome; 2]; PERIODS.len()]) -> Option<()> {
    let settings = couple.settings();
    let mut two = (two()?.build)(&settings);
    let mut one = (estimator("likelihood")?.build)(&settings);
    let longest = PERIODS[PERIODS.len() - 1];
    let measured = couple.add(couple.first.measured(longest), longest);
    let mut taken = 0;
    for (outcomes, periods) in outcomes.iter_mut().zip(PERIODS) {
        let clean = couple.add(couple.first.clean(periods), periods);
        for sample in &measured[taken..clean.len()] {
            two.observe(*sample);
            one.observe(*sample);
        }
        taken = clean.len();
        let bound = couple.bound(&clean);
        let outcome = &mut outcomes[usize::from(!couple.is_separable(bound))];
        outcome.couples += 1;
        let stronger = couple.stronger();
        for (errors, estimator) in outcome.stronger.iter_mut().zip([&two, &one]) {
            // Of what is told the mode that is nearest.
            let told = [estimator.estimate(), estimator.further()];
            let error = |e: &Estimate| 100.0 * stronger.error(e.mode)[0].abs();
            let errors_told = told.iter().flatten().map(error);
            errors.push(errors_told.fold(f64::INFINITY, f64::min));
        }
        let found = two.estimate().zip(two.further()).map(|(a, b)| {
            let in_order = a.mode.natural_frequency() < b.mode.natural_frequency();
            if in_order { [a, b] } else { [b, a] }
        });
        outcome.add(couple, found, bound);
    }
    Some(())
}

fn separations() {
    println!();
    println!(
        "Two modes: {TRIALS} couples a ratio, amplitudes 0.1 to 2 mm and 0.3 to 3 of each other, damping ratios of their"
    );
    println!(
        "own, periods of the slower one, belief wrong by up to 25 % from the middle, noise learned. Separable: the"
    );
    println!(
        "bound of both frequencies is below a quarter of their distance. Separated: told, and each within half of"
    );
    println!(
        "it. Efficiency by means and by medians, and what is inside 1.96 deviations, of what is told. Error of the"
    );
    println!(
        "stronger one's f, %, median and 90th percentile, by the mode told that is nearest: of two, and of one."
    );
    println!(
        "{:>20}{:>8}{:>9}{:>11}   {:>12} {:>13}   {:>12}   {:>13}   {:>13}",
        "ratio, periods",
        "couples",
        "told, %",
        "separated",
        "effic. f xi",
        "median f xi",
        "inside f xi",
        "two, f %",
        "one, f %"
    );
    for ratio in RATIOS {
        let mut outcomes: [[Outcome; 2]; PERIODS.len()] = Default::default();
        for couple in (0..TRIALS).filter_map(|seed| Couple::draw(seed, ratio)) {
            run(&couple, &mut outcomes);
        }
        for (outcomes, periods) in outcomes.iter_mut().zip(PERIODS) {
            let [separable, not] = outcomes;
            separable.print(&format!("{ratio:.2}, {periods}"));
            not.print("not separable");
        }
    }
}

/// How often one mode is told as two, under white noise and under each spoil.
fn false_alarms() {
    println!();
    println!(
        "One mode told as two, of {TRIALS} decays of 6 periods: at their end, and ever since their start, %"
    );
    let Some(line) = two() else { return };
    for (name, spoil) in SPOILS {
        let (mut ever, mut at_end, mut cases) = (0, 0, 0);
        for case in (0..TRIALS).filter_map(Case::draw) {
            let mut random = ChaCha8Rng::seed_from_u64(case.seed ^ 0x5eed);
            let mut estimator = (line.build)(&Settings {
                offset_std: Some(case.amplitude),
                ..case.settings(false)
            });
            let mut told = false;
            for sample in spoil(&case, case.measured(6.0), &mut random) {
                estimator.observe(sample);
                told |= estimator.further().is_some();
            }
            cases += 1;
            ever += usize::from(told);
            at_end += usize::from(estimator.further().is_some());
        }
        println!(
            "{name:20}{:8.1}{:8.1}",
            share(at_end, cases),
            share(ever, cases)
        );
    }
}

/// Separations, and false alarms.
pub fn print() {
    separations();
    false_alarms();
}
