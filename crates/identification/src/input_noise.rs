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
//! from white, and a fit that takes it for white finds a second mode in it. Of several modes of shares `p_m`,
//!
//! ```text
//! H = sum_m p_m w_m^2 / A_m = B / A,    A = product_m A_m
//! ```
//!
//! With `r = N_u / N` the ratio of both levels, the density of `e` is
//!
//! ```text
//! N (1 + r |H|^2) = N |C|^2 / |A|^2,    C(s) C(-s) = A(s) A(-s) + r B(s) B(-s)
//! ```
//!
//! with the roots of `C` in the left half plane. `A / C` makes it white. Input and output through the same filter obey the
//! same model, so that the methods that assume white noise receive `A u / C` and `A delta / C`. For samples at even
//! distances poles and zeros are those of `e^(s T)`, which is exact for the zeros: nothing is left of the modes' free
//! vibration. `r` is that of the least innovation, and `r N` at most the noise that is seen in the motor side's position.
//!
//! Source: prediction errors and their noise model, L. Ljung, System Identification, 2nd ed., section 3.2, 7.2 and
//! 14.4 (prefilter); noise of the input, T. Soederstroem, Errors-in-Variables Methods in System Identification
//! (2018), chapter 2; spectral factors, K. J. Astroem, Introduction to Stochastic Control Theory (1970), section 4.3.

use super::whitener::{Ringing, Whitener};
use quell_control::estimators::offline::{BatchFit, batch_fit_near, two_mode_residual};
use quell_control::estimators::{Estimate, Sample, Settings};
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
        let ringing = Ringing {
            modes: vec![(fit.mode, 1.0, fit.free)],
            offset: fit.offset,
        };
        let samples = whitened(samples, &ringing, (&fit.residual, fit.residual_std))?;
        let fit = batch_fit_near(&samples, settings, fit.mode)?;
        Some(Self { samples, fit })
    }
}

/// The samples of two modes with the noise of the input made white; `None` as in [`White::of`]. Two modes rely on the
/// input whatever the settings.
pub fn white_of_two(
    samples: &[Sample],
    found: [&Estimate; 2],
    settings: &Settings,
) -> Option<Vec<Sample>> {
    let modes = found.map(|own| own.mode);
    let noise = floor(samples, |s| s.deformation);
    let fit = two_mode_residual(samples, modes, noise, settings)?;
    let ringing = Ringing {
        modes: (0..2)
            .map(|m| (modes[m], fit.shares[m], fit.free[m]))
            .collect(),
        offset: fit.offset,
    };
    let square: f64 = fit.residual.iter().map(|e| e * e).sum();
    let std = (square / samples.len() as f64).sqrt();
    whitened(samples, &ringing, (&fit.residual, std))
}

/// Factor on the deviations that a fit states where the samples are too uneven for the filter, such as with missing rows: the
/// noise of the input is then in the residual. 1 where they are even.
///
/// The derivatives of the response by frequency and damping are as narrow as the mode. What counts for them is the density at
/// the mode, `N + N_u / (4 xi^2)` with `|H| = 1 / (2 xi)`, and the fit takes the residual's variance for it. `N_u` is the noise
/// that is seen in the motor side's position, and at most what the residual leaves room for: through the mode it has the
/// variance `N_u w T / (4 xi)` at a distance `T` of samples.
pub fn louder(samples: &[Sample], fit: &BatchFit, settings: &Settings) -> f64 {
    let seen = floor(samples, |s| s.motor_position);
    let is_even = even_step(samples, seen.min(fit.residual_std)).is_some();
    if is_even || settings.memory.is_finite() {
        return 1.0;
    }
    let step = (samples[samples.len() - 1].time - samples[0].time) / (samples.len() - 1) as f64;
    let (w, xi) = (fit.mode.natural_frequency(), fit.mode.damping_ratio());
    let left = fit.residual_std.powi(2);
    let room = left * 4.0 * xi / (w * step);
    let beside = floor(samples, |s| s.deformation).powi(2);
    let at_mode = beside + seen.powi(2).min(room) / (4.0 * xi * xi);
    (at_mode / left).max(1.0).sqrt()
}

fn floor(samples: &[Sample], of: fn(&Sample) -> f64) -> f64 {
    let values: Vec<f64> = samples.iter().map(of).collect();
    noise_floor(&values).standard_deviation
}

/// The samples through the filter of the least innovation, if that is evidence for noise of the input; `left` is what a
/// fit leaves of them, and its standard deviation.
fn whitened(samples: &[Sample], modes: &Ringing, left: (&[f64], f64)) -> Option<Vec<Sample>> {
    let count = samples.len() as f64;
    let seen = floor(samples, |s| s.motor_position);
    let beside = floor(samples, |s| s.deformation);
    let step = even_step(samples, seen.min(left.1))?;
    let square = |residual: &[f64]| residual.iter().map(|e| e * e).sum::<f64>();
    let loudest = modes.loudest();
    let tried = |k: i32| {
        let ratio = LEAST_PEAK * RATIO.powi(k) / loudest;
        let filter = Whitener::new(modes, ratio, step)?;
        let innovation = square(&filter.of(left.0, |_| 0.0, 0.0));
        (ratio * innovation / count <= seen * seen).then_some((filter, innovation))
    };
    let (filter, innovation) = (0..RATIOS)
        .map_while(tried)
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    // Schwarz's criterion for one more unknown.
    let evident = count * (square(left.0) / innovation).ln() > count.ln();
    let is_noise = innovation <= ALLOWED * count * beside * beside;
    (evident && is_noise).then(|| filter.samples(samples, modes))
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
