//! Recommendation of a shaper for an uncertain mode.

use crate::{ImpulseTrain, SHAPERS, Shaper, ShaperError, UncertainMode, residual_vibration};
use arrayvec::ArrayVec;
use core::cmp::Ordering;
use num_traits::Float;

/// Nodes of the quadrature over natural frequency and over damping ratio.
const FREQUENCY_NODES: usize = 61;
const DAMPING_NODES: usize = 13;
const NODES: usize = FREQUENCY_NODES * DAMPING_NODES;
/// The quadrature ends at this many standard deviations; 0.27 % of a Gaussian lies outside.
const REACH: f64 = 3.0;
/// Room for the table of shapers.
const CANDIDATES: usize = 32;

/// The quantity to be minimised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Criterion {
    /// The mean residual over the uncertainty.
    Expected,
    /// The residual that 95 % of the uncertainty stays below.
    Worst95,
}

/// The conditions of a recommendation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Requirements {
    /// Longest delay that the train may add, s; infinity for any.
    pub longest_delay: f64,
    /// The quantity to be minimised.
    pub criterion: Criterion,
    /// A residual that is small enough: of the shapers at or below it the shortest is taken. 0.05 is the usual
    /// level of insensitivity; 0 asks for the least residual.
    pub acceptable: f64,
    /// Residuals nearer than this are as good as each other, and the shorter train is taken: the
    /// smallest vibration that matters (or that the sensor sees) over the unshaped vibration.
    pub tolerance: f64,
    /// Whether negative impulses are allowed, which can exceed the limits of the move.
    pub allow_negative: bool,
}

/// Why a shaper is or is not among those to choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Standing {
    /// It may be chosen.
    Eligible,
    /// It adds more delay than allowed.
    TooLong,
    /// It has negative impulses.
    Negative,
    /// It cannot be solved for this damping ratio.
    Unsolved,
}

/// A shaper with its figures for the uncertain mode.
#[derive(Clone, Copy)]
pub struct Candidate {
    /// The shaper.
    pub shaper: &'static dyn Shaper,
    /// Delay that it adds, s; NaN where it is not solved.
    pub delay: f64,
    /// [`residual_vibration`] at the estimate.
    pub nominal: f64,
    /// Mean residual.
    pub expected: f64,
    /// Residual that 95 % of the uncertainty stays below.
    pub worst_95: f64,
    /// Whether it may be chosen.
    pub standing: Standing,
}

impl core::fmt::Debug for Candidate {
    fn fmt(&self, formatter: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        formatter
            .debug_struct("Candidate")
            .field("shaper", &self.shaper.name())
            .field("delay", &self.delay)
            .field("nominal", &self.nominal)
            .field("expected", &self.expected)
            .field("worst_95", &self.worst_95)
            .field("standing", &self.standing)
            .finish()
    }
}

impl Candidate {
    /// The figure that a criterion makes small.
    pub fn figure(&self, criterion: Criterion) -> f64 {
        match criterion {
            Criterion::Expected => self.expected,
            Criterion::Worst95 => self.worst_95,
        }
    }
}

/// Why the recommended shaper was taken.
#[derive(Clone, Copy, Debug)]
pub enum Reason {
    /// No other is within the delay.
    OnlyOne,
    /// It leaves least.
    LeavesLeast,
    /// It leaves an acceptable residual, and is the shortest that does.
    ShortestAcceptable,
    /// This one leaves least, but by less than the tolerance, and is longer.
    ShorterAndAsGood(Candidate),
}

/// The recommended shaper, and the figures of all.
#[derive(Clone, Debug)]
pub struct Recommendation {
    /// The one to take.
    pub best: Candidate,
    /// Why.
    pub reason: Reason,
    /// Every shaper of the table, in its order.
    pub candidates: ArrayVec<Candidate, CANDIDATES>,
}

/// Recommends a shaper of [`SHAPERS`] for uncertain modes.
///
/// The train is the convolution of those designed for each estimate. Each residual is its
/// [`residual_vibration`] over a grid of 61 x 13 modes within 3 standard deviations, weighted by the
/// Gaussian density (damping ratios below 0 count as 0); of several modes the worst counts.
/// Deterministic, no allocation, some 10^4 evaluations a mode: not for the tick.
///
/// # Errors
/// [`ShaperError::Empty`] without modes, [`ShaperError::OutOfRange`] for a standard deviation or tolerance that is negative or not finite,
/// [`ShaperError::NoneFits`] where no shaper is within the delay.
///
/// # Example
/// ```
/// use quell_shapers::{Criterion, Mode, Requirements, UncertainMode, recommend};
/// let mode = Mode::from_hertz(8.12, 0.084).unwrap();
/// let known = |relative: f64| UncertainMode {
///     mode,
///     natural_frequency_std: relative * mode.natural_frequency(),
///     damping_ratio_std: 0.002,
/// };
/// let wanted = Requirements {
///     longest_delay: f64::INFINITY,
///     criterion: Criterion::Worst95,
///     acceptable: 0.0,
///     tolerance: 0.01,
///     allow_negative: false,
/// };
/// assert_eq!(recommend(&[known(0.001)], &wanted).unwrap().best.shaper.name(), "zv");
/// assert_eq!(recommend(&[known(0.02)], &wanted).unwrap().best.shaper.name(), "zvd");
/// ```
pub fn recommend(
    estimates: &[UncertainMode],
    requirements: &Requirements,
) -> Result<Recommendation, ShaperError> {
    if estimates.is_empty() {
        return Err(ShaperError::Empty);
    }
    for estimate in estimates {
        let UncertainMode {
            natural_frequency_std,
            damping_ratio_std,
            ..
        } = *estimate;
        not_negative(
            "standard deviation of the natural frequency",
            natural_frequency_std,
        )?;
        not_negative("standard deviation of the damping ratio", damping_ratio_std)?;
    }
    not_negative("tolerance", requirements.tolerance)?;
    not_negative("acceptable residual", requirements.acceptable)?;
    let candidates: ArrayVec<Candidate, CANDIDATES> = SHAPERS
        .iter()
        .take(CANDIDATES)
        .map(|&shaper| candidate(shaper, estimates, requirements))
        .collect();
    choose(candidates, requirements)
}

