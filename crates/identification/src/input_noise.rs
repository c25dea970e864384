//! Noise of the motor side's sensor, which the mode makes loud.
//!
//! The measured motion of the motor side is the input of the model: its noise `n_u` passes through the mode, and
//! a fit leaves
//!
//! ```text
//! e = n - H n_u,    H = w^2 / A,    A = s^2 + 2 xi w s + w^2
//! ```
//!
//! with `n` the noise of the other sensor. (In the measured deformation `n_u` is as it is, and in the predicted
//! one, `(H - 1) (u + n_u)`, too.) At the mode `n_u` is `1 / (2 xi)` times as loud as elsewhere, so that `e` is far
//! from white, and a fit that takes it for white finds a second mode in it. With `r = N_u / N` the ratio of both
//! levels, the density of `e` is
//!
//! ```text
//! N (1 + r |H|^2) = N |C|^2 / |A|^2,    C = s^2 + 2 zeta W s + W^2,
//! W^4 = (1 + r) w^4,    zeta^2 = (1 - (1 - 2 xi^2) (w / W)^2) / 2
//! ```
//!
//! `A / C` makes it white. Input and output through the same filter obey the same model, so that the methods that
//! assume white noise receive `A u / C` and `A delta / C`. For samples at even distances poles and zeros are those
//! of `e^(s T)`, which is exact for the zeros: nothing is left of the mode's free vibration. `r` is that of the
//! least innovation, and `r N` at most the noise that is seen in the motor side's position.
//!
//! Source: prediction errors and their noise model, L. Ljung, System Identification, 2nd ed., section 3.2, 7.2 and
//! 14.4 (prefilter); noise of the input, T. Soederstroem, Errors-in-Variables Methods in System Identification
//! (2018), chapter 2.

use nalgebra::Complex;
use quell_control::estimators::offline::{BatchFit, batch_fit_near};
use quell_control::estimators::{Sample, Settings};
use quell_shapers::Mode;
use quell_signal::noise_floor;

/// Factor between the ratios of noise that are tried. Weights that are off by up to `q` cost at most
/// `(q - 1)^2 / (4 q)` of the information (Kantorovich), a hundredth for half this factor.
const RATIO: f64 = 1.5;
/// Numbers of these: from a noise whose peak is a hundredth of the other sensor's on.
const RATIOS: i32 = 60;
const LEAST_PEAK: f64 = 0.01;
/// Largest variance of the innovation, in variances of the noise that is seen in the deformation: with more, most
/// of it is something else, such as a further mode, and the filter is not that of the noise.
const ALLOWED: f64 = 2.0;

/// Samples whose noise is white, and the batch fit of these.
pub struct White {
    /// Both signals through the same filter, on the stamps of the fit's samples.
    pub samples: Vec<Sample>,
    /// Their fit; its residual is the innovation.
    pub fit: BatchFit,
}

impl White {
    /// The samples of a fit with the noise of the input made white. `None` where no such noise is evident, the fit
    /// leaves more than noise, the samples are not even enough for the filter, or the settings do not rely on the
    /// input.
    pub fn of(samples: &[Sample], fit: &BatchFit, settings: &Settings) -> Option<Self> {
        if settings.memory.is_finite() {
            return None;
        }
        let samples = whitener(samples, fit)?.samples(samples, fit);
        let fit = batch_fit_near(&samples, settings, fit.mode)?;
        Some(Self { samples, fit })
    }
}

/// The filter of the least innovation, if that is evidence for noise of the input.
fn whitener(samples: &[Sample], fit: &BatchFit) -> Option<Whitener> {
    let count = samples.len() as f64;
    let floor = |of: fn(&Sample) -> f64| {
        let values: Vec<f64> = samples.iter().map(of).collect();
        noise_floor(&values).standard_deviation
    };
    let [seen, beside] = [floor(|s| s.motor_position), floor(|s| s.deformation)];
    let step = even_step(samples, seen.min(fit.residual_std))?;
    let square = |residual: &[f64]| residual.iter().map(|e| e * e).sum::<f64>();
    let tried = |k: i32| {
        let peak = LEAST_PEAK * RATIO.powi(k);
        let ratio = peak * (2.0 * fit.mode.damping_ratio()).powi(2);
        let filter = Whitener::new(fit.mode, ratio, step)?;
        let innovation = square(&filter.of(&fit.residual, [0.0; 2], 0.0));
        (ratio * innovation / count <= seen * seen).then_some((filter, innovation))
    };
    let (filter, innovation) = (0..RATIOS)
        .map_while(tried)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    // Schwarz's criterion for one more unknown.
    let evident = count * (square(&fit.residual) / innovation).ln() > count.ln();
    let is_noise = innovation <= ALLOWED * count * beside * beside;
    (evident && is_noise).then_some(filter)
}

