//! Settings of an estimator, fixed before its first sample.

use quell_shapers::Mode;

/// Settings of an estimator, fixed before its first sample.
///
/// The standard deviations are those of zero-mean Gaussian priors on errors of real sensors; with infinity the
/// quantity is free.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Nominal time between samples, s; sizes the buffers, the stamps rule.
    pub sample_time: f64,
    /// One standard deviation of the deformation's noise, rad; `None`: from the residual.
    pub noise_std: Option<f64>,
    /// The engineer's belief; a start, not a constraint.
    pub belief: Option<Mode>,
    /// Lowest and highest natural frequency in range, rad/s.
    pub frequency_range: (f64, f64),
    /// Constant offset of the deformation, rad; `None`: one standard deviation of the noise (the
    /// deformation was zeroed at rest on at least one sample). The regressions know no prior: they
    /// take it as zero, or free where a value above 0 is given.
    pub offset_std: Option<f64>,
    /// Relative error of the deformation's scale (lever arm, modal participation). The regressions
    /// take it as known below 0.5 and as free from there on.
    pub scale_std: f64,
    /// Static gain `K`, deformation over motor-side position.
    pub gain_std: f64,
    /// How long the simulated vibration may rely on the measured input, s; infinity: for ever.
    ///
    /// If the motor side is measured coarsely, or the joint has more physics than the model, a lightly damped
    /// mode drifts away from the measured one. After each `memory` the vibration is
    /// therefore free again, while mode, offset, scale and gain stay common to all stretches
    /// (multiple shooting).
    pub memory: f64,
    /// Longest stretch of samples that counts, s.
    pub window: f64,
}

impl Settings {
    /// Settings around a belief: frequencies from half to twice the believed one, a window of 40 of its
    /// periods.
    ///
    /// The data estimate a scale known to 10 % (lever arm) and a gain of 0.05 (the paper's 0.02 lies within).
    pub fn around(belief: Mode, sample_time: f64) -> Self {
        let w = belief.natural_frequency();
        Self {
            belief: Some(belief),
            window: 40.0 * belief.damped_period(),
            ..Self::within((0.5 * w, 2.0 * w), sample_time)
        }
    }

    /// Settings without a belief: frequencies (rad/s) in a range, a window of 20 of the longest
    /// periods.
    pub fn within(frequency_range: (f64, f64), sample_time: f64) -> Self {
        Self {
            sample_time,
            noise_std: None,
            belief: None,
            frequency_range,
            offset_std: None,
            scale_std: 0.1,
            gain_std: 0.05,
            memory: f64::INFINITY,
            window: 20.0 * core::f64::consts::TAU / frequency_range.0,
        }
    }

    /// Whether a regression needs a column for the deformation's offset.
    pub(super) fn offset_is_free(&self) -> bool {
        self.offset_std.is_some_and(|std| std > 0.0)
    }

    /// Whether a regression needs a column for the deformation's scale.
    pub(super) fn scale_is_free(&self) -> bool {
        self.scale_std >= 0.5
    }

    /// Samples in a window, between 256 and 65 536.
    pub(super) fn capacity(&self) -> usize {
        let samples = self.window / self.sample_time;
        if samples.is_finite() {
            (samples as usize).clamp(256, 65_536)
        } else {
            4096
        }
    }
}
