//! All estimators over one stretch, and the off-line references on the same samples.

use quell_shapers::Mode;

use super::input_noise::{White, white_of_two};
use super::stretches::{self, FreeDecay, Stretch};
use quell_control::estimators::offline::{BatchFit, Extremum, batch_fit, fourier, mode_of_extrema};
use quell_control::estimators::{ESTIMATORS, Estimate, EstimatorEntry, Sample, Settings};

/// Points of an estimate's history that are kept for a figure.
const HISTORY: usize = 3000;

/// The treatment of the motor side in a free decay.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// Taken as standing still. Its creep under feedback is below the speed that counts as rest, and as a
    /// regressor it would absorb a drift of the sensor's zero.
    Still,
    /// Taken as the known input, as in the moves.
    Known,
}

/// One estimator over one stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct OnLine {
    /// Name in the table of estimators.
    pub name: &'static str,
    /// The last estimate, if there is one.
    pub estimate: Option<Estimate>,
    /// A second mode, if it reported one at the end.
    pub further: Option<Estimate>,
    /// Share of that mode in what the sensor sees of the motion; a free decay does not tell it.
    pub further_share: Option<f64>,
    /// When it first called itself converged, s.
    pub converged_at: Option<f64>,
    /// The same in periods of its mode, counted from `counted_from` of the run.
    pub periods: Option<f64>,
    /// The estimate over time, thinned to 3000 points.
    pub history: Vec<Estimate>,
}

/// One off-line reference.
#[derive(Clone, Debug, PartialEq)]
pub struct OffLine {
    /// `batch_fit`, `fourier` or `log_decrement`.
    pub method: &'static str,
    /// Its estimate.
    pub mode: Mode,
    /// One standard deviation of `omega_n`, rad/s, where the method knows it.
    pub natural_frequency_std: Option<f64>,
    /// One standard deviation of `xi`, where the method knows it.
    pub damping_ratio_std: Option<f64>,
}

impl OffLine {
    /// The estimate of a method without standard deviations.
    fn plain(method: &'static str, mode: Mode) -> Self {
        Self {
            method,
            mode,
            natural_frequency_std: None,
            damping_ratio_std: None,
        }
    }
}

/// All estimators and references over one stretch.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The samples used.
    pub stretch: Stretch,
    /// Samples that the on-line estimators received: the same, but in a long recording the part in which the
    /// mode was searched.
    pub shown: Stretch,
    /// Samples of the batch fit: the same, but the part again if a long recording led it out of the range of
    /// frequencies.
    pub fitted: Stretch,
    /// Where periods to convergence are counted from, s: the motion's or the decay's start.
    pub counted_from: f64,
    /// Whether it is a free decay; else the motor side is a known input.
    pub is_free_decay: bool,
    /// The estimators that can take this stretch, in the order of their table.
    pub on_line: Vec<OnLine>,
    /// The references.
    pub off_line: Vec<OffLine>,
    /// Sum of squares of the deformation about its offset, to compare decays.
    pub energy: f64,
    /// Extrema of a free decay, half a period apart.
    pub extrema: Vec<Extremum>,
}

