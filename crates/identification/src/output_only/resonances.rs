//! Resonances in the spectrum of a response to a sweep or of a machine at work, by maximum likelihood.
//!
//! `S(f) = f^p |d + sum_k (c_k + j r_k e_k) / (1 - r_k^2 + 2 j xi_k r_k)|^2 + n`, `r_k = f / f_k`: a coherent
//! output of any number of modes, and the noise of the sensor. For a sweep the density of the excitation is a
//! power `p` of the frequency and the modes are normal ones, for which an acceleration has `e_k = 2 xi_k c_k`;
//! otherwise `p = 0`, and `e_k` is free. A band of `M` lines has a gamma density of mean `S` (Whittle's
//! likelihood); the sum of its deviances is minimised. The excess of the deviances over chance scales the
//! standard deviations.
//!
//! Source: P. Whittle, Arkiv for Matematik 2 (1953); P. McCullagh and J. A. Nelder, Generalized Linear Models (1989), ch. 8.

use super::super::stop::Stop;
use super::density::{Density, Taken, density};
use super::least_squares::{Minimum, Squares, minimise};
use super::response::{DRIFT, EACH, POWERS, Resonance, Response, SHARED};
use super::{Excitation, FoundMode, OutputOnly, Vibration};
use crate::IdentificationError;
use nalgebra::{DMatrix, DVector};
use quell_shapers::{Mode, UncertainMode};
use quell_signal::{STRONG, SignalError};

/// Relative width of a band: a mode with a damping ratio of 0.005 has four in its half-power width.
const WIDTH: f64 = 0.0025;
/// Most modes.
const MOST: usize = 6;
/// Damping ratios at which a mode's fit starts, each with the width over which its peak is searched.
const STARTS: [f64; 3] = [0.01, 0.03, 0.1];
/// Starting values of a sweep's power: a constant acceleration, and one that grows with frequency.
const EXCITATIONS: [f64; 2] = [0.0, 2.0];
/// Standard deviations that chance exceeds on one side once in twenty times.
const CERTAIN: f64 = 1.645;
/// Factors on the sweep's ends that exclude the edges, where its spectrum falls.
const ENDS: [f64; 2] = [1.05, 0.96];
/// Least number of cycles in the record, and largest share of the rate, for modes of a machine at work.
const LOWEST: f64 = 8.0;
const HIGHEST: f64 = 0.4;
/// Misfit of a band below which rounding of its deviance would show.
const AGREES: f64 = 1e-5;
/// The smallest reported share of the strongest mode.
const LEAST: f64 = 0.02;

/// The modes along the direction of most motion; none where none is significant.
///
/// # Errors
/// [`IdentificationError`] where the record is too short for a spectrum.
pub fn modes(
    vibration: &Vibration,
    sweep: Option<[f64; 2]>,
    stop: Stop,
) -> Result<OutputOnly, IdentificationError> {
    let seconds = vibration.axes[0].len() as f64 / vibration.rate;
    let band = match sweep {
        Some([from, to]) => [from * ENDS[0], to * ENDS[1]],
        None => [LOWEST / seconds, HIGHEST * vibration.rate],
    };
    let taken = match sweep {
        Some(_) => Taken::Untapered,
        None => Taken::WithoutSines,
    };
    let density = density(&vibration.principal(), band, WIDTH, taken);
    let found = density.power.iter().filter(|power| **power > 0.0).count();
    if found < 32 || found < density.power.len() {
        let (what, needed) = ("spectrum", 32);
        return Err(SignalError::TooFew {
            what,
            found,
            needed,
        }
        .into());
    }
    let problem = Problem::new(&density, sweep.is_some(), stop);
    let models = problem.grow();
    let (best, found, needed) = problem.best(&models);
    let excitation = sweep.map_or(Excitation::Work, |[from, to]| Excitation::Sweep {
        from,
        to,
    });
    Ok(OutputOnly {
        excitation,
        modes: problem.told(best),
        left_out: Vec::new(),
        stretches: vec![[vibration.start, vibration.start + seconds]],
        explained: problem.explained(best),
        evidence: [found, needed],
    })
}

