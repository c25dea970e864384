//! The least-squares problem of the clock-offset fit: a joint with vibration.

use crate::forced_response::free_response;
use crate::{CubicSpline, ForcedResponse};
use levenberg_marquardt::LeastSquaresProblem;
use nalgebra::{DVector, Dyn, OMatrix, Owned, U6, Vector6};
use quell_shapers::Mode;

/// Largest fine offset, s, that is fitted; it keeps every sample within the encoder's span.
pub(super) const MARGIN: f64 = 0.02;

/// Parameters: constant, offset, ln omega, logit of xi, initial deformation and its rate over omega.
pub(super) struct Problem<'a> {
    pub motor: &'a CubicSpline,
    pub samples: &'a [(f64, f64)],
    pub ground: bool,
    pub scale: f64,
    pub parameters: Vector6<f64>,
}

impl Problem<'_> {
    /// The deformation for these parameters; `None` outside their range.
    fn response(&self, p: &Vector6<f64>) -> Option<ForcedResponse<'_>> {
        let mode = mode_of(p)?;
        if p[1].is_nan() || p[1].abs() > MARGIN {
            return None;
        }
        let start = (p[4], p[5] * mode.natural_frequency());
        Some(ForcedResponse::new(self.motor, mode, self.ground, start))
    }

    /// Residual in units of `scale`, or `None` outside the parameters' range.
    fn residual(&self, p: &Vector6<f64>) -> Option<DVector<f64>> {
        let response = self.response(p)?;
        let rest = self.samples.iter().map(|&(t, angle)| {
            let time = t - p[1];
            (p[0] + self.motor.value(time) + response.at(time).0 - angle) / self.scale
        });
        Some(DVector::from_iterator(self.samples.len(), rest))
    }

    /// Derivative by a parameter: central difference, 1e-6 of a radian, a second, a relative frequency, a logit.
    fn by_step(&self, k: usize) -> Option<DVector<f64>> {
        let mut step = Vector6::zeros();
        step[k] = 1e-6;
        let high = self.residual(&(self.parameters + step))?;
        let low = self.residual(&(self.parameters - step))?;
        Some((high - low) / 2e-6)
    }
}

/// Largest damping ratio that the fit may reach.
pub(super) const XI_MAX: f64 = 0.9;

pub(super) fn mode_of(p: &Vector6<f64>) -> Option<Mode> {
    Mode::new(p[2].exp(), XI_MAX / (1.0 + (-p[3]).exp())).ok()
}

impl LeastSquaresProblem<f64, Dyn, U6> for Problem<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, U6>;
    type ParameterStorage = Owned<f64, U6>;

    fn set_params(&mut self, p: &Vector6<f64>) {
        self.parameters = *p;
    }

    fn params(&self) -> Vector6<f64> {
        self.parameters
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        self.residual(&self.parameters)
    }

    fn jacobian(&self) -> Option<OMatrix<f64, Dyn, U6>> {
        let p = &self.parameters;
        let (response, mode) = (self.response(p)?, mode_of(p)?);
        let (begin, _) = self.motor.span();
        let mut jacobian = OMatrix::<f64, Dyn, U6>::zeros(self.samples.len());
        for (row, &(t, _)) in self.samples.iter().enumerate() {
            let time = t - p[1];
            let rate = self.motor.derivative(time) + response.at(time).1;
            let [of_deformation, of_rate] = free_response(mode, time - begin);
            jacobian[(row, 0)] = 1.0 / self.scale;
            jacobian[(row, 1)] = -rate / self.scale;
            jacobian[(row, 4)] = of_deformation / self.scale;
            jacobian[(row, 5)] = of_rate * mode.natural_frequency() / self.scale;
        }
        for k in [2, 3] {
            jacobian.set_column(k, &self.by_step(k)?);
        }
        Some(jacobian)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::End;
    use proptest::prelude::*;

    proptest! {
        /// Every column is the central difference of the residual.
        #[test]
        fn columns_are_differences(
            ground in any::<bool>(),
            offset in -0.01..0.01f64,
            hertz in 3.0..30.0f64,
            logit in -4.0..0.0f64,
            start in prop::array::uniform2(-1e-2..1e-2f64),
        ) {
            let time: Vec<f64> = (0..400).map(|k| 0.004 * f64::from(k)).collect();
            let turned: Vec<f64> = time.iter().map(|t| (1.0 - (2.0 * t).cos()) * t).collect();
            let motor = CubicSpline::new(&time, &turned, End::NotAKnot).unwrap();
            let samples: Vec<_> = (0..40).map(|k| (0.1 + 0.033 * f64::from(k), 0.0)).collect();
            let frequency = (std::f64::consts::TAU * hertz).ln();
            let parameters = Vector6::new(0.3, offset, frequency, logit, start[0], start[1]);
            let (motor, samples) = (&motor, samples.as_slice());
            let problem = Problem { motor, samples, ground, scale: 0.1, parameters };
            let jacobian = problem.jacobian().unwrap();
            for k in 0..6 {
                let by_step = problem.by_step(k).unwrap();
                let size = by_step.amax().max(1.0);
                prop_assert!((jacobian.column(k) - by_step).amax() < 1e-6 * size);
            }
        }
    }
}
