//! Offset between two clocks from one recorded move of a flexible joint.

mod quasi_static;
mod ringing;

use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::{Matrix6, Vector6};
use quell_shapers::Mode;

use super::spline::check_series;
use super::{CubicSpline, SignalError};
use quasi_static::QuasiStatic;
use ringing::{MARGIN, Problem, mode_of};

/// Result of [`fit_clock_offset`].
#[derive(Clone, Debug, PartialEq)]
pub struct ClockFit {
    /// Reading of the sensor's clock minus the encoder's at one instant, s.
    pub offset: f64,
    /// One standard deviation of it, s.
    pub offset_std: f64,
    /// Constant of the measured angle: angle minus link position, rad.
    pub angle_offset: f64,
    /// The joint's mode from the same fit; absent where the record shows no vibration.
    pub mode: Option<Mode>,
    /// Whether a damper to ground explains the record better than one across the joint.
    pub damper_to_ground: bool,
    /// Root mean square residual of the fit, rad.
    pub rms: f64,
}

/// Fits `angle(t_s) = theta_0 + y(t_s - tau)`, `y = u + delta`, where `u` is the recorded motor
/// position and `delta'' + 2 xi w delta' + w^2 delta = -u'' - c u'` (`c` = 0, or `2 xi w` for a damper
/// to ground).
///
/// The vibration must be part of the fit: a clock that is late by `tau` adds `tau u'`, and an elastic joint
/// adds `u'' / w^2` plus its vibration, which is not orthogonal to `u'` on a short record. So offset, constant,
/// mode and initial vibration are fitted together. No mode needs to be known; `belief` only adds a starting
/// point. Offsets up to 0.2 s are found. With a damper to ground the joint itself lags by `2 xi / w` (3.3 ms at
/// 8.12 Hz and 0.084), and only the vibration distinguishes that from the clock: that form is used only if its
/// likelihood is higher by a factor of e^5.
///
/// The standard deviation counts correlated residuals as fewer samples: with lag-one correlation `r`,
/// `n (1 - r) / (1 + r)` of them. At 10 um, 333 Hz and a lever arm of 1.8 m a move of 30 deg gives a few us.
///
/// # Errors
/// [`SignalError`] for bad series, fewer than 20 samples within the encoder's span, or a motor that
/// moves by less than ten times the angle's own scatter allows to be seen.
pub fn fit_clock_offset(
    motor: &CubicSpline,
    time: &[f64],
    angle: &[f64],
    belief: Option<Mode>,
) -> Result<ClockFit, SignalError> {
    check_series("measured angle", time, angle)?;
    let coarse = coarse_offset(motor, time, angle);
    let samples = within(motor, time.iter().map(|t| t - coarse), angle)?;
    let start = QuasiStatic::fit(motor, &samples)?;
    let mut frequencies: Vec<f64> = belief
        .map(|mode| mode.natural_frequency())
        .into_iter()
        .collect();
    frequencies.extend(start.frequencies(&samples));
    let best = |ground| Candidate::best(motor, &samples, &start, &frequencies, ground);
    let chosen = match (best(false), best(true)) {
        (Some(across), Some(ground)) => {
            let samples = across.effective.min(ground.effective);
            let gain = 0.5 * samples * (across.sum / ground.sum).ln();
            Some(if gain > LIKELIHOOD_GAIN {
                ground
            } else {
                across
            })
        }
        (across, ground) => across.or(ground),
    };
    let mut fit = chosen.map_or_else(|| start.result(), |candidate| candidate.result());
    fit.offset += coarse;
    Ok(fit)
}

/// Gain in log-likelihood above which a damper to ground is accepted.
const LIKELIHOOD_GAIN: f64 = 5.0;

/// Instants and angles within the encoder's span for any fine offset.
fn within(
    motor: &CubicSpline,
    time: impl Iterator<Item = f64>,
    angle: &[f64],
) -> Result<Vec<(f64, f64)>, SignalError> {
    let (first, last) = motor.span();
    let samples: Vec<(f64, f64)> = time
        .zip(angle.iter().copied())
        .filter(|(t, _)| (first + MARGIN..=last - MARGIN).contains(t))
        .collect();
    if samples.len() < 20 {
        return Err(SignalError::TooFew {
            what: "samples of the angle within the encoder's span",
            found: samples.len(),
            needed: 20,
        });
    }
    Ok(samples)
}

/// The offset within 0.2 s, on a grid of 10 ms, at which angle and motor position differ least apart from a
/// constant. The motor is taken to rest before and after its record. A vibration of some mrad cannot hide 10 ms
/// of a move at some tenths of a rad/s.
fn coarse_offset(motor: &CubicSpline, time: &[f64], angle: &[f64]) -> f64 {
    let (first, last) = motor.span();
    let n = time.len().max(1) as f64;
    let scatter = |offset: f64| {
        let rest = time.iter().zip(angle).map(|(t, y)| {
            let r = y - motor.value((t - offset).clamp(first, last));
            (r, r * r)
        });
        let (sum, squares) = rest.fold((0.0, 0.0), |acc, r| (acc.0 + r.0, acc.1 + r.1));
        squares - sum * sum / n
    };
    let grid = (-20..=20).map(|k| f64::from(k) * 0.01);
    let best = grid
        .map(|offset| (scatter(offset), offset))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(0.0, |(_, offset)| offset)
}