/// The density to be fitted.
struct Problem<'a> {
    density: &'a Density,
    is_sweep: bool,
    /// Logarithm of each band's frequency over the middle: an exponential is three times as fast as a power.
    logarithms: Vec<f64>,
    stop: Stop<'a>,
}

impl<'a> Problem<'a> {
    fn new(density: &'a Density, is_sweep: bool, stop: Stop<'a>) -> Self {
        let mut problem = Self {
            density,
            is_sweep,
            logarithms: Vec::new(),
            stop,
        };
        let middle = problem.middle();
        let logarithms = density.frequency.iter().map(|own| (own / middle).ln());
        problem.logarithms = logarithms.collect();
        problem
    }

    /// The reference frequency of the excitation's power, Hz: the geometric middle.
    fn middle(&self) -> f64 {
        let [first, last] =
            [0, self.density.frequency.len() - 1].map(|k| self.density.frequency[k]);
        (first * last).sqrt()
    }

    /// The density of the model at each band.
    fn model(&self, at: &[f64]) -> Vec<f64> {
        let response = Response::at(at, self.is_sweep);
        let bands = self.density.frequency.iter().zip(&self.logarithms);
        bands
            .map(|(frequency, logarithm)| response.density(*frequency, *logarithm))
            .collect()
    }

    fn fit(&self, start: &[f64]) -> Option<Minimum> {
        minimise(self, start, self.stop)
    }

    /// Models of no mode, of one, of two, with the excitation's power that gives the best end.
    fn grow(&self) -> Vec<Minimum> {
        let powers = if self.is_sweep {
            &EXCITATIONS[..]
        } else {
            &[0.0]
        };
        let chains: Vec<Vec<Minimum>> = std::thread::scope(|scope| {
            let begun: Vec<_> = powers
                .iter()
                .map(|power| scope.spawn(|| self.grow_from(*power)))
                .collect();
            begun
                .into_iter()
                .filter_map(|chain| chain.join().ok())
                .collect()
        });
        let end = |chain: &Vec<Minimum>| chain.last().map_or(f64::INFINITY, |last| last.cost);
        chains
            .into_iter()
            .min_by(|a, b| end(a).total_cmp(&end(b)))
            .unwrap_or_default()
    }

    fn grow_from(&self, power: f64) -> Vec<Minimum> {
        let mut powers = self.density.power.clone();
        powers.sort_unstable_by(f64::total_cmp);
        let middle = powers[powers.len() / 2].sqrt();
        let noise = powers[powers.len() / 10].max(f64::MIN_POSITIVE).ln() - 1.0;
        let start = [middle, noise, power];
        // Without a mode everything may be fitted as noise: the first mode starts with small noise and direct
        // term.
        let mut base = vec![0.1 * middle, noise, power];
        // The modes as their peaks look, not yet fitted: a first mode that is fitted to several peaks is too broad
        // to be a start for two.
        let mut peaks = base.clone();
        let mut models: Vec<Minimum> = self.fit(&start).into_iter().collect();
        while let Some(last) = models.last()
            && models.len() <= MOST
        {
            let starts = STARTS.iter().flat_map(|ratio| self.with(&base, *ratio));
            let misfit = |at: &Vec<f64>| {
                self.residual(at)
                    .map_or(f64::INFINITY, |r| r.norm_squared())
            };
            let looks = STARTS.iter().flat_map(|ratio| self.with(&peaks, *ratio));
            let next = looks.min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
            peaks = next.unwrap_or(peaks);
            let starts = starts.chain([peaks.clone()]);
            let fits = starts.filter_map(|start| self.fit(&start));
            let fits = fits.filter(|fit| self.are_distinct(&fit.at));
            let better = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
            // Fall of the deviance by a mode that fits chance.
            let gain = EACH as f64 * (self.density.power.len() as f64).ln() * self.dispersion(last);
            let better = better.map(|fit| self.otherwise_excited(fit));
            match better.filter(|fit| fit.cost < last.cost) {
                Some(fit) => {
                    let ended = last.cost - fit.cost < 0.5 * gain;
                    base.clone_from(&fit.at);
                    models.push(fit);
                    if ended {
                        break;
                    }
                }
                None => break,
            }
        }
        models
    }

