//! The missing force as a random walk: Kalman filter, likelihood, smoother.

use nalgebra::{Matrix3, Vector3};

use super::search::maximum;
use super::transition::{Path, Transition};

/// Relative change of the covariance between stamps below which it is kept constant.
const STEADY: f64 = 1e-12;

/// The state-space model of a residual, for the intervals of its stamps.
pub(super) struct Smoother {
    transitions: Vec<Transition>,
    /// Index of the transition from each stamp to the next.
    which: Vec<usize>,
    /// The walk begins at rest this much before the first stamp. The initial covariance is its part of the
    /// walk, so that without a walk there is no error.
    before: Transition,
    /// Model time for one second.
    rate: f64,
}

/// Result of the smoother for a residual.
pub(super) struct Smoothed {
    /// Error and its rate, in units of the residual (and of it per second).
    pub error: Vec<[f64; 2]>,
    /// Missing force, in units of the residual times `rate^2`.
    pub missing: Vec<f64>,
    /// Its standard deviation.
    pub missing_std: Vec<f64>,
    /// For the interval before each stamp: log-likelihood gain of a jump of the velocity.
    pub velocity_jump: Vec<f64>,
    /// The same for a jump of the missing force.
    pub force_jump: Vec<f64>,
}

/// One pass of the filter, with all inputs of the smoother.
#[derive(Clone, Copy)]
struct Pass {
    state: Vector3<f64>,
    covariance: Matrix3<f64>,
    innovation: f64,
    variance: f64,
}

impl Smoother {
    /// The smoother for these stamps; `lead` is the time before the first stamp at which the walk began, s. At
    /// `restarts` the error begins again in the same way, and the force continues.
    pub fn new(path: Path, rate: f64, time: &[f64], lead: f64, restarts: &[f64]) -> Self {
        let path = match path {
            Path::Motion { damping, stiffness } => Path::Motion {
                damping: damping / rate,
                stiffness: stiffness / (rate * rate),
            },
            Path::Direct => Path::Direct,
        };
        let before = Transition::new(path, lead * rate);
        let mut known: Vec<(f64, bool)> = Vec::new();
        let mut transitions = Vec::new();
        let mut which = Vec::with_capacity(time.len());
        for pair in time.windows(2) {
            let interval = (pair[1] - pair[0]).max(0.0) * rate;
            let anew = restarts.partition_point(|t| *t <= pair[0])
                < restarts.partition_point(|t| *t <= pair[1]);
            // Stamps are rounded: intervals that differ by 1e-9 are equal.
            let same =
                |own: &(f64, bool)| own.1 == anew && (own.0 - interval).abs() <= 1e-9 * interval;
            which.push(match known.iter().rev().take(4).position(same) {
                Some(back) => known.len() - 1 - back,
                None => {
                    known.push((interval, anew));
                    let step = Transition::new(path, interval);
                    transitions.push(if anew { step.anew(&before) } else { step });
                    known.len() - 1
                }
            });
        }
        Self {
            transitions,
            which,
            before,
            rate,
        }
    }

    /// The intensity of the walk (relative to the variance of the noise) with the greatest likelihood, and the
    /// logarithm of that likelihood. The noise's variance is concentrated out.
    pub fn fit(&self, residual: &[f64]) -> (f64, f64) {
        // In model time one unit of intensity moves the error by about the noise in one time unit.
        let (q, gain) = maximum(-25.0, 25.0, 2.5, |log| self.likelihood(residual, log.exp()));
        (q.exp(), gain)
    }

    /// Log-likelihood, the noise's variance concentrated out, constants left out.
    pub fn likelihood(&self, residual: &[f64], intensity: f64) -> f64 {
        let (mut squares, mut logs) = (0.0, 0.0);
        self.filter(residual, intensity, |pass| {
            squares += pass.innovation * pass.innovation / pass.variance;
            logs += pass.variance.ln();
        });
        let n = residual.len() as f64;
        -0.5 * n * (squares / n).max(f64::MIN_POSITIVE).ln() - 0.5 * logs
    }

    fn filter(&self, residual: &[f64], intensity: f64, mut each: impl FnMut(&Pass)) {
        let mut state = Vector3::zeros();
        let mut covariance = self.before.noise * intensity;
        let mut steady: Option<usize> = None;
        for (k, r) in residual.iter().enumerate() {
            let variance = covariance[(0, 0)] + 1.0;
            let pass = Pass {
                state,
                covariance,
                innovation: r - state[0],
                variance,
            };
            each(&pass);
            let Some(&which) = self.which.get(k) else {
                return;
            };
            let step = &self.transitions[which];
            let gain = covariance.column(0) / variance;
            state = step.phi * (state + gain * pass.innovation);
            if steady == Some(which) {
                continue;
            }
            let next = symmetric(
                step.phi * updated(&covariance, &gain) * step.phi.transpose()
                    + step.noise * intensity,
            );
            let settled = (0..3)
                .all(|i| (next[(i, i)] - covariance[(i, i)]).abs() <= STEADY * covariance[(i, i)]);
            steady = settled.then_some(which);
            covariance = next;
        }
    }

