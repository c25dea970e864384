//! The smoothed state of positions whose jerk is white noise.
//!
//! ```text
//! x' = (q', q'', w),    y_k = q(t_k) + e_k,    var(e) = s^2,    E w(t) w(t') = s^2 i delta(t - t')
//! ```
//!
//! The intensity `i` is first the likeliest constant one. Then each stretch gets its own. With `r` what the samples after a
//! step say of its end, of covariance `s^2 R`, and `N` the covariance that a step adds for `i = 1`, the likelihood has its
//! maximum where
//!
//! ```text
//! sum r' N r / s^2 = sum tr(N R)        over the steps of the stretch
//! ```
//!
//! which the ratio of both sides is iterated to. `i sum tr(N R)` is the number of unknowns that the samples determine there.
//!
//! Source: Wahba, Improper priors, spline smoothing and the problem of guarding against model errors in regression,
//! J. Royal Statistical Society B 40 (1978): the smoothed state is the smoothing spline of fifth order; de Jong, Smoothing
//! and interpolation with the state-space model, J. American Statistical Association 84 (1989), for `r` and `R`; MacKay,
//! Bayesian interpolation, Neural Computation 4 (1992), for the iteration.

use super::fourier::fourier;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeMap;

/// Where the logarithm of the intensity is looked for: from a motion of which a million samples show the acceleration to
/// one whose every sample is all there is.
const SEARCHED: (f64, f64) = (-60.0, 10.0);
/// Unknowns that the samples of a stretch determine: an intensity is then known to half its size, `sqrt(2 / 10)`.
const UNKNOWNS: f64 = 10.0;
/// Rounds of the iteration: each leaves less than half of what is missing.
const ROUNDS: usize = 12;

/// A smoother of positions; all is in steps of the clock, and in variances of the sensor's noise.
pub struct Smoother<'a> {
    values: &'a [f64],
    steps: &'a [f64],
    first: Matrix3<f64>,
}

/// Intensities in a factor of e that are told apart where an error is averaged over them: its correlation is then right in time
/// to a sixtieth.
const CLASSES: f64 = 5.0;
/// Samples to either side over which an error of the smoothed positions is told: the lags of a noise that is to be whitened are
/// fewer.
const REACH: usize = 512;

/// What is known of the error of smoothed positions.
#[derive(Clone, Debug)]
pub struct SmoothingError {
    /// Variance of the sensor's noise.
    variance: f64,
    jerk: Jerk,
}

impl SmoothingError {
    /// That of positions that are exact.
    pub fn none() -> Self {
        Self {
            variance: 0.0,
            jerk: Jerk::constant(0.0),
        }
    }

    /// Its response to independent draws of unit variance, one for each sample: the [`REACH`] samples before the draw's own,
    /// that, and one fewer after it. It is a mean over the samples of these indices.
    ///
    /// With the transfer function `S` of the smoother, the spectral density of the error is `s^2 S`: that of a Wiener filter
    /// (Wiener, Extrapolation, Interpolation, and Smoothing of Stationary Time Series, 1949, section III.1). The response is
    /// its even root.
    pub fn response(&self, samples: impl Iterator<Item = usize>) -> Vec<f64> {
        let last = self.jerk.each.len() - 1;
        // The kernel's length goes with the sixth root of the intensity.
        let class = |k: usize| {
            (CLASSES * self.jerk.each[(k / self.jerk.stretch).min(last)].ln()).round() as i64
        };
        let mut classes = BTreeMap::<i64, usize>::new();
        samples.for_each(|k| *classes.entry(class(k)).or_default() += 1);
        let all: usize = classes.values().sum();
        let mut mean = vec![0.0; 2 * REACH];
        for (class, count) in classes {
            let share = count as f64 / all as f64;
            let kernel = kernel((class as f64 / CLASSES).exp());
            let pairs = mean.iter_mut().zip(kernel);
            pairs.for_each(|(sum, own)| *sum += share * own);
        }
        let density = fourier(centred(&mean));
        let root = |k: usize| density[k.min(2 * REACH - k)].re.max(0.0).sqrt();
        let root = fourier((0..2 * REACH).map(root).collect());
        let size = self.variance.sqrt() / (2 * REACH) as f64;
        let lag = |k: usize| size * root[k.abs_diff(REACH)].re;
        (0..2 * REACH).map(lag).collect()
    }
}

