//! Maximum likelihood of two modes, and the decision whether there are two.
//!
//! The measured deformation is taken as
//! ```text
//! delta = p_1 (q_1 - u) + p_2 (q_2 - u) + sum_m [c_m q_m' + a_m Re e^(lambda_m t) + b_m Im e^(lambda_m t)]
//!         + o + K u + noise,        p_1 + p_2 = 1 + g
//! q_m'' = w_m^2 (u - q_m) - 2 xi_m w_m q_m'
//! ```
//! With `p_2 = c_2 = a_2 = b_2 = 0` this is the model of [`Likelihood`]. That estimator runs beside it and
//! gives the estimate as long as one mode explains the samples. Two modes are reported once the likelihood
//! ratio excludes one.
//!
//! Under one mode the second's frequency and damping are undefined. So the ratio is not a chi-squared but the
//! maximum of a process over them. With two linear unknowns it exceeds `u` with a probability of about `B T (pi
//! u / 6)^(1/2) e^(-u/2)`, `B` the range of frequencies (Hz) and `T` the length. A free damping multiplies that
//! by about three, two more linear unknowns by `u / 2`. At `u = 30`, an octave to either side and six periods:
//! 3e-5 for a free decay, 5e-4 in motion. The correlation of the residual reduces the ratio by the same factor
//! by which it widens the standard deviations.
//!
//! Two modes of the same damping and frequency are one: their frequencies must differ by three standard
//! deviations of the difference. The simulated vibration relies on the input over the whole window, whatever
//! the `memory` of the settings.
//!
//! Source: output-error method, L. Ljung, System Identification, 2nd ed., ch. 7; likelihood ratio where a
//! nuisance exists under the alternative only, R. B. Davies, Biometrika 74 (1987) 33-43; its form for a
//! frequency, R. V. Baluev, Mon. Not. R. Astron. Soc. 385 (2008) 1279-1285.

mod descent;
mod fit;
mod grid;
mod pair;
mod search;

use quell_shapers::Mode;

use self::descent::{Descent, Ground, stepped};
use self::fit::{Fit, Priors, UNKNOWNS};
use self::search::Search;
use super::convergence::{Convergence, SETTLED};
use super::likelihood::{CONVERGENCE_PERIODS, Likelihood, RULED_OUT};
use super::{Estimate, Estimator, Sample, Settings};

pub(super) use self::fit::{Priors as PairPriors, fit as fit_pair, linear as fit_linear};
pub(super) use self::pair::Pair;

/// Share of the time between two samples that replays may take, so that the rest of a tick has enough time. And
/// the assumed time of one replayed sample, s: 75 ns were measured (one core at 2026-11-22), the rest is for
/// slower processors. All work is counted in such samples.
const REPLAY_SHARE: f64 = 0.05;
const REPLAY_TIME: f64 = 200e-9;
/// Number of fits in a period of the faster mode: a reported mode is at most a tenth of a radian old.
const FITS: f64 = 64.0;
/// Least and greatest number of samples that replays may take in one tick, whatever the rate. With the least,
/// the longest window of 65 536 samples is replayed in some 500 ticks. The greatest takes 0.2 ms, a fifth of a
/// tick of 1 kHz.
const REPLAYS: (f64, f64) = (128.0, 1024.0);
/// Standard deviations of the frequency difference that separate two modes: chance exceeds them once in 370
/// times.
const APART: f64 = 3.0;
/// Standard deviation of `ln w`, or of `xi`, above which a mode is not useful. Two of them are the half width
/// of a ZVD shaper's insensitivity at 5 % (0.33 of the frequency), and an error of either leaves the same.
const USEFUL: f64 = 0.08;
/// Damping ratio above which there is no oscillation: nine tenths are lost in a period. Two standard deviations
/// must exclude it, since a drift is no mode.
const RINGS: f64 = 0.35;
/// Largest next step of a frequency, as a share of the modes' distance: two steps towards each other leave half
/// of the distance.
const ARRIVED: f64 = 0.25;
/// Ratio of energies at which the other mode becomes the first. With equal energies noise would exchange them
/// at every fit; noise of 8 % does not cause a factor of two.
const CHANGES_PLACES: f64 = 2.0;

/// The likelihood estimator of two modes.
///
/// # Cost
/// One tick: that of [`Likelihood`], 128 to 1024 samples of a pair (a twentieth of the time between samples, where
/// that is more than 128), and a few 14 x 14 solutions; memory is taken in [`TwoModeLikelihood::new`] only.
#[derive(Clone, Debug)]
pub struct TwoModeLikelihood {
    settings: Settings,
    one: Likelihood,
    search: Search,
    active: Option<Descent>,
    /// Number of samples that replays may take in one tick.
    budget: usize,
    /// Time of the last fit, s.
    fitted_at: f64,
    /// Index of the mode with more energy.
    first: usize,
    convergence: [Convergence; 2],
    converged: [bool; 2],
    told: Option<[Estimate; 2]>,
    /// Share of the second of these in the motion's deformation.
    share: f64,
}