impl Run {
    /// The whole recording with the motor side as known input, and its batch fit with the samples of that. Batch fit
    /// and estimators that state their error receive the samples whose noise is white, if these differ;
    /// a second mode must show without that, too. Where two show, the noise is made white behind both.
    ///
    /// In a long recording the estimators receive a `part`. The likelihoods lose nothing by that, since they
    /// only use a window of 65 536 samples at most. The algebraic estimators sum over all samples, so that
    /// their estimates are of the part.
    pub(super) fn whole(
        samples: &[Sample],
        part: &[Sample],
        settings: &Settings,
        (fitted, fit, white): (&[Sample], Option<&BatchFit>, Option<&White>),
    ) -> Self {
        let counted_from = stretches::motion_from(part);
        let estimators = ESTIMATORS.iter().filter(|line| line.uses_motion);
        let shown = Stretch::all(part);
        let of = |line, samples| on_line(line, samples, settings, counted_from);
        let run = |line: &'static EstimatorEntry| match white {
            Some(white) if line.states_error => {
                let found = of(line, shown.of(&white.samples));
                // A departure from one linear mode may pass for a second mode in the filtered samples alone.
                let plain = found.further.map(|_| of(line, part));
                plain.filter(|own| own.further.is_none()).unwrap_or(found)
            }
            _ => {
                let found = of(line, part);
                let both = found.estimate.as_ref().zip(found.further.as_ref());
                let white = both.and_then(|(a, b)| white_of_two(part, [a, b], settings));
                let again = white.map(|white| on_line(line, &white, settings, counted_from));
                again.filter(|own| own.further.is_some()).unwrap_or(found)
            }
        };
        let batch = white.map(|white| &white.fit).or(fit);
        Self {
            stretch: Stretch::all(samples),
            shown,
            fitted: Stretch::all(fitted),
            counted_from,
            is_free_decay: false,
            on_line: estimators.map(run).collect(),
            off_line: batch.into_iter().map(batch_reference).collect(),
            energy: energy(fitted, fit),
            extrema: Vec::new(),
        }
    }

    /// With the deviations of the methods that know their error multiplied by a factor. A second mode whose damping ratio is
    /// then not above 0 by two deviations, 95 %, is one of the noise.
    pub(super) fn widened(mut self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        let wider = |own: &mut Estimate| {
            own.natural_frequency_std *= factor;
            own.damping_ratio_std *= factor;
        };
        for line in &mut self.on_line {
            let states_error =
                |entry: &&EstimatorEntry| entry.name == line.name && entry.states_error;
            if ESTIMATORS.iter().any(|entry| states_error(&entry)) {
                let ends = [&mut line.estimate, &mut line.further]
                    .into_iter()
                    .flatten();
                ends.chain(&mut line.history).for_each(wider);
                line.further = line
                    .further
                    .filter(|own| own.mode.damping_ratio() > 2.0 * own.damping_ratio_std);
            }
        }
        for line in &mut self.off_line {
            let deviations = [&mut line.natural_frequency_std, &mut line.damping_ratio_std];
            deviations
                .into_iter()
                .flatten()
                .for_each(|own| *own *= factor);
        }
        self
    }

    /// One free decay, and its batch fit.
    pub(super) fn free_decay(
        samples: &[Sample],
        decay: &FreeDecay,
        settings: &Settings,
        (input, fit): (Input, Option<&BatchFit>),
    ) -> Self {
        let FreeDecay { stretch, extrema } = decay.clone();
        let moving = stretch.of(samples);
        let still = still(moving);
        let samples = if input == Input::Known {
            moving
        } else {
            &still
        };
        let settings = for_a_decay(settings);
        let mut off_line: Vec<OffLine> = fit.map(batch_reference).into_iter().collect();
        let mode = fourier(samples, settings.frequency_range);
        off_line.extend(mode.map(|mode| OffLine::plain("fourier", mode)));
        let mode = mode_of_extrema(&extrema);
        off_line.extend(mode.map(|mode| OffLine::plain("log_decrement", mode)));
        Self {
            stretch,
            shown: stretch,
            fitted: stretch,
            counted_from: stretch.from,
            is_free_decay: true,
            on_line: ESTIMATORS
                .iter()
                .map(|line| {
                    // The methods for a free decay allow for a constant input only.
                    let samples = if line.uses_motion { samples } else { &still };
                    on_line(line, samples, &settings, stretch.from)
                })
                .collect(),
            off_line,
            energy: energy(samples, fit),
            extrema,
        }
    }

    /// The estimate of the batch fit, if there is one.
    pub fn batch(&self) -> Option<&OffLine> {
        self.off_line.iter().find(|line| line.method == "batch_fit")
    }

    /// The result of an estimator, if it ran here.
    pub fn estimator(&self, name: &str) -> Option<&OnLine> {
        self.on_line.iter().find(|line| line.name == name)
    }
}

/// The batch fit of a free decay.
pub(super) fn fit(
    samples: &[Sample],
    decay: &FreeDecay,
    settings: &Settings,
    input: Input,
) -> Option<BatchFit> {
    let samples = decay.stretch.of(samples);
    batch_fit(samples, &for_a_decay(settings), input == Input::Known)
}

/// In a free decay only the initial state matters.
fn for_a_decay(settings: &Settings) -> Settings {
    Settings {
        memory: f64::INFINITY,
        ..*settings
    }
}

/// The samples with the motor side fixed at its first position.
fn still(samples: &[Sample]) -> Vec<Sample> {
    let position = samples.first().map_or(0.0, |s| s.motor_position);
    let stand = |s: &Sample| Sample {
        motor_position: position,
        ..*s
    };
    samples.iter().map(stand).collect()
}

fn batch_reference(fit: &BatchFit) -> OffLine {
    OffLine {
        method: "batch_fit",
        mode: fit.mode,
        natural_frequency_std: Some(fit.natural_frequency_std),
        damping_ratio_std: Some(fit.damping_ratio_std),
    }
}

/// Sum of squares of the deformation about the offset that a fit found.
pub(super) fn energy(samples: &[Sample], fit: Option<&BatchFit>) -> f64 {
    let offset = fit.map_or(0.0, |fit| fit.offset);
    samples
        .iter()
        .map(|s| (s.deformation - offset).powi(2))
        .sum()
}

/// Feeds one estimator sample by sample.
fn on_line(line: &EstimatorEntry, samples: &[Sample], settings: &Settings, from: f64) -> OnLine {
    let mut estimator = (line.build)(settings);
    let every = samples.len().div_ceil(HISTORY).max(1);
    let mut history = Vec::with_capacity(HISTORY + 1);
    let mut converged_at = None;
    for (index, sample) in samples.iter().enumerate() {
        estimator.observe(*sample);
        let Some(estimate) = estimator.estimate() else {
            continue;
        };
        if estimate.converged && converged_at.is_none() {
            converged_at = Some(sample.time);
        }
        if index % every == 0 || index + 1 == samples.len() {
            history.push(Estimate {
                time: sample.time,
                ..estimate
            });
        }
    }
    let estimate = estimator.estimate();
    let periods = converged_at
        .zip(estimate)
        .map(|(time, estimate)| (time - from) * estimate.mode.hertz())
        // Convergence before the count begins gives no number of periods.
        .filter(|periods| *periods >= 0.0);
    OnLine {
        name: line.name,
        estimate,
        further: estimator.further(),
        further_share: estimator.further_share(),
        converged_at,
        periods,
        history,
    }
}