/// Smoothed positions of a one among zeros, [`REACH`] of them before it, for a constant intensity.
fn kernel(intensity: f64) -> impl Iterator<Item = f64> {
    let mut values = [0.0; 2 * REACH];
    values[REACH] = 1.0;
    let smoother = Smoother::new(&values, &[1.0; 2 * REACH - 1]);
    let state = smoother.smoothed_by(&Jerk::constant(intensity));
    state.into_iter().map(|own| own[0])
}

/// The same, its middle first and what was before it last.
fn centred(values: &[f64]) -> Vec<f64> {
    let (before, after) = values.split_at(values.len() / 2);
    [after, before].concat()
}

/// Intensity of the jerk in each stretch of steps.
#[derive(Clone, Debug)]
struct Jerk {
    each: Vec<f64>,
    stretch: usize,
}

struct Pass {
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
    innovation: f64,
    variance: f64,
}

impl Jerk {
    fn constant(intensity: f64) -> Self {
        Self {
            each: vec![intensity],
            stretch: usize::MAX,
        }
    }

    fn at(&self, step: usize) -> f64 {
        self.each[step / self.stretch]
    }
}

impl<'a> Smoother<'a> {
    /// * `steps`: distances of the values in time, one fewer than these.
    pub fn new(values: &'a [f64], steps: &'a [f64]) -> Self {
        let noise = super::noise_floor(values).standard_deviation;
        let size = values
            .iter()
            .fold(0.0f64, |most, v| most.max((v - values[0]).abs()));
        let noise = noise.max(1e-9 * size);
        let differences: Vec<f64> = values.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let square = |of: &[f64]| of.iter().map(|d| d * d).sum::<f64>() / of.len().max(1) as f64;
        let bends: Vec<f64> = differences
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        // What is known of the start: it is like the rest.
        let [rate, bend] = [square(&differences), square(&bends)].map(|own| own / (noise * noise));
        Self {
            values,
            steps,
            first: Matrix3::from_diagonal(&Vector3::new(1.0, 4.0 * rate + 1.0, 4.0 * bend + 1.0)),
        }
    }

    /// Position, velocity and acceleration at each value, with the likeliest intensities, and their error.
    pub fn smoothed(&self) -> (Vec<[f64; 3]>, SmoothingError) {
        let constant = Jerk::constant(self.likeliest().exp());
        let jerk = self.in_stretches(&constant).unwrap_or(constant);
        let variance = self.likelihood(&jerk).1;
        (self.smoothed_by(&jerk), SmoothingError { variance, jerk })
    }

    fn smoothed_by(&self, jerk: &Jerk) -> Vec<[f64; 3]> {
        let mut smoothed = vec![[0.0; 3]; self.values.len()];
        let mut adjoint = Vector3::zeros();
        for (k, pass) in self.passes(jerk).iter().enumerate().rev() {
            if let Some(&h) = self.steps.get(k) {
                let back = transition(h).transpose() * adjoint;
                adjoint = back;
                adjoint[0] -= (pass.covariance.column(0) / pass.variance).dot(&back);
            }
            adjoint[0] += pass.innovation / pass.variance;
            smoothed[k] = (pass.state + pass.covariance * adjoint).into();
        }
        smoothed
    }

    fn filter(&self, jerk: &Jerk, mut each: impl FnMut(Pass)) {
        let mut state = Vector3::new(self.values[0], 0.0, 0.0);
        let mut covariance = self.first;
        for (k, value) in self.values.iter().enumerate() {
            let (innovation, variance) = (value - state[0], covariance[(0, 0)] + 1.0);
            each(Pass {
                state,
                covariance,
                innovation,
                variance,
            });
            let Some(&h) = self.steps.get(k) else { return };
            let gain = covariance.column(0) / variance;
            let leads = transition(h);
            state = leads * (state + gain * innovation);
            let updated = covariance - gain * covariance.row(0);
            let next = leads * updated * leads.transpose() + noise(h) * jerk.at(k);
            covariance = (next + next.transpose()) * 0.5;
        }
    }

    fn passes(&self, jerk: &Jerk) -> Vec<Pass> {
        let mut passes = Vec::with_capacity(self.values.len());
        self.filter(jerk, |pass| passes.push(pass));
        passes
    }

