//! A descent from a start to the best pair of modes near it. It uses a bounded number of samples a tick, and
//! follows new samples.

use quell_shapers::Mode;

use super::fit::{Fit, Priors, fit, profile};
use super::pair::{Pair, points};
use crate::estimators::Settings;
use crate::estimators::likelihood::noise::Noise;
use crate::estimators::likelihood::region::{Region, TRUST};
use crate::estimators::likelihood::{RULED_OUT, Window};

/// Least predicted gain of a new linearisation, in variances of the noise: a tenth of a standard deviation
/// squared.
const WORTH: f64 = 0.01;
/// Step of `ln w` or `xi` below which only rounding is left. It is well above the 2e-16 of a double, since
/// normal equations lose digits, and a thousandth of the uncertainty of a window of 65 536 samples at a noise
/// of 1e-4.
const ROUNDING: f64 = 1e-9;
/// Linearisations after which the direction of a descent is clear. The first steps are cut to [`TRUST`]; three
/// of them pass the grid's neighbours in frequency (a tenth) and a quarter in damping.
const FOUND: u32 = 3;
/// Damping that holds an unknown: a step is reduced to 1e-15 of itself, which has no effect.
const HOLDS: f64 = 1e15;
/// Damping above which no gain is left with the present samples: a millionth of a step gains two millionths of
/// the predicted gain.
const STUCK: f64 = 1e6;
/// Factor of the damping after a failed step, and its inverse after a successful one, as in Marquardt's paper;
/// and the first damping, which shortens a step by a thousandth.
const FACTOR: f64 = 10.0;
const FIRST: f64 = 1e-3;
/// Factor of the damping with each new sample: a failed step is tried again after 22 of them.
const EASES: f64 = 0.9;
/// Cost of a solution, in samples of a pair: two fits of 14 unknowns each, and a profile of 2, as measured (75
/// ns a sample). By its number of products a fit would cost some two samples, but each sum of a factor depends
/// on the one before.
const SOLUTION: usize = 30;

/// Levenberg and Marquardt's method along a growing window.
///
/// Source: D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963) 431-441.
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    /// The best linearisation so far.
    best: Option<(Pair, Fit)>,
    candidate: Option<Pair>,
    damping: f64,
    /// Number of linearisations so far.
    taken: u32,
    /// Damping of unknowns at the edge of their range that would leave it.
    held: [f64; 4],
    /// Noise level by the residual of the best one.
    pub noise: Noise,
}

/// The context of a descent.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The settings from before the first sample.
    pub settings: &'a Settings,
    /// The window.
    pub window: &'a Window,
    /// Priors of a pair.
    pub priors: &'a Priors,
    /// The largest deformation so far.
    pub largest: f64,
    /// Sum of squares with one mode.
    pub one: f64,
}

impl Descent {
    /// A descent from a pair of modes, at a given level of the noise.
    pub fn new(modes: [Mode; 2], noise: Noise, sample_time: f64) -> Self {
        Self {
            best: None,
            candidate: Some(Pair::new(modes, sample_time)),
            damping: 0.0,
            taken: 0,
            held: [0.0; 4],
            noise,
        }
    }

    /// The best linearisation and its fit.
    pub fn best(&self) -> Option<&(Pair, Fit)> {
        self.best.as_ref()
    }

    /// The present modes, or those at the start.
    pub fn modes(&self) -> Option<[Mode; 2]> {
        let best = self.best.as_ref().map(|(pair, _)| pair);
        best.or(self.candidate.as_ref()).map(|pair| pair.modes)
    }

    /// Whether it has converged on the present samples.
    pub fn rests(&self) -> bool {
        self.candidate.is_none()
    }

    /// Whether it will not exclude a single mode: its direction is clear, and the predicted gain is too small.
    pub fn is_hopeless(&self, ground: &Ground<'_>) -> bool {
        self.taken >= FOUND
            && self.best.is_some_and(|(_, fit)| {
                self.noise.evidence(ground.one - fit.cost_after) < 0.5 * RULED_OUT
            })
    }

    /// Processes the new samples of the window.
    pub fn follow(&mut self, ground: &Ground<'_>) {
        let Some((pair, _)) = &mut self.best else {
            return;
        };
        pair.absorb(ground.window);
        // A failed step is tried again once there are more data.
        self.damping *= EASES;
    }

    /// Fits again with all samples of the best linearisation.
    pub fn refit(&mut self, ground: &Ground<'_>) {
        let variance = self.noise.variance;
        let best = self.best.as_ref();
        let new = best.and_then(|(pair, _)| fit(pair, ground.priors, variance, &[0.0; 4]));
        if let Some(new) = new {
            self.settle(new, ground);
        }
    }

