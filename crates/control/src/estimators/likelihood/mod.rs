//! Maximum likelihood of the output error, the motion phase included.
//!
//! The measured deformation is taken as
//! ```text
//! delta = (1 + g) (q - u) + c q' + a Re e^(lambda t) + b Im e^(lambda t) + o + K u + noise
//! q''   = w^2 (u - q) - 2 xi w q'
//! ```
//! with `lambda = -xi w + j w_d`. `c q'` is a clock's offset and, `c = 2 xi / w`, the damper across the joint
//! (`c = 0`: damper to ground); `a`, `b` are the vibration at the start of the window; `o` is the sensor's
//! offset; `g` its scale; `K` a static gain. All six enter linearly. No derivative of `u` is needed.
//!
//! A *track* is a linearisation at one `(w, xi)`. Along it the sensitivities are states of a filter, and the
//! sums of products of all columns contain all that a batch fit needs: a Gauss-Newton step costs O(1) a sample.
//! When the step leaves the linear range, a new track is started at its end and replays the stored window, a
//! bounded number of samples a tick. A coarse grid of tracks runs beside the active one until no other start
//! can explain the data.
//!
//! A sample that neither noise nor the uncertainty of the mode explains is a spike: only its input is used.
//! Three in a row are accepted.
//!
//! Source: output-error method, L. Ljung, System Identification, 2nd ed., ch. 7 and 10;
//! variable projection of the linear unknowns, G. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973).

mod absorb;
pub(super) mod cholesky;
mod fit;
mod gate;
mod moments;
pub(super) mod noise;
mod priors;
pub(super) mod region;
mod relinearise;
mod search;
mod track;
pub(super) mod walk;
mod window;

use quell_shapers::Mode;

pub(super) use self::absorb::Folding;
pub(super) use self::fit::fit;
pub(super) use self::priors::{Priors, inverse_square};
pub(super) use self::track::Track;
pub(super) use self::window::Window;

use self::fit::Fit;
use self::noise::{Noise, SPARE};
use self::region::{DAMPING_RANGE, Region, TRUST, log_point, trusted};
use super::convergence::{Convergence, SETTLED};
use super::correlation::Correlation;
use super::{Estimate, Estimator, Sample, Settings};

/// Ratio of neighbouring frequencies of the grid: half of it is within the trusted step.
const GRID_RATIO: f64 = 1.25;
/// Window, in periods, over which the estimates must agree before they count as converged.
pub(super) const CONVERGENCE_PERIODS: f64 = 0.25;
/// Unknowns: `w`, `xi`, and six linear ones.
const UNKNOWNS: f64 = 8.0;
/// Standard deviation of `ln w` above which no estimate is given.
pub(super) const USABLE: f64 = 0.2;
/// Difference of `-2 ln` likelihood that excludes another start (odds of 3e6).
pub(super) const RULED_OUT: f64 = 30.0;

/// The likelihood estimator.
///
/// # Cost
/// One tick: at most 1 + 128 + (grid) samples of some 100 ns and a few 8 x 8 solutions; memory is
/// taken in [`Likelihood::new`] only.
#[derive(Clone, Debug)]
pub struct Likelihood {
    settings: Settings,
    region: Region,
    /// The constant part of the priors.
    belief: Priors,
    window: Window,
    grid: Vec<Track>,
    active: Track,
    fit: Option<Fit>,
    candidate: Option<Track>,
    must_replace: bool,
    shrink: f64,
    locked: bool,
    largest: f64,
    noise: Noise,
    /// Number of samples in a row that were spikes, or would have been.
    outside: u32,
    correlation: Correlation,
    convergence: Convergence,
    converged: bool,
    estimate: Option<Estimate>,
}

