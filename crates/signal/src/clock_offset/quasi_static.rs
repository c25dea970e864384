//! Start of the clock-offset fit: the joint as a spring without vibration.

use super::ringing::{MARGIN, XI_MAX};
use super::{ClockFit, effective_samples};
use crate::spectrum::{Window, spectrum};
use crate::{CubicSpline, SignalError};
use nalgebra::Vector6;

/// `angle - u = theta_0 - tau u' - kappa u''`: the joint as a spring without vibration.
pub(super) struct QuasiStatic {
    /// `theta_0`, rad.
    pub angle_offset: f64,
    /// `tau`, s.
    pub offset: f64,
    /// Root mean square of the residual, rad.
    pub rms: f64,
    /// `kappa`, s^2.
    compliance: f64,
    residual: Vec<f64>,
    offset_std: f64,
}

impl QuasiStatic {
    pub fn fit(motor: &CubicSpline, samples: &[(f64, f64)]) -> Result<Self, SignalError> {
        let rows: Vec<[f64; 3]> = samples
            .iter()
            .map(|&(t, _)| [1.0, -motor.derivative(t), -motor.second_derivative(t)])
            .collect();
        let rest: Vec<f64> = samples.iter().map(|&(t, y)| y - motor.value(t)).collect();
        let n = samples.len() as f64;
        let speed = (rows.iter().map(|row| row[1] * row[1]).sum::<f64>() / n).sqrt();
        let mut normal = nalgebra::Matrix3::zeros();
        let mut right = nalgebra::Vector3::zeros();
        for (row, r) in rows.iter().zip(&rest) {
            let row = nalgebra::Vector3::from(*row);
            normal += row * row.transpose();
            right += row * *r;
        }
        let inverse =
            normal
                .try_inverse()
                .filter(|_| speed > 0.0)
                .ok_or(SignalError::NotExcited {
                    what: "motor speed, rad/s rms",
                    found: speed,
                    needed: 1e-6,
                })?;
        let solution = inverse * right;
        let residual: Vec<f64> = rows
            .iter()
            .zip(&rest)
            .map(|(row, r)| r - nalgebra::Vector3::from(*row).dot(&solution))
            .collect();
        let rms = (residual.iter().map(|r| r * r).sum::<f64>() / n).sqrt();
        let offset_std = rms * (inverse[(1, 1)] * n / effective_samples(&residual)).sqrt();
        Ok(Self {
            angle_offset: solution[0],
            offset: solution[1],
            rms,
            compliance: solution[2],
            residual,
            offset_std,
        })
    }

    /// Starting values of the natural frequency, rad/s: `1 / sqrt(kappa)` and the highest peak of
    /// the residual's spectrum.
    pub fn frequencies(&self, samples: &[(f64, f64)]) -> Vec<f64> {
        let n = samples.len();
        let duration = samples[n - 1].0 - samples[0].0;
        let period = duration / (n - 1) as f64;
        // Between two periods in the record and a fifth of the sampling rate.
        let range = (
            2.0 * std::f64::consts::TAU / duration,
            std::f64::consts::TAU / (5.0 * period),
        );
        let spring = (self.compliance > 0.0).then(|| 1.0 / self.compliance.sqrt());
        let peak = spectrum(&self.residual, period, Window::Hann, 2)
            .ok()
            .and_then(|s| s.peak(range.0, range.1))
            .map(|peak| peak.frequency);
        spring
            .into_iter()
            .chain(peak)
            .filter(|w| (range.0..range.1).contains(w))
            .collect()
    }

    /// Starting parameters of a fit with a mode: at a damping ratio of 0.05, at rest.
    pub fn begin(&self, frequency: f64) -> Vector6<f64> {
        let offset = self.offset.clamp(-0.5 * MARGIN, 0.5 * MARGIN);
        let logit = -(XI_MAX / 0.05 - 1.0f64).ln();
        Vector6::new(self.angle_offset, offset, frequency.ln(), logit, 0.0, 0.0)
    }

    pub fn result(&self) -> ClockFit {
        ClockFit {
            offset: self.offset,
            offset_std: self.offset_std,
            angle_offset: self.angle_offset,
            mode: None,
            damper_to_ground: false,
            rms: self.rms,
        }
    }
}