fn not_negative(name: &'static str, value: f64) -> Result<(), ShaperError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(ShaperError::OutOfRange { name, value })
}

fn choose(
    candidates: ArrayVec<Candidate, CANDIDATES>,
    requirements: &Requirements,
) -> Result<Recommendation, ShaperError> {
    let figure = |candidate: &&Candidate| candidate.figure(requirements.criterion);
    let eligible = || {
        candidates
            .iter()
            .filter(|c| c.standing == Standing::Eligible)
    };
    let shortest = candidates
        .iter()
        .map(|c| c.delay)
        .fold(f64::INFINITY, f64::min);
    let none = ShaperError::NoneFits {
        longest_delay: requirements.longest_delay,
        shortest,
    };
    let least = *eligible()
        .min_by(|a, b| figure(a).total_cmp(&figure(b)))
        .ok_or(none)?;
    // The solved humps touch the tolerance that they are designed for, to about 1e-13.
    let acceptable = requirements.acceptable * (1.0 + 1e-9);
    let good = acceptable.max(figure(&&least) + requirements.tolerance);
    let best = *eligible()
        .filter(|c| figure(c) <= good)
        .min_by(|a, b| shorter(a, b, requirements.criterion))
        .ok_or(none)?;
    let reason = if eligible().count() == 1 {
        Reason::OnlyOne
    } else if best.shaper.name() == least.shaper.name() {
        Reason::LeavesLeast
    } else if figure(&&best) <= acceptable {
        Reason::ShortestAcceptable
    } else {
        Reason::ShorterAndAsGood(least)
    };
    Ok(Recommendation {
        best,
        reason,
        candidates,
    })
}

/// Order by delay; for equal delays, which may differ by rounding, by the residual.
fn shorter(a: &Candidate, b: &Candidate, criterion: Criterion) -> Ordering {
    if (a.delay - b.delay).abs() <= 1e-9 * a.delay {
        return a.figure(criterion).total_cmp(&b.figure(criterion));
    }
    a.delay.total_cmp(&b.delay)
}

fn candidate(
    shaper: &'static dyn Shaper,
    estimates: &[UncertainMode],
    requirements: &Requirements,
) -> Candidate {
    let unsolved = Candidate {
        shaper,
        delay: f64::NAN,
        nominal: f64::NAN,
        expected: f64::NAN,
        worst_95: f64::NAN,
        standing: Standing::Unsolved,
    };
    let train = estimates
        .iter()
        .try_fold(ImpulseTrain::identity(), |train, estimate| {
            train.convolve(&shaper.design(estimate.mode)?)
        });
    let Ok(train) = train else { return unsolved };
    let delay = train.duration();
    let standing = if delay > requirements.longest_delay {
        Standing::TooLong
    } else if !shaper.is_convex() && !requirements.allow_negative {
        Standing::Negative
    } else {
        Standing::Eligible
    };
    let mut found = Candidate {
        delay,
        nominal: 0.0,
        expected: 0.0,
        worst_95: 0.0,
        standing,
        ..unsolved
    };
    for estimate in estimates {
        let mode = estimate.mode;
        let nominal = residual_vibration(&train, mode.natural_frequency(), mode.damping_ratio());
        let (expected, worst_95) = over_uncertainty(&train, estimate);
        found.nominal = found.nominal.max(nominal);
        found.expected = found.expected.max(expected);
        found.worst_95 = found.worst_95.max(worst_95);
    }
    found
}

/// Mean and 95 % quantile of the residual over the Gaussian.
fn over_uncertainty(train: &ImpulseTrain, estimate: &UncertainMode) -> (f64, f64) {
    let mut nodes: ArrayVec<(f64, f64), NODES> = ArrayVec::new();
    for i in 0..FREQUENCY_NODES {
        let by_frequency = deviation(i, FREQUENCY_NODES);
        // A frequency of 0 is the limit in which a train changes nothing.
        let frequency = (estimate.mode.natural_frequency()
            + by_frequency * estimate.natural_frequency_std)
            .max(0.0);
        for k in 0..DAMPING_NODES {
            let by_damping = deviation(k, DAMPING_NODES);
            let damping = estimate.mode.damping_ratio() + by_damping * estimate.damping_ratio_std;
            let v = residual_vibration(train, frequency, damping.clamp(0.0, 1.0));
            let square = by_frequency * by_frequency + by_damping * by_damping;
            nodes.push((v, Float::exp(-0.5 * square)));
        }
    }
    let total: f64 = nodes.iter().map(|node| node.1).sum();
    let mean = nodes.iter().map(|node| node.0 * node.1).sum::<f64>() / total;
    nodes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut below = 0.0;
    let quantile = nodes.iter().find(|node| {
        below += node.1;
        below >= 0.95 * total
    });
    (mean, quantile.map_or(mean, |node| node.0))
}

/// The `i`-th of `count` evenly spaced deviations from `-REACH` to `REACH`.
fn deviation(i: usize, count: usize) -> f64 {
    REACH * (2.0 * i as f64 / (count - 1) as f64 - 1.0)
}