    /// Stores a fit of the best linearisation, and its noise level.
    fn settle(&mut self, mut new: Fit, ground: &Ground<'_>) {
        let Some((pair, old)) = &mut self.best else {
            return;
        };
        let variance = self.noise.variance;
        // At the edge of the allowed ranges the other unknowns go on alone.
        self.held = held(ground.settings, pair.modes, new.step);
        if self.held.iter().any(|&held| held > 0.0)
            && let Some(rest) = fit(pair, ground.priors, variance, &self.held)
        {
            new = Fit {
                covariance: new.covariance,
                ..rest
            };
        }
        *old = new;
        pair.weights = Some(new.residual);
        let spare = pair.taken - new.unknowns;
        let given = ground.settings.noise_std;
        self.noise = Noise::pooled(given, new.cost_after, spare, ground.largest);
    }

    /// New linearisations as long as they are worth it and the budget of samples lasts.
    pub fn advance(&mut self, ground: &Ground<'_>, budget: &mut usize) {
        while *budget > 0 {
            if self.candidate.is_none() {
                self.candidate = self.next(ground);
            }
            let Some(candidate) = &mut self.candidate else {
                return;
            };
            while *budget > 0 && candidate.walk.count < ground.window.samples().len() {
                candidate.absorb(ground.window);
                *budget -= 1;
            }
            if candidate.walk.count < ground.window.samples().len() {
                return;
            }
            self.judge(ground);
            *budget = budget.saturating_sub(SOLUTION);
        }
    }

    /// The linearisation at the end of a step, where it is worth one.
    fn next(&self, ground: &Ground<'_>) -> Option<Pair> {
        let (pair, best) = self.best.as_ref()?;
        let gain = best.cost - best.cost_after;
        if gain <= WORTH * self.noise.variance || self.damping > STUCK {
            return None;
        }
        let damped = match self.damping {
            damping if damping < ROUNDING => *best,
            damping => {
                let damped = self.held.map(|held| held + damping);
                fit(pair, ground.priors, self.noise.variance, &damped)?
            }
        };
        let modes = stepped(ground.settings, pair.modes, damped.step)?;
        let mut next = Pair::new(modes, ground.settings.sample_time);
        next.weights = Some(damped.linear_residual);
        Some(next)
    }

    /// Accepts a candidate that has caught up, if it has a lower cost.
    fn judge(&mut self, ground: &Ground<'_>) {
        let Some(candidate) = self.candidate.take() else {
            return;
        };
        self.refit(ground);
        let variance = self.noise.variance;
        let cost = profile(&candidate, ground.priors, variance);
        let present = self.best.as_ref().map_or(f64::INFINITY, |best| best.1.cost);
        let fitted = cost
            .filter(|cost| *cost <= present)
            .and_then(|_| fit(&candidate, ground.priors, variance, &[0.0; 4]));
        match fitted {
            Some(fitted) => {
                self.best = Some((candidate, fitted));
                self.damping /= FACTOR;
                self.taken += 1;
                self.settle(fitted, ground);
            }
            None => self.damping = (FACTOR * self.damping).max(FIRST),
        }
    }
}

/// Damping for unknowns at the edge of their range that a step would push beyond it.
fn held(settings: &Settings, modes: [Mode; 2], step: [f64; 4]) -> [f64; 4] {
    let Some(ends) = stepped(settings, modes, step) else {
        return [0.0; 4];
    };
    let (from, to) = (points(modes), points(ends));
    core::array::from_fn(|n| {
        let stays = (to[n] - from[n]).abs() < ROUNDING && step[n].abs() > ROUNDING;
        if stays { HOLDS } else { 0.0 }
    })
}

/// The modes at the end of a step, cut to the trusted length and moved into the allowed ranges; `None` where
/// these are no modes.
pub fn stepped(settings: &Settings, modes: [Mode; 2], step: [f64; 4]) -> Option<[Mode; 2]> {
    let excess = (0..4).map(|n| step[n].abs() / TRUST[n % 2]);
    let cut = excess.fold(1.0, f64::max).recip();
    let from = points(modes);
    let to: [f64; 4] = core::array::from_fn(|n| from[n] + cut * step[n]);
    let region = Region::new(settings.frequency_range);
    let ends = [region.mode([to[0], to[1]])?, region.mode([to[2], to[3]])?];
    let reached = points(ends);
    let moves = (0..4).any(|n| (reached[n] - from[n]).abs() > ROUNDING);
    moves.then_some(ends)
}