struct Candidate {
    parameters: Vector6<f64>,
    ground: bool,
    /// Sum of squares, rad^2; the following fields are its parts.
    sum: f64,
    samples: f64,
    effective: f64,
    offset_std: f64,
}

/// Samples in a period of the vibration, and in all, for a fit whose end is near that with all samples: there
/// are six unknowns.
const IN_A_PERIOD: f64 = 5.0;
const IN_ALL: usize = 1000;
/// Ratio of a fit's mean square, to some samples, to the least one, above which it is not the best for all. The
/// mean square of a thousand samples scatters by `sqrt(2 / 1000)`, less than a fifth of the difference.
const FAR: f64 = 1.25;
/// Relative fall of the sum of squares that ends a fit: of ten thousand samples a thousandth of a standard
/// deviation.
const LEAST_FALL: f64 = 1e-10;

impl Candidate {
    /// The best fit from any of the frequencies: each is fitted to some of the samples, then the promising ones
    /// to all.
    fn best(
        motor: &CubicSpline,
        samples: &[(f64, f64)],
        start: &QuasiStatic,
        frequencies: &[f64],
        ground: bool,
    ) -> Option<Self> {
        let period = (samples[samples.len() - 1].0 - samples[0].0) / (samples.len() - 1) as f64;
        let near = frequencies.iter().filter_map(|&frequency| {
            let apart = (std::f64::consts::TAU / (frequency * period * IN_A_PERIOD)) as usize;
            let apart = apart.min(samples.len() / IN_ALL).max(1);
            let some: Vec<_> = samples.iter().step_by(apart).copied().collect();
            Self::fit(motor, &some, start, start.begin(frequency), ground)
        });
        let near: Vec<Self> = near.collect();
        let mean = |fit: &Self| fit.sum / fit.samples;
        let least = near.iter().map(mean).fold(f64::INFINITY, f64::min);
        let mut fits: Vec<Self> = Vec::new();
        for rough in near.iter().filter(|rough| mean(rough) <= FAR * least) {
            if !fits.iter().any(|fit| fit.is_where(rough)) {
                fits.extend(Self::fit(motor, samples, start, rough.parameters, ground));
            }
        }
        fits.into_iter().min_by(|a, b| a.sum.total_cmp(&b.sum))
    }

    /// Whether another fit ended in the same minimum: within a thousandth in frequency, and half a millisecond,
    /// less than the distance of two minima.
    fn is_where(&self, other: &Self) -> bool {
        let apart = self.parameters - other.parameters;
        apart[2].abs() < 1e-3 && apart[1].abs() < 5e-4
    }

    fn fit(
        motor: &CubicSpline,
        samples: &[(f64, f64)],
        start: &QuasiStatic,
        parameters: Vector6<f64>,
        ground: bool,
    ) -> Option<Self> {
        let scale = start.rms.max(f64::MIN_POSITIVE);
        let problem = Problem {
            motor,
            samples,
            ground,
            scale,
            parameters,
        };
        let (problem, _) = LevenbergMarquardt::new()
            .with_ftol(LEAST_FALL)
            .with_patience(50)
            .minimize(problem);
        let residual = problem.residuals()?;
        let jacobian = problem.jacobian()?;
        let n = samples.len() as f64;
        let sum = residual.norm_squared();
        let effective = effective_samples(residual.as_slice());
        let normal: Matrix6<f64> = jacobian.transpose() * &jacobian;
        let variance = normal
            .try_inverse()
            .map(|m| m[(1, 1)])
            .filter(|v| *v >= 0.0);
        let offset_std = variance.map_or(f64::INFINITY, |v| (v * sum / effective).sqrt());
        Some(Self {
            parameters: problem.parameters,
            ground,
            sum: sum * scale * scale,
            samples: n,
            effective,
            offset_std,
        })
    }

    fn result(&self) -> ClockFit {
        ClockFit {
            offset: self.parameters[1],
            offset_std: self.offset_std,
            angle_offset: self.parameters[0],
            mode: mode_of(&self.parameters),
            damper_to_ground: self.ground,
            rms: (self.sum / self.samples).sqrt(),
        }
    }
}

/// Number of independent samples with the same information as these correlated ones, for a correlation that
/// falls geometrically from its value `r` at lag one: `n (1 - r) / (1 + r)`, at least 6.
fn effective_samples(residual: &[f64]) -> f64 {
    let n = residual.len() as f64;
    let power: f64 = residual.iter().map(|r| r * r).sum();
    let lagged: f64 = residual.windows(2).map(|w| w[0] * w[1]).sum();
    let r = if power > 0.0 {
        (lagged / power).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (n * (1.0 - r) / (1.0 + r)).max(6.0)
}