impl TwoModeLikelihood {
    /// An estimator; allocates all its memory.
    pub fn new(settings: &Settings) -> Self {
        let one = Likelihood::new(settings);
        Self {
            settings: *settings,
            search: Search::new(settings, one.mode()),
            one,
            active: None,
            budget: (REPLAY_SHARE * settings.sample_time / REPLAY_TIME)
                .max(REPLAYS.0)
                .min(REPLAYS.1) as usize,
            fitted_at: f64::NEG_INFINITY,
            first: 0,
            convergence: [Convergence::over(CONVERGENCE_PERIODS); 2],
            converged: [false; 2],
            told: None,
            share: 0.0,
        }
    }

    /// Updates the present fit and the search with the youngest sample.
    fn work(&mut self, due: bool) {
        let noise = self.active.as_ref().map_or(self.one.noise(), |a| a.noise);
        let modes = self.active.as_ref().and_then(Descent::modes);
        let modes = modes.unwrap_or([self.one.mode(); 2]);
        let priors = pair_priors(&self.one, noise.variance, modes);
        let ground = Ground {
            settings: &self.settings,
            window: self.one.window(),
            priors: &priors,
            largest: self.one.largest(),
            one: self.one.least_cost().unwrap_or(f64::INFINITY),
        };
        let mut budget = self.budget / 2;
        if let Some(active) = &mut self.active {
            active.follow(&ground);
            if due {
                active.refit(&ground);
            }
            active.advance(&ground, &mut budget);
        }
        self.search.follow(&ground);
        budget += self.budget / 2;
        // If both modes have converged, no search is needed.
        let settled = self.told.is_some() && self.converged == [true; 2];
        let around = (self.one.mode(), noise);
        if ground.window.samples().len() > UNKNOWNS
            && !settled
            && let Some(found) = self.search.advance(&ground, around, &mut budget)
        {
            if let Some(active) = &mut self.active {
                active.refit(&ground);
            }
            self.consider(found);
        }
    }

    /// Whether a fit is due, by the number of fits in a period of the faster mode.
    fn is_due(&mut self, time: f64) -> bool {
        let modes = self.active.as_ref().and_then(Descent::modes);
        let fastest = modes.map_or(f64::INFINITY, |[a, b]| a.hertz().max(b.hertz()));
        let due = (time - self.fitted_at) * fastest * FITS >= 1.0;
        if due {
            self.fitted_at = time;
        }
        due
    }

    /// Accepts the result of a search, if its cost is lower by more than the noise.
    fn consider(&mut self, found: Descent) {
        let Some((_, new)) = found.best() else { return };
        let old = self.active.as_ref().and_then(Descent::best);
        if old.is_none_or(|(_, old)| new.cost < old.cost - found.noise.variance) {
            self.first = usize::from(new.energy[1] > new.energy[0]);
            self.active = Some(found);
            self.forget();
        }
    }

    fn forget(&mut self) {
        self.convergence = [Convergence::over(CONVERGENCE_PERIODS); 2];
        self.converged = [false; 2];
    }

    /// The estimate of two modes, if there are two.
    fn conclude(&mut self, time: f64) {
        let replays = |active: &Descent| active.best().is_none() && !active.rests();
        let replays = |active| replays(active) || self.one.least_cost().is_none();
        if self.active.as_ref().is_some_and(replays) {
            // Half of the window was dropped, and the rest is not replayed yet.
            return;
        }
        let told = self.two(time);
        if told.is_none() && self.told.is_some() {
            self.forget();
        }
        self.told = told;
    }

    /// Whether the likelihood ratio excludes a single mode.
    fn excludes_one(&self, active: &Descent, pair: &Pair, fit: &Fit) -> bool {
        let Some(one) = self.one.least_cost() else {
            return false;
        };
        let inflation = pair.correlation.largest_inflation();
        let evidence = active
            .noise
            .coloured_evidence(one - fit.cost_after, inflation);
        active.noise.freedom > 0.0 && evidence > RULED_OUT
    }