    /// The best of a model and of its refits under other excitations.
    fn otherwise_excited(&self, model: Minimum) -> Minimum {
        if !self.is_sweep {
            return model;
        }
        let others = drivings(&model.at).into_iter();
        let others = others.filter_map(|other| self.fit(&self.excited_by(&model.at, &other)));
        let others = others.filter(|other| self.are_distinct(&other.at));
        let best = others.min_by(|a, b| a.cost.total_cmp(&b.cost));
        match best {
            Some(best) if best.cost < model.cost => best,
            _ => model,
        }
    }

    /// The start for a refit under another excitation: each mode's amplitude is kept at its own frequency.
    fn excited_by(&self, at: &[f64], other: &Driving) -> Vec<f64> {
        let mut start = at.to_vec();
        let change = 0.5 * (start[2].clamp(POWERS[0], POWERS[1]) - other.power);
        for mode in start[SHARED..].chunks_exact_mut(EACH) {
            mode[2] *= (mode[0].exp() / self.middle()).powf(change);
        }
        if let Some(last) = start[SHARED..].chunks_exact_mut(EACH).last() {
            last[2] *= other.sign;
        }
        let all: f64 = start[SHARED..].chunks_exact(EACH).map(|mode| mode[2]).sum();
        start[0] = if other.is_force { -all } else { 0.0 };
        start[2] = other.power;
        start
    }

    /// Whether no two modes are nearer than half the half-power width of the sharper one. Such a pair is one
    /// mode, split into parts that cancel each other.
    fn are_distinct(&self, at: &[f64]) -> bool {
        let modes: Vec<Resonance> = at[SHARED..]
            .chunks_exact(EACH)
            .map(|mode| Resonance::at(mode, self.is_sweep))
            .collect();
        let width = |mode: &Resonance| mode.frequency * mode.ratio;
        let apart = |a: &Resonance, b: &Resonance| {
            (a.frequency - b.frequency).abs() > 0.5 * width(a).min(width(b))
        };
        (0..modes.len()).all(|k| modes[..k].iter().all(|other| apart(&modes[k], other)))
    }

    /// A model with one more mode, where bands of a width exceed it most; with either sign.
    fn with(&self, at: &[f64], ratio: f64) -> [Vec<f64>; 2] {
        let Density {
            frequency,
            power,
            lines,
            ..
        } = self.density;
        let model = self.model(at);
        let excess: Vec<f64> = power
            .iter()
            .zip(model)
            .map(|(power, model)| (power / model).ln())
            .collect();
        let reach = ((ratio / WIDTH) as usize).clamp(1, power.len() / 4);
        // Excess of a band of this width over one four times as wide.
        let mean = |k: usize, reach: usize| {
            let range = k.saturating_sub(reach)..(k + reach + 1).min(power.len());
            let weight: f64 = lines[range.clone()].iter().sum();
            (
                range.map(|i| excess[i] * lines[i]).sum::<f64>() / weight,
                weight,
            )
        };
        let sum = |k: usize| {
            let ((inside, weight), (around, _)) = (mean(k, reach), mean(k, 4 * reach));
            (inside - around) * weight.sqrt()
        };
        let best = (0..power.len())
            .max_by(|a, b| sum(*a).total_cmp(&sum(*b)))
            .unwrap_or(0);
        let around = best.saturating_sub(reach / 2)..(best + reach / 2 + 1).min(power.len());
        let top = around
            .max_by(|a, b| power[*a].total_cmp(&power[*b]))
            .unwrap_or(best);
        let unit = match self.is_sweep {
            true => (frequency[top] / self.middle()).powf(at[2]),
            false => 1.0,
        };
        let amplitude = 2.0 * ratio * (power[top] / unit).sqrt();
        [1.0, -1.0].map(|sign| {
            let logit = (ratio / (DRIFT - ratio)).ln();
            let mode = [frequency[top].ln(), logit, sign * amplitude, 0.0];
            [at, &mode].concat()
        })
    }

