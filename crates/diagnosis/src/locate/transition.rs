//! Exact discretisation of the error equation driven by a random walk.

use nalgebra::{Matrix3, Vector3};

/// Dynamics between the missing force and the residual.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Path {
    /// `e'' + damping e' + stiffness e = d`.
    Motion { damping: f64, stiffness: f64 },
    /// `e = d`: there are no dynamics.
    Direct,
}

/// One interval of the state `(e, e', d)`: `x+ = phi x + w`, covariance of `w` = intensity of the
/// walk times `noise`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transition {
    pub phi: Matrix3<f64>,
    pub noise: Matrix3<f64>,
}

/// Abscissae on (0, 1) and weights of the five-point Gauss-Legendre rule, exact to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

impl Transition {
    /// The transition over this interval. The interval is halved until power series converge to rounding, then
    /// composed by doubling, `noise(2h) = noise(h) + phi noise(h) phi'`, which has no subtraction.
    pub fn new(path: Path, interval: f64) -> Self {
        let Path::Motion { damping, stiffness } = path else {
            return Self::direct(interval);
        };
        let speed = damping.abs().max(stiffness.abs().sqrt());
        // Ten terms of the series at 0.1 leave 1e-11 / 11!.
        let halvings = (speed * interval / 0.1).log2().ceil().clamp(0.0, 60.0) as i32;
        let mut step = Self::short(damping, stiffness, interval * 0.5f64.powi(halvings));
        for _ in 0..halvings {
            step = Self {
                noise: step.noise + step.phi * step.noise * step.phi.transpose(),
                phi: step.phi * step.phi,
            };
        }
        step
    }

    /// The same for an error that restarts at the interval's end, with the covariance `before` of the start of
    /// a record; only the force continues.
    pub fn anew(mut self, before: &Self) -> Self {
        let force = self.noise[(2, 2)];
        self.noise = before.noise;
        for other in 0..2 {
            self.phi.row_mut(other).fill(0.0);
            (self.noise[(other, 2)], self.noise[(2, other)]) = (0.0, 0.0);
        }
        self.noise[(2, 2)] = force;
        self
    }

    fn direct(interval: f64) -> Self {
        let seen = Vector3::new(1.0, 0.0, 1.0);
        Self {
            phi: seen * Vector3::new(0.0, 0.0, 1.0).transpose(),
            noise: seen * seen.transpose() * interval,
        }
    }

    fn short(damping: f64, stiffness: f64, h: f64) -> Self {
        let [step, rate] = step_response(damping, stiffness, h);
        let curvature = 1.0 - damping * rate - stiffness * step;
        let phi = Matrix3::new(
            1.0 - stiffness * step,
            rate,
            step,
            -stiffness * rate,
            curvature,
            rate,
            0.0,
            0.0,
            1.0,
        );
        let noise = GAUSS.iter().fold(Matrix3::zeros(), |sum, (at, weight)| {
            let [step, rate] = step_response(damping, stiffness, h * at);
            let b = Vector3::new(step, rate, 1.0);
            sum + b * b.transpose() * (h * weight)
        });
        Self { phi, noise }
    }
}

/// `e` and `e'` a short time after `d` went from 0 to 1: `e'' + c e' + k e = 1` by its power series.
fn step_response(damping: f64, stiffness: f64, time: f64) -> [f64; 2] {
    let (mut before, mut term) = (0.0, 0.5 * time * time);
    let (mut value, mut rate) = (term, time);
    for n in 1..10 {
        let n = f64::from(n);
        let next = -(damping * (n + 1.0) * term * time + stiffness * before * time * time)
            / ((n + 2.0) * (n + 1.0));
        value += next;
        rate += next * (n + 2.0) / time.max(f64::MIN_POSITIVE);
        (before, term) = (term, next);
    }
    [value, rate]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_step_response_of_a_damped_oscillator() {
        let (w, xi, t) = (50.0f64, 0.1f64, 0.37f64);
        let path = Path::Motion {
            damping: 2.0 * xi * w,
            stiffness: w * w,
        };
        let found = Transition::new(path, t);
        let wd = w * (1.0 - xi * xi).sqrt();
        let decay = (-xi * w * t).exp();
        let value = (1.0 - decay * ((wd * t).cos() + xi * w / wd * (wd * t).sin())) / (w * w);
        assert!((found.phi[(0, 2)] - value).abs() < 1e-12 * value.abs());
        let rate = decay * (wd * t).sin() / wd;
        assert!((found.phi[(0, 1)] - rate).abs() < 1e-12 / w);
    }

    #[test]
    fn val_noise_of_a_free_mass() {
        // Triple integrator: h^5/20, h^4/8, h^3/6, h^3/3, h^2/2, h.
        let h = 0.3f64;
        let path = Path::Motion {
            damping: 0.0,
            stiffness: 0.0,
        };
        let q = Transition::new(path, h).noise;
        let exact = [
            h.powi(5) / 20.0,
            h.powi(4) / 8.0,
            h.powi(3) / 6.0,
            h.powi(3) / 3.0,
        ];
        let found = [q[(0, 0)], q[(0, 1)], q[(0, 2)], q[(1, 1)]];
        for (exact, found) in exact.iter().zip(found) {
            assert!((exact - found).abs() < 1e-12 * exact);
        }
    }
}