impl Likelihood {
    /// An estimator; allocates all its memory: a window of samples and a grid of starts.
    pub fn new(settings: &Settings) -> Self {
        let (low, high) = settings.frequency_range;
        let intervals = ((high / low).ln() / GRID_RATIO.ln())
            .ceil()
            .clamp(1.0, 40.0);
        let damping = settings.belief.map_or(0.05, |mode| mode.damping_ratio());
        let grid: Vec<Track> = (0..=intervals as usize)
            .map(|k| low * (high / low).powf(k as f64 / intervals))
            .filter_map(|w| Mode::new(w, damping.clamp(DAMPING_RANGE.0, 0.2)).ok())
            .map(|mode| Track::new(mode, settings.sample_time))
            .collect();
        let fallback = Mode::new(core::f64::consts::TAU, 0.05).expect("1 Hz is a mode");
        let start = settings
            .belief
            .or(grid.first().map(|track| track.mode))
            .unwrap_or(fallback);
        let region = Region::new(settings.frequency_range);
        let start = region.mode(log_point(start)).unwrap_or(start);
        Self {
            settings: *settings,
            region,
            belief: Priors::believed(settings),
            window: Window::with_capacity(settings.capacity()),
            grid,
            active: Track::new(start, settings.sample_time),
            fit: None,
            candidate: None,
            must_replace: false,
            shrink: 1.0,
            locked: false,
            largest: 0.0,
            noise: Noise::default(),
            outside: 0,
            correlation: Correlation::default(),
            convergence: Convergence::over(CONVERGENCE_PERIODS),
            converged: false,
            estimate: None,
        }
    }

    /// Present priors: the vibration before the window is of the size of the deformations seen.
    fn priors(&self) -> Priors {
        self.priors_for(self.noise.variance)
    }

    /// The same at another level of the noise.
    pub(super) fn priors_for(&self, variance: f64) -> Priors {
        let mut priors = self.belief;
        let amplitude = inverse_square(10.0 * self.largest.max(1e-12));
        priors.precision[2] = amplitude;
        priors.precision[3] = amplitude;
        if self.settings.offset_std.is_none() {
            priors.precision[4] = variance.max(1e-30).recip();
        }
        // The damper across the joint needs 2 xi / w, at most 2 / w.
        priors.precision[5] = self.active.mode.natural_frequency().powi(2);
        priors
    }

    /// The samples in use; spikes have a deformation of NaN.
    pub(super) fn window(&self) -> &Window {
        &self.window
    }

    /// Length of the window, s.
    pub(super) fn elapsed(&self) -> f64 {
        let samples = self.window.samples();
        let ends = samples.first().zip(samples.last());
        ends.map_or(0.0, |(first, last)| last.time - first.time)
    }

    /// The mode at the linearisation.
    pub(super) fn mode(&self) -> Mode {
        self.active.mode
    }

    /// Level of the noise.
    pub(super) fn noise(&self) -> Noise {
        self.noise
    }

    /// The largest deformation so far.
    pub(super) fn largest(&self) -> f64 {
        self.largest
    }

    /// Sum of squares with one mode, at the end of the present step. `None` after a cut of the window until it
    /// has been replayed: the sums still contain samples that are no longer in it.
    pub(super) fn least_cost(&self) -> Option<f64> {
        let fit = self.fit.as_ref().filter(|_| !self.must_replace);
        fit.map(|fit| fit.cost_after)
    }

    fn folding(&self) -> Folding {
        Folding {
            memory: self.settings.memory,
            priors: self.priors(),
            variance: self.noise.variance,
        }
    }

    /// Pools a given noise level with the residual's.
    fn update_variance(&mut self) {
        let unknowns = self.fit.as_ref().map_or(UNKNOWNS, |fit| fit.unknowns);
        let square = self.fit.as_ref().map_or(0.0, |fit| fit.cost_after);
        let spare = self.active.taken() - unknowns;
        self.noise = Noise::pooled(self.settings.noise_std, square, spare, self.largest);
    }

    /// Whether there are enough samples to estimate the noise's level beside the mode.
    fn knows_noise(&self) -> bool {
        let unknowns = self.fit.as_ref().map_or(UNKNOWNS, |fit| fit.unknowns);
        self.noise.freedom > 0.0 && self.active.taken() >= unknowns + SPARE
    }