    /// Smoothed missing force and the gains of jumps, for this intensity.
    ///
    /// The Rauch-Tung-Striebel estimate in the form of Bierman (1973, "Fixed interval smoothing with
    /// discrete measurements"), which inverts no covariance. Its adjoint variables are the auxiliary
    /// residuals of de Jong and Penzer (1998, "Diagnosing shocks in time series"): `(b' r)^2 / b' N b`
    /// is the chi-squared of a jump of the state along `b`.
    pub fn smooth(&self, residual: &[f64], intensity: f64) -> Smoothed {
        let mut passes = Vec::with_capacity(residual.len());
        self.filter(residual, intensity, |pass| passes.push(*pass));
        let n = passes.len();
        let squares: f64 = passes
            .iter()
            .map(|p| p.innovation * p.innovation / p.variance)
            .sum();
        let noise = (squares / n.max(1) as f64).max(f64::MIN_POSITIVE);
        let mut found = Smoothed {
            error: vec![[0.0; 2]; n],
            missing: vec![0.0; n],
            missing_std: vec![0.0; n],
            velocity_jump: vec![0.0; n],
            force_jump: vec![0.0; n],
        };
        let (mut adjoint, mut information) = (Vector3::zeros(), Matrix3::zeros());
        let scale = self.rate * self.rate;
        for (k, pass) in passes.iter().enumerate().rev() {
            (adjoint, information) = self.backward(k, pass, &adjoint, &information);
            let smoothed = pass.state + pass.covariance * adjoint;
            let row = pass.covariance.column(2);
            let variance = pass.covariance[(2, 2)] - row.dot(&(information * row));
            found.error[k] = [smoothed[0], smoothed[1] * self.rate];
            found.missing[k] = smoothed[2] * scale;
            found.missing_std[k] = (variance.max(0.0) * noise).sqrt() * scale;
            found.velocity_jump[k] = jump(&adjoint, &information, 1) / noise;
            found.force_jump[k] = jump(&adjoint, &information, 2) / noise;
        }
        found
    }

    /// The error's response to a force given at the stamps; in between it is constant at the mean.
    pub fn response(&self, force: &[f64]) -> Vec<f64> {
        let mut state = Vector3::zeros();
        let mut found = vec![state[0]; force.len()];
        for (k, &which) in self.which.iter().enumerate() {
            state[2] = 0.5 * (force[k] + force[k + 1]);
            state = self.transitions[which].phi * state;
            found[k + 1] = state[0];
        }
        found
    }

    /// The error after a unit jump of one component of the state at a stamp.
    pub fn after_jump(&self, stamp: usize, component: usize) -> Vec<f64> {
        let mut found = vec![0.0; self.which.len() + 1];
        let mut state = Vector3::zeros();
        state[component] = 1.0;
        for (k, error) in found.iter_mut().enumerate().skip(stamp) {
            *error = state[0];
            if let Some(&which) = self.which.get(k) {
                state = self.transitions[which].phi * state;
            }
        }
        found
    }

    /// Adjoint and its information before stamp `k`, from their values after it.
    fn backward(
        &self,
        k: usize,
        pass: &Pass,
        adjoint: &Vector3<f64>,
        information: &Matrix3<f64>,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let mut before = Vector3::zeros();
        let mut known = Matrix3::zeros();
        if let Some(&which) = self.which.get(k) {
            let mut leads = Matrix3::identity();
            let gain = pass.covariance.column(0) / pass.variance;
            leads.set_column(0, &(leads.column(0) - gain));
            let leads = self.transitions[which].phi * leads;
            before = leads.transpose() * adjoint;
            known = symmetric(leads.transpose() * information * leads);
        }
        before[0] += pass.innovation / pass.variance;
        known[(0, 0)] += 1.0 / pass.variance;
        (before, known)
    }
}

/// Half the chi-squared of a jump along one component of the state.
fn jump(adjoint: &Vector3<f64>, information: &Matrix3<f64>, component: usize) -> f64 {
    let known = information[(component, component)];
    if known > f64::MIN_POSITIVE {
        0.5 * adjoint[component] * adjoint[component] / known
    } else {
        0.0
    }
}

/// Joseph's form of the update by one measurement of the first state with variance 1:
/// `(I - K h') P (I - K h')' + K K'`.
fn updated(covariance: &Matrix3<f64>, gain: &Vector3<f64>) -> Matrix3<f64> {
    let left = covariance - gain * covariance.row(0);
    left - left.column(0) * gain.transpose() + gain * gain.transpose()
}

fn symmetric(matrix: Matrix3<f64>) -> Matrix3<f64> {
    (matrix + matrix.transpose()) * 0.5
}