    /// Both modes, the one with more energy first; `None` where one is enough, or two are not known well
    /// enough.
    fn two(&mut self, time: f64) -> Option<[Estimate; 2]> {
        let active = self.active.as_ref()?;
        let (pair, fit) = active.best()?;
        let inflation = pair.correlation.inflation();
        if !self.excludes_one(active, pair, fit) {
            return None;
        }
        let student = active.noise.student(self.settings.noise_std);
        let variance = active.noise.variance * student * inflation;
        let modes = stepped(&self.settings, pair.modes, fit.step).unwrap_or(pair.modes);
        if !are_two(fit, modes, variance, self.one.elapsed()) {
            return None;
        }
        let rests = active.rests();
        let [a, b] = [fit.energy[self.first], fit.energy[1 - self.first]];
        if b > CHANGES_PLACES * a {
            self.first = 1 - self.first;
        }
        let (covariance, gain) = (fit.covariance, fit.gain);
        let order = [self.first, 1 - self.first];
        self.share = fit.shares[order[1]];
        Some(order.map(|m| {
            let std = [2 * m, 2 * m + 1].map(|n| (covariance[n][n] * variance).sqrt());
            Estimate {
                time,
                mode: modes[m],
                natural_frequency_std: std[0] * modes[m].natural_frequency(),
                damping_ratio_std: std[1],
                gain: gain.0,
                gain_std: (gain.1 * variance).sqrt(),
                converged: self.settles(m, time, modes[m], std, rests),
            }
        }))
    }

    /// The convergence rule of [`Likelihood`], for each mode.
    fn settles(&mut self, m: usize, time: f64, mode: Mode, std: [f64; 2], rests: bool) -> bool {
        self.convergence[m].push(time, mode.natural_frequency(), mode.damping_ratio());
        let within = |limit: f64| std.iter().all(|std| *std < limit);
        self.converged[m] = match self.converged[m] {
            true => within(2.0 * SETTLED),
            false => within(SETTLED) && self.convergence[m].settled() && rests,
        };
        self.converged[m]
    }
}

/// Whether two modes have each vibrated for at least a period, and differ in frequency. Less than a period may
/// be a drift.
fn are_two(fit: &Fit, modes: [Mode; 2], variance: f64, elapsed: f64) -> bool {
    let [a, b] = modes.map(|mode| mode.natural_frequency().ln());
    let c = &fit.covariance;
    let difference = (c[0][0] + c[2][2] - 2.0 * c[0][2]) * variance;
    let std = |n: usize| (c[n][n] * variance).sqrt();
    let rings = |m: usize| {
        let [frequency, damping] = [std(2 * m), std(2 * m + 1)];
        frequency.max(damping) < USEFUL
            && modes[m].damping_ratio() + 2.0 * damping < RINGS
            && modes[m].hertz() * elapsed > 1.0
    };
    let spacing = (a - b).abs();
    let arrived = fit.step[0].abs().max(fit.step[2].abs()) < ARRIVED * spacing;
    arrived && spacing > APART * difference.max(0.0).sqrt() && rings(0) && rings(1)
}

/// Priors of a pair: those of one mode for each; the share of the second is free.
fn pair_priors(one: &Likelihood, variance: f64, modes: [Mode; 2]) -> Priors {
    let base = one.priors_for(variance);
    let [w, xi, a, b, offset, _, scale, gain] = base.precision;
    let rate = modes.map(|mode| mode.natural_frequency().powi(2));
    Priors {
        mean: base.mean,
        precision: [
            a, b, a, b, offset, rate[0], rate[1], scale, 1.0, gain, w, xi, w, xi,
        ],
    }
}

impl Estimator for TwoModeLikelihood {
    fn observe(&mut self, sample: Sample) {
        let before = self.one.window().samples().len();
        self.one.observe(sample);
        let now = self.one.window().samples().len();
        if now == before {
            return;
        }
        if now < before {
            // The window has slid: everything is replayed from its new first sample on.
            self.search.restart();
            if let Some(active) = &mut self.active
                && let Some(modes) = active.modes()
            {
                *active = Descent::new(modes, active.noise, self.settings.sample_time);
            }
        }
        let due = self.is_due(sample.time);
        self.work(due);
        if due {
            self.conclude(sample.time);
        }
    }

    fn estimate(&self) -> Option<Estimate> {
        match self.told {
            Some([first, _]) => Some(first),
            None => self.one.estimate(),
        }
    }

    fn further(&self) -> Option<Estimate> {
        self.told.map(|[_, second]| second)
    }

    fn further_share(&self) -> Option<f64> {
        self.told.map(|_| self.share)
    }

    fn restart(&mut self) {
        self.one.restart();
        self.search.restart();
        self.active = None;
        self.first = 0;
        self.fitted_at = f64::NEG_INFINITY;
        self.told = None;
        self.forget();
    }
}