    /// The model with the best Bayesian criterion where its evidence is strong, the evidence, and the value that is
    /// strong for each of its modes. Deviances are relative to the dispersion of the largest model.
    fn best<'m>(&self, models: &'m [Minimum]) -> (Option<&'m Minimum>, f64, f64) {
        let Some(last) = models.last() else {
            return (None, 0.0, STRONG);
        };
        let bands = self.density.power.len() as f64;
        // Modes that fit chance leave less than chance.
        let dispersion = self.dispersion(last).max(1.0);
        let needed = |model: &Minimum| {
            let unknowns = model.at.len() - SHARED;
            unknowns as f64 * bands.ln() + (unknowns / EACH) as f64 * STRONG
        };
        let score = |model: &&Minimum| model.cost / dispersion + needed(model);
        let best = models.iter().min_by(|a, b| score(a).total_cmp(&score(b)));
        let found = best.map_or(0.0, |best| (models[0].cost - best.cost) / dispersion);
        let needed = best.map_or(0.0, needed).max(STRONG);
        (best.filter(|_| found >= needed), found, needed)
    }

    /// Deviance over its expectation by chance alone.
    fn dispersion(&self, model: &Minimum) -> f64 {
        let bands = self.density.power.len();
        let freedom = bands.saturating_sub(model.at.len()).max(1);
        model.cost * bands as f64 / (self.density.chance() * freedom as f64)
    }

    fn explained(&self, best: Option<&Minimum>) -> f64 {
        let power = &self.density.power;
        let Some(best) = best else {
            return 0.0;
        };
        let mean = power.iter().map(|p| p.ln()).sum::<f64>() / power.len() as f64;
        let all: f64 = power.iter().map(|p| (p.ln() - mean).powi(2)).sum();
        let model = self.model(&best.at);
        let left = power
            .iter()
            .zip(model)
            .map(|(power, model)| (power / model).ln().powi(2));
        (1.0 - left.sum::<f64>() / all).max(0.0)
    }

    /// The modes of a model, the strongest first, without drift and lines below the resolution of the record.
    fn told(&self, best: Option<&Minimum>) -> Vec<FoundMode> {
        let Some(best) = best.filter(|best| best.at.len() > SHARED) else {
            return Vec::new();
        };
        let dispersion = self.dispersion(best).max(1e-6);
        let variance = |a: usize, b: usize| {
            best.inverse
                .as_ref()
                .map_or(f64::NAN, |i| i[(a, b)] * dispersion)
        };
        let mut modes = Vec::new();
        for (k, mode) in best.at[SHARED..].chunks_exact(EACH).enumerate() {
            let Resonance {
                frequency,
                ratio,
                amplitudes: [straight, turned],
            } = Resonance::at(mode, self.is_sweep);
            let place = SHARED + EACH * k;
            let narrow = 2.0 * ratio * frequency
                < (1.5 * self.density.resolution).max(0.5 * WIDTH * frequency);
            let inside = self.density.frequency.first() < Some(&frequency)
                && Some(&frequency) < self.density.frequency.last();
            let Ok(known) = Mode::from_hertz(frequency, ratio) else {
                continue;
            };
            // Its width must be more than zero and less than that of drift whose peak is not half above its floor.
            let ratio_std = ratio * (1.0 - ratio / DRIFT) * variance(place + 1, place + 1).sqrt();
            let beyond = CERTAIN * ratio_std;
            let is_told = beyond < ratio && ratio + beyond < 0.5 * DRIFT;
            if narrow || !inside || !is_told {
                continue;
            }
            modes.push(FoundMode {
                known: UncertainMode {
                    mode: known,
                    natural_frequency_std: known.natural_frequency()
                        * variance(place, place).sqrt(),
                    damping_ratio_std: ratio_std,
                },
                share: match self.is_sweep {
                    true => straight.abs(),
                    false => straight.hypot(turned),
                },
                frequency_shift: 0.0,
                frequency_shift_std: 0.0,
                damping_shift: 0.0,
            });
        }
        let largest = modes
            .iter()
            .map(|mode| mode.share)
            .fold(f64::MIN_POSITIVE, f64::max);
        modes.iter_mut().for_each(|mode| mode.share /= largest);
        modes.retain(|mode| mode.share > LEAST);
        modes.sort_by(|a, b| b.share.total_cmp(&a.share));
        modes
    }
}