    /// For each stretch `sum r' N r / s^2`, and its expectation `sum tr(N R)`.
    fn moments(&self, jerk: &Jerk, variance: f64) -> Vec<(f64, f64)> {
        let passes = self.passes(jerk);
        let mut sums = vec![(0.0, 0.0); jerk.each.len()];
        let (mut adjoint, mut spread) = (Vector3::zeros(), Matrix3::zeros());
        for (k, pass) in passes.iter().enumerate().rev() {
            if let Some(&h) = self.steps.get(k) {
                let (added, own) = (noise(h), &mut sums[k / jerk.stretch]);
                own.0 += adjoint.dot(&(added * adjoint)) / variance;
                own.1 += (added * spread).trace();
                let mut leads = transition(h);
                let gain = pass.covariance.column(0) / pass.variance;
                let taken = leads * gain;
                leads.set_column(0, &(leads.column(0) - taken));
                adjoint = leads.transpose() * adjoint;
                spread = leads.transpose() * spread * leads;
            }
            adjoint[0] += pass.innovation / pass.variance;
            spread[(0, 0)] += 1.0 / pass.variance;
        }
        sums
    }

    /// Log-likelihood, the sensor's variance concentrated out; and that variance.
    fn likelihood(&self, jerk: &Jerk) -> (f64, f64) {
        let (mut squares, mut logs) = (0.0, 0.0);
        self.filter(jerk, |pass| {
            squares += pass.innovation * pass.innovation / pass.variance;
            logs += pass.variance.ln();
        });
        let count = self.values.len() as f64;
        let variance = (squares / count).max(f64::MIN_POSITIVE);
        (-0.5 * count * variance.ln() - 0.5 * logs, variance)
    }

    /// The logarithm of the likeliest constant intensity: by thirds about the best of a grid.
    fn likeliest(&self) -> f64 {
        let (from, to) = SEARCHED;
        let steps = 28;
        let likelihood = |log: f64| self.likelihood(&Jerk::constant(log.exp())).0;
        let at = |k: i32| from + (to - from) * f64::from(k) / f64::from(steps);
        let all = (0..=steps).map(|k| (likelihood(at(k)), at(k)));
        let best = all
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(from, |own| own.1);
        let width = (to - from) / f64::from(steps);
        let (mut low, mut high) = (best - width, best + width);
        while high - low > 0.2 {
            let third = (high - low) / 3.0;
            let [left, right] = [low + third, high - third].map(likelihood);
            match left < right {
                true => low += third,
                false => high -= third,
            }
        }
        0.5 * (low + high)
    }

    /// The likeliest intensity of each stretch; `None` where the evidence for several is not strong enough: Schwarz's
    /// criterion, each being known by as many unknowns as its stretch has.
    fn in_stretches(&self, constant: &Jerk) -> Option<Jerk> {
        let (before, variance) = self.likelihood(constant);
        let intensity = constant.each[0];
        let all = self.moments(constant, variance)[0].1 * intensity;
        let count = (all / UNKNOWNS) as usize;
        if count < 2 {
            return None;
        }
        let stretch = self.steps.len().div_ceil(count);
        let mut jerk = Jerk {
            each: vec![intensity; self.steps.len().div_ceil(stretch)],
            stretch,
        };
        let mut variance = variance;
        for _ in 0..ROUNDS {
            let moments = self.moments(&jerk, variance);
            for (own, (squares, expected)) in jerk.each.iter_mut().zip(moments) {
                *own = (*own * squares / expected).max(SEARCHED.0.exp());
            }
            variance = self.likelihood(&jerk).1;
        }
        let rise = self.likelihood(&jerk).0 - before;
        let cost = 0.5 * (jerk.each.len() - 1) as f64 * UNKNOWNS.ln();
        (rise > cost).then_some(jerk)
    }
}

fn transition(h: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, h, 0.5 * h * h, 0.0, 1.0, h, 0.0, 0.0, 1.0)
}

