//! Unity-magnitude zero vibration.

use crate::pole::unit_pole;
use crate::{Impulse, ImpulseTrain, Mode, Shaper, ShaperError};
use core::f64::consts::PI;
use num_complex::Complex64;

/// Newton's method converges quadratically; from the solution at a step's start 6 are enough.
const ITERATIONS: usize = 12;
/// Steps of the damping ratio from 0 to the one asked for.
const STEPS: usize = 8;

/// Above it a vibration is down to 0.2 % after one period by itself.
const HIGHEST_DAMPING: f64 = 0.7;

/// UM-ZV: impulses `1, -1, 1`, a third of a period long; solved for the actual damping ratio.
///
/// `exp(mu (t_3)) - exp(mu (t_3 - t_2)) + 1 = 0`, `mu = omega_n (-xi + j sqrt(1 - xi^2))`;
/// without damping `t = 0, T/6, T/3`. Solved for `xi <= 0.7`. The negative impulse can raise velocity, acceleration and
/// jerk by up to three times ([`ImpulseTrain::gain`]): check the shaped
/// move with [`crate::peak_ratios`].
///
/// Source: Singer, Singhose and Seering 1999.
#[derive(Clone, Copy, Debug)]
pub struct UmZv;

impl Shaper for UmZv {
    fn name(&self) -> &'static str {
        "umzv"
    }

    fn title(&self) -> &'static str {
        "UM-ZV"
    }

    fn summary(&self) -> &'static str {
        "unity-magnitude zero vibration: a third of a period; can exceed the limits of the move"
    }

    fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        let damping_ratio = ShaperError::solved_damping(self.name(), mode, HIGHEST_DAMPING)?;
        let mut delays = [2.0 * PI / 3.0, PI / 3.0];
        for step in 1..=STEPS {
            let xi = damping_ratio * step as f64 / STEPS as f64;
            delays = newton(delays, xi).ok_or(ShaperError::NotConverged {
                shaper: self.name(),
                damping_ratio,
            })?;
        }
        let [end, middle] = delays.map(|delay| delay / mode.natural_frequency());
        ImpulseTrain::new(&[
            Impulse {
                time: 0.0,
                amplitude: 1.0,
            },
            Impulse {
                time: end - middle,
                amplitude: -1.0,
            },
            Impulse {
                time: end,
                amplitude: 1.0,
            },
        ])
    }

    fn is_convex(&self) -> bool {
        false
    }
}

/// Delays before the last impulse of the first and second, at natural frequency 1.
fn newton(mut delays: [f64; 2], damping_ratio: f64) -> Option<[f64; 2]> {
    let pole = unit_pole(damping_ratio);
    for _ in 0..ITERATIONS {
        let first = pole.scale(delays[0]).exp();
        let second = pole.scale(delays[1]).exp();
        let residual = first - second + Complex64::ONE;
        let (a, b) = (pole * first, -(pole * second));
        let determinant = a.re * b.im - a.im * b.re;
        let change = [
            (residual.im * b.re - residual.re * b.im) / determinant,
            (residual.re * a.im - residual.im * a.re) / determinant,
        ];
        delays = [delays[0] + change[0], delays[1] + change[1]];
        // One unit in the last place of a delay near 2 is 4e-16.
        if change[0].abs().max(change[1].abs()) < 1e-14 {
            let ordered = delays[0] > delays[1] && delays[1] > 0.0;
            return ordered.then_some(delays);
        }
    }
    None
}