    fn is_evident(&self, difference: f64, limit: f64) -> bool {
        self.noise.is_evident(difference, limit)
    }

    fn refit(&mut self) {
        let priors = self.priors();
        self.fit = fit(&self.active, &priors, self.noise.variance);
    }

    /// Standard deviations of `ln w`, `xi` and the gain; where the noise's level was learned, those of
    /// Student's distribution.
    fn spread(&self, fit: &Fit) -> [f64; 3] {
        let student = self.noise.student(self.settings.noise_std);
        let variance = self.noise.variance * student * self.correlation.inflation();
        [fit.variances[0], fit.variances[1], fit.gain.1].map(|unit| (unit * variance).sqrt())
    }

    /// Sets the estimate from the present fit.
    fn conclude(&mut self, time: f64) {
        // A failed step is tried again once there are more data.
        self.shrink = (1.1 * self.shrink).clamp(1e-3, 1.0);
        let Some(fit) = &self.fit else { return };
        if !self.knows_noise() {
            return;
        }
        let [log_std, damping_std, gain_std] = self.spread(fit);
        // A deformation that an offset and a gain explain as well is no vibration: a fit to noise has a best
        // mode, too.
        let explained = self.active.without_vibration() - fit.cost_after;
        let heard = self.is_evident(explained, RULED_OUT + UNKNOWNS);
        let usable = log_std < USABLE && fit.step[0].abs() < TRUST[0];
        if !(heard && usable) {
            return;
        }
        let point = trusted(self.active.point, fit.step, 1.0);
        let Some(mode) = self.region.mode(point) else {
            return;
        };
        let residual = (0..self.active.row.len())
            .map(|k| fit.residual[k] * self.active.row[k])
            .sum();
        // The row of a spike has no residual.
        if f64::is_finite(residual) {
            self.correlation.observe(residual);
        }
        let (w, xi) = (mode.natural_frequency(), mode.damping_ratio());
        self.convergence.push(time, w, xi);
        // The standard deviations account for the noise, the spread for errors of the model. Convergence is
        // withdrawn if the residual turns out to be coloured.
        let within = |limit: f64| log_std < limit && damping_std < limit;
        self.converged = match self.converged {
            true => within(2.0 * SETTLED),
            false => within(SETTLED) && self.convergence.settled() && self.candidate.is_none(),
        };
        self.estimate = Some(Estimate {
            time,
            mode,
            natural_frequency_std: log_std * mode.natural_frequency(),
            damping_ratio_std: damping_std,
            gain: fit.gain.0,
            gain_std,
            converged: self.converged,
        });
    }
}

impl Estimator for Likelihood {
    fn observe(&mut self, sample: Sample) {
        let advances = self
            .window
            .samples()
            .last()
            .is_none_or(|last| sample.time > last.time);
        if !(sample.is_finite() && advances) {
            return;
        }
        if self.window.is_full() {
            self.slide();
        }
        self.window.push(sample);
        self.take_youngest();
        self.update_variance();
        self.refit();
        if !self.locked {
            self.search_grid();
        }
        self.relinearise();
        self.conclude(sample.time);
    }

    fn estimate(&self) -> Option<Estimate> {
        self.estimate
    }

    fn unexplained(&self) -> f64 {
        (2.0 * self.correlation.coloured() * self.noise.variance).sqrt()
    }

    fn restart(&mut self) {
        self.window.clear();
        let sample_time = self.settings.sample_time;
        for track in &mut self.grid {
            *track = Track::new(track.mode, sample_time);
        }
        self.active = Track::new(self.active.mode, sample_time);
        self.fit = None;
        self.candidate = None;
        self.must_replace = false;
        self.shrink = 1.0;
        self.locked = false;
        self.largest = 0.0;
        self.noise = Noise::default();
        self.outside = 0;
        self.correlation = Correlation::default();
        self.convergence = Convergence::over(CONVERGENCE_PERIODS);
        self.converged = false;
        self.estimate = None;
    }
}