/// The covariance that white jerk adds.
fn noise(h: f64) -> Matrix3<f64> {
    let (h2, h3) = (h * h, h * h * h);
    Matrix3::new(
        h3 * h2 / 20.0,
        h2 * h2 / 8.0,
        h3 / 6.0,
        h2 * h2 / 8.0,
        h3 / 3.0,
        h2 / 2.0,
        h3 / 6.0,
        h2 / 2.0,
        h,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;
    use core::ops::Range;
    use rand::{Rng, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// Numbers of the samples that the sums are over.
    const REST: Range<usize> = 0..500;
    const MOVE: Range<usize> = 500..1000;
    /// Of these, without the ends, at which a stretch has a part of both.
    const INSIDE: Range<usize> = 50..450;

    /// Rest, a cycloidal move of a length, rest: position and acceleration in steps of the clock.
    fn cycloid(length: f64) -> Vec<[f64; 2]> {
        let at = |k: usize| {
            let s = ((k as f64 - 500.0) / 500.0).clamp(0.0, 1.0);
            let acceleration = TAU * (TAU * s).sin() / 500.0_f64.powi(2);
            [s - (TAU * s).sin() / TAU, acceleration].map(|own| length * own)
        };
        (0..1500).map(at).collect()
    }

    /// A draw of unit variance: a sum of twelve even ones.
    fn normal(random: &mut ChaCha8Rng) -> f64 {
        (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
    }

    fn noisy(truth: &[[f64; 2]], seed: u64) -> Vec<f64> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let each = truth.iter().map(|own| own[0] + normal(&mut random));
        each.collect()
    }

    /// A motion of white jerk.
    fn even(seed: u64) -> Vec<[f64; 2]> {
        let mut random = ChaCha8Rng::seed_from_u64(1000 + seed);
        let [mut q, mut v, mut a] = [0.0; 3];
        let each = (0..1500).map(|_| {
            (q, v) = (q + v + 0.5 * a, v + a);
            a += 0.01 * normal(&mut random);
            [q, a]
        });
        each.collect()
    }

    /// The error of the acceleration over some samples.
    fn error(truth: &[[f64; 2]], found: &[[f64; 3]], range: Range<usize>) -> f64 {
        let square = |k: usize| (found[k][2] - truth[k][1]).powi(2);
        range.map(square).sum::<f64>().sqrt()
    }

    /// A joint that rests has no acceleration; one that moves has that of a recording of the move alone, up to a sixth: the
    /// intensities of its stretches are known to half their size.
    #[test]
    fn val_a_rest_is_told_from_a_move() {
        for seed in 0..8 {
            let truth = cycloid(4e4);
            let (values, steps) = (noisy(&truth, seed), vec![1.0; truth.len() - 1]);
            let constant = |range: Range<usize>| {
                let smoother = Smoother::new(&values[range.clone()], &steps[1..range.len()]);
                let jerk = Jerk::constant(smoother.likeliest().exp());
                error(&truth[range], &smoother.smoothed_by(&jerk), INSIDE)
            };
            let found = Smoother::new(&values, &steps).smoothed().0;
            let own = |range: Range<usize>| error(&truth[range.clone()], &found[range], INSIDE);
            let whole = Smoother::new(&values, &steps);
            let jerk = Jerk::constant(whole.likeliest().exp());
            let before = whole.smoothed_by(&jerk);
            let rest = own(REST) / error(&truth[REST], &before[REST], INSIDE);
            assert!(rest < 0.5, "seed {seed}: {rest}");
            let moves = own(MOVE) / constant(MOVE);
            assert!(moves < 1.17, "seed {seed}: {moves}");
        }
    }

    /// The error has the spread that its response says, and so has its second difference, which is that of the acceleration.
    #[test]
    fn val_the_error_is_as_large_as_is_said() {
        let second = |of: &[f64]| -> Vec<f64> {
            let triples = of.windows(3);
            triples.map(|w| w[0] - 2.0 * w[1] + w[2]).collect()
        };
        let square = |of: &[f64]| of.iter().map(|own| own * own).sum::<f64>();
        let (mut ratios, seeds) = ([0.0; 2], 8);
        for seed in 0..seeds {
            let truth = even(seed);
            let steps = vec![1.0; truth.len() - 1];
            let (found, known) = Smoother::new(&noisy(&truth, seed), &steps).smoothed();
            let inside = found.iter().zip(&truth).skip(100).take(1300);
            let error: Vec<f64> = inside.map(|(own, truth)| own[0] - truth[0]).collect();
            let said = known.response(0..truth.len());
            let pairs = [(&error, &said), (&second(&error), &second(&said))];
            for (ratio, (error, said)) in ratios.iter_mut().zip(pairs) {
                *ratio += square(error) / error.len() as f64 / square(said) / seeds as f64;
            }
        }
        // A seed has about a hundred independent errors.
        assert!(
            ratios.iter().all(|own| (own - 1.0).abs() < 0.15),
            "{ratios:?}"
        );
    }

    /// A motion that is the same throughout has one intensity.
    #[test]
    fn val_an_even_motion_has_one_intensity() {
        for seed in 0..8 {
            let values = noisy(&even(seed), seed);
            let steps = vec![1.0; values.len() - 1];
            let smoother = Smoother::new(&values, &steps);
            let constant = Jerk::constant(smoother.likeliest().exp());
            assert!(smoother.in_stretches(&constant).is_none(), "seed {seed}");
        }
    }
}
