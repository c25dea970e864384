//! The free vibration of a mode after a motion.

use nalgebra::Complex;
use quell_trajectories::AxisProfile;

use super::steps::Step;

/// A mode that a motion excites.
///
/// A motion from rest to rest leaves a deflection of the amplitude `|int_0^T a(t) exp(mu (T - t)) dt| / omega_d
/// = |int_0^T j(t) exp(mu (T - t)) dt / mu| / omega_d`, `mu = -xi omega + i omega_d`, `omega_d = omega sqrt(1 -
/// xi^2)`; this holds for a damper across the joint and for one to ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    pole: Complex<f64>,
}

impl Swing {
    /// A mode by its natural frequency (rad/s, above 0) and damping ratio, `[0, 1)`.
    pub fn new(frequency: f64, damping_ratio: f64) -> Self {
        let damped = frequency * (1.0 - damping_ratio * damping_ratio).sqrt();
        Self {
            pole: Complex::new(-damping_ratio * frequency, damped),
        }
    }

    /// Its natural frequency, rad/s.
    pub fn frequency(&self) -> f64 {
        self.pole.norm()
    }

    /// Its damping ratio.
    pub fn damping_ratio(&self) -> f64 {
        -self.pole.re / self.pole.norm()
    }

    /// The residual of a jerk of 1 over a step of `h` s, at its end.
    fn step(&self, h: f64) -> Complex<f64> {
        (self.pole.scale(h).exp() - 1.0) / (self.pole * self.pole * self.pole.im)
    }

    /// The residual of a jerk of 1 in each of some steps, at the end of the last.
    pub fn of_steps(&self, steps: &[Step]) -> Vec<Complex<f64>> {
        let mut after: f64 = steps.iter().map(|step| step.duration).sum();
        let each = steps.iter().map(|step| {
            after -= step.duration;
            self.step(step.duration) * self.pole.scale(after).exp()
        });
        each.collect()
    }

    /// Amplitude that a plan leaves at its end.
    pub fn left_by_plan(&self, plan: &AxisProfile) -> f64 {
        let (mut sum, mut duration) = (Complex::new(0.0, 0.0), 0.0);
        let [mut turn, mut step] = [sum; 2];
        for phase in plan.phases() {
            // Many phases have the duration of the one before.
            if phase.duration != duration {
                duration = phase.duration;
                (turn, step) = (self.pole.scale(duration).exp(), self.step(duration));
            }
            sum = sum * turn + step.scale(phase.jerk);
        }
        sum.norm()
    }
}
