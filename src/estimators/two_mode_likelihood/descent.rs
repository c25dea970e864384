//! From a start to the best pair of modes near it, a bounded number of samples a tick, and along with new
//! samples from there.

use quell_shapers::Mode;

use super::fit::{Fit, Priors, fit, profile};
use super::pair::Pair;
use crate::estimators::likelihood::noise::Noise;
use crate::estimators::likelihood::region::{TRUST, bounded};
use crate::estimators::{Sample, Settings};

/// What a new linearisation must promise to gain, in variances of the noise: a tenth of a standard deviation
/// squared.
const WORTH: f64 = 0.01;
/// Step below which rounding is all that moves it.
const ROUNDING: f64 = 1e-9;
/// Damping above which there is nothing to gain from here, as the samples stand.
const STUCK: f64 = 1e6;

/// Levenberg and Marquardt's method along a growing window.
///
/// Source: D. W. Marquardt, J. Soc. Indust. Appl. Math. 11 (1963) 431-441.
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    /// The best linearisation so far.
    best: Option<(Pair, Fit)>,
    candidate: Option<Pair>,
    damping: f64,
    /// Level of the noise as the best one leaves it.
    pub noise: Noise,
}

/// What a descent must know of the rest.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// What was told before the first sample.
    pub settings: &'a Settings,
    /// The window.
    pub samples: &'a [Sample],
    /// Priors of a pair.
    pub priors: &'a Priors,
    /// The largest deformation so far.
    pub largest: f64,
}

impl Descent {
    /// A descent that begins at a pair of modes, at a level of the noise.
    pub fn new(modes: [Mode; 2], noise: Noise, sample_time: f64) -> Self {
        Self {
            best: None,
            candidate: Some(Pair::new(modes, sample_time)),
            damping: 0.0,
            noise,
        }
    }

    /// The best linearisation and its fit.
    pub fn best(&self) -> Option<&(Pair, Fit)> {
        self.best.as_ref()
    }

    /// The modes that it stands at, or begins with.
    pub fn modes(&self) -> Option<[Mode; 2]> {
        let best = self.best.as_ref().map(|(pair, _)| pair);
        best.or(self.candidate.as_ref()).map(|pair| pair.modes)
    }

    /// Whether it has arrived, as the samples stand.
    pub fn rests(&self) -> bool {
        self.candidate.is_none()
    }

    /// Takes what is new in the window.
    pub fn follow(&mut self, ground: &Ground<'_>) {
        let Some((pair, _)) = &mut self.best else {
            return;
        };
        pair.absorb(ground.samples);
        // What has failed is tried again once there are more data.
        self.damping *= 0.9;
        self.refit(ground);
    }

    fn refit(&mut self, ground: &Ground<'_>) {
        let Some((pair, old)) = &mut self.best else {
            return;
        };
        let Some(new) = fit(pair, ground.priors, self.noise.variance, 0.0) else {
            return;
        };
        *old = new;
        pair.weights = Some(new.residual);
        let spare = pair.taken - new.unknowns;
        let given = ground.settings.noise_std;
        self.noise = Noise::pooled(given, new.cost_after, spare, ground.largest);
    }

    /// New linearisations while they are worth it and the budget of samples lasts.
    pub fn advance(&mut self, ground: &Ground<'_>, budget: &mut usize) {
        while *budget > 0 {
            if self.candidate.is_none() {
                self.candidate = self.next(ground);
            }
            let Some(candidate) = &mut self.candidate else {
                return;
            };
            while *budget > 0 && candidate.walk.count < ground.samples.len() {
                candidate.absorb(ground.samples);
                *budget -= 1;
            }
            if candidate.walk.count < ground.samples.len() {
                return;
            }
            self.judge(ground);
            // The solution itself is as much work as some samples.
            *budget = budget.saturating_sub(8);
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
            damping => fit(pair, ground.priors, self.noise.variance, damping)?,
        };
        let modes = stepped(ground.settings, pair.modes, damped.step)?;
        let mut next = Pair::new(modes, ground.settings.sample_time);
        next.weights = Some(damped.linear_residual);
        Some(next)
    }

    /// Takes the candidate that has caught up where it leaves less.
    fn judge(&mut self, ground: &Ground<'_>) {
        let Some(candidate) = self.candidate.take() else {
            return;
        };
        let variance = self.noise.variance;
        let cost = profile(&candidate, ground.priors, variance);
        let present = self.best.as_ref().map_or(f64::INFINITY, |best| best.1.cost);
        let fitted = cost
            .filter(|cost| *cost <= present)
            .and_then(|_| fit(&candidate, ground.priors, variance, 0.0));
        match fitted {
            Some(fitted) => {
                self.best = Some((candidate, fitted));
                self.damping *= 0.1;
                self.refit(ground);
            }
            None => self.damping = (10.0 * self.damping).max(1e-3),
        }
    }
}

/// The modes at the end of a step, cut to the trusted length and moved into the allowed ranges; `None` where
/// that leads nowhere.
pub fn stepped(settings: &Settings, modes: [Mode; 2], step: [f64; 4]) -> Option<[Mode; 2]> {
    let excess = (0..4).map(|n| step[n].abs() / TRUST[n % 2]);
    let cut = excess.fold(1.0, f64::max).recip();
    let end = |k: usize| {
        let w = modes[k].natural_frequency().ln() + cut * step[2 * k];
        bounded(
            settings,
            [w, modes[k].damping_ratio() + cut * step[2 * k + 1]],
        )
    };
    let ends = [end(0)?, end(1)?];
    let moved = |k: usize| {
        let w = ends[k].natural_frequency() / modes[k].natural_frequency() - 1.0;
        let xi = ends[k].damping_ratio() - modes[k].damping_ratio();
        w.abs().max(xi.abs()) > ROUNDING
    };
    (moved(0) || moved(1)).then_some(ends)
}