impl Squares for Problem<'_> {
    /// Deviances of the bands, each with the sign of its misfit.
    fn residual(&self, at: &[f64]) -> Option<DVector<f64>> {
        let Density { power, lines, .. } = self.density;
        let model = self.model(at);
        let band = |k: usize| {
            let ratio = power[k] / model[k];
            (2.0 * lines[k] * deviance(ratio))
                .sqrt()
                .copysign(ratio - 1.0)
        };
        let residual = DVector::from_iterator(power.len(), (0..power.len()).map(band));
        residual.iter().all(|r| r.is_finite()).then_some(residual)
    }

    /// Of the residual `z = +-sqrt(2 M D)` with the deviance `D = q - 1 - ln q`, `q = power / S`:
    /// `dz / dS = -(q - 1) M / (z S)`.
    fn normal(&self, at: &[f64], residual: &DVector<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let Density {
            frequency,
            power,
            lines,
            ..
        } = self.density;
        let response = Response::at(at, self.is_sweep);
        // A column for each band.
        let mut turned = DMatrix::zeros(at.len(), power.len());
        for (k, mut slopes) in turned.column_iter_mut().enumerate() {
            let model = response.density(frequency[k], self.logarithms[k]);
            response.slopes(frequency[k], self.logarithms[k], slopes.as_mut_slice());
            let above = power[k] / model - 1.0;
            // Where both agree, `z = (q - 1) sqrt(M)`.
            let over = match above.abs() < AGREES {
                true => lines[k].sqrt(),
                false => above * lines[k] / residual[k],
            };
            slopes *= -over / model;
        }
        let normal = &turned * turned.transpose();
        let gradient = turned * residual;
        let is_finite = normal.iter().chain(&gradient).all(|one| one.is_finite());
        is_finite.then_some((normal, gradient))
    }
}

/// How the modes of a sweep may be driven.
struct Driving {
    /// Power of the frequency in its density.
    power: f64,
    /// Sign of the last of several modes.
    sign: f64,
    /// Whether it is a force, whose direct term leaves no acceleration at low frequency, and not a moving base, which
    /// has none.
    is_force: bool,
}

/// What a model is refitted under: of a single mode the sign says nothing.
fn drivings(at: &[f64]) -> Vec<Driving> {
    let is_one = at.len() < SHARED + 2 * EACH;
    let signs = if is_one { &[1.0][..] } else { &[1.0, -1.0] };
    let mut all = Vec::new();
    for &power in &EXCITATIONS {
        for &sign in signs {
            all.extend([false, true].map(|is_force| Driving {
                power,
                sign,
                is_force,
            }));
        }
    }
    all
}

/// The deviance of a gamma density whose mean is off by a ratio.
fn deviance(ratio: f64) -> f64 {
    let deviance = ratio - 1.0 - ratio.ln();
    // Rounding may make it negative where both agree; NaN stays NaN.
    if deviance < 0.0 { 0.0 } else { deviance }
}