/// Distance of evenly spaced samples, s. `None` where one is so far from an even place that motor side or
/// deformation moves by more than `noise` in between.
fn even_step(samples: &[Sample], noise: f64) -> Option<f64> {
    let (first, last) = (samples.first()?, samples.last()?);
    let step = (last.time - first.time) / (samples.len() - 1) as f64;
    let moved = |pair: &[Sample]| {
        let off = ((pair[1].time - pair[0].time) / step - 1.0).abs();
        let by = [
            pair[1].motor_position - pair[0].motor_position,
            pair[1].deformation - pair[0].deformation,
        ];
        off * by[0].abs().max(by[1].abs())
    };
    let even = samples.windows(2).all(|pair| moved(pair) <= noise);
    (even && step > 0.0).then_some(step)
}

/// `A / C` for samples at even distances.
struct Whitener {
    /// `e^(lambda T)` of the mode.
    growth: Complex<f64>,
    /// Coefficients of the first and second delay, of zeros and of poles.
    zeros: [f64; 2],
    poles: [f64; 2],
}

impl Whitener {
    /// The filter for a mode and a ratio of noise; `None` where `C` is faster than the samples tell.
    fn new(mode: Mode, ratio: f64, step: f64) -> Option<Self> {
        let (w, xi) = (mode.natural_frequency(), mode.damping_ratio());
        let faster = (1.0 + ratio).sqrt();
        let zeta = (0.5 * (1.0 - (1.0 - 2.0 * xi * xi) / faster)).sqrt();
        let growth = pole(w, xi, step);
        let of = |own: Complex<f64>| [-2.0 * own.re, own.norm_sqr()];
        let fast = w * faster.sqrt();
        (fast * step < core::f64::consts::PI).then(|| Self {
            growth,
            zeros: of(growth),
            poles: of(pole(fast, zeta, step)),
        })
    }

    /// Filters values; `before` are those before the first, the last one first, and `rest` is the output then.
    fn of(&self, values: &[f64], before: [f64; 2], rest: f64) -> Vec<f64> {
        let ([mut x1, mut x2], mut y1, mut y2) = (before, rest, rest);
        let ([a1, a2], [c1, c2]) = (self.zeros, self.poles);
        let each = values.iter().map(|&x| {
            let y = x + a1 * x1 + a2 * x2 - c1 * y1 - c2 * y2;
            (x2, x1, y2, y1) = (x1, x, y1, y);
            y
        });
        each.collect()
    }

    /// Both signals. Before the first sample the motor side stood still, and the deformation was that of the
    /// fit's free vibration.
    fn samples(&self, samples: &[Sample], fit: &BatchFit) -> Vec<Sample> {
        let constant = |zeros: [f64; 2]| 1.0 + zeros[0] + zeros[1];
        let gain = constant(self.zeros) / constant(self.poles);
        let free = |count: i32| {
            let turn = self.growth.powi(-count);
            fit.offset + fit.free[0] * turn.re + fit.free[1] * turn.im
        };
        // Counted from the first, so that a constant has no rounding.
        let origin = samples[0].motor_position;
        let moved: Vec<f64> = samples.iter().map(|s| s.motor_position - origin).collect();
        let deformation: Vec<f64> = samples.iter().map(|s| s.deformation).collect();
        let moved = self.of(&moved, [0.0; 2], 0.0);
        let deformation = self.of(&deformation, [free(1), free(2)], gain * fit.offset);
        let both = moved.into_iter().zip(deformation);
        let white = |(own, (motor_position, deformation)): (&Sample, (f64, f64))| Sample {
            motor_position,
            deformation,
            ..*own
        };
        samples.iter().zip(both).map(white).collect()
    }
}

/// `e^(lambda T)` of a mode.
fn pole(w: f64, xi: f64, step: f64) -> Complex<f64> {
    (Complex::new(-xi, (1.0 - xi * xi).max(0.0).sqrt()) * (w * step)).exp()
}
