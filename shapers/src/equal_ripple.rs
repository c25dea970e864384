//! The extra-insensitive shapers solved for the actual damping ratio.
//!
//! A shaper with `n` humps has `N = n + 2` impulses and `N - 1` zeros. With
//! `H(w) = sum A_i exp(mu w tau_i)`, `tau_i = t_N - t_i`, `mu = -xi + j sqrt(1 - xi^2)`, so that
//! `|H| = V`, the conditions are
//!
//! * `H(z) = 0` at each zero `z`;
//! * `|H(h)| = ripple` and `d|H|/dw (h) = 0` at each hump `h`;
//! * the middle one (a hump if `n` is odd, a zero if it is even) lies at `w = 1`, the design mode.
//!
//! They are as many as the unknowns: amplitudes, delays, and the free zeros and humps. Newton's
//! method follows the solution from `xi = 0`, where it is known in closed form.

use crate::linear::solve;
use crate::pole::{dot, unit_pole};
use crate::{Impulse, ImpulseTrain, Mode, ShaperError};
use arrayvec::ArrayVec;
use core::f64::consts::PI;
use num_complex::Complex64;
use num_traits::Float;

/// Residual vibration that the extra-insensitive shapers allow.
pub const HUMP_TOLERANCE: f64 = 0.05;

/// Unknowns of the largest system: three humps, 4 amplitudes, 4 delays, 4 zeros, 2 humps.
const SIZE: usize = 14;
const NEWTON_ITERATIONS: usize = 8;
/// Newton's last change squared is the error left, so that 1e-11 leaves rounding only.
const CONVERGED: f64 = 1e-11;
/// A correction larger than this (in units of `1 / omega_n` and of the design frequency) may have
/// reached another branch of solutions: the step is halved instead.
const SAME_BRANCH: f64 = 0.3;
const FIRST_STEP: f64 = 0.03;
const SMALLEST_STEP: f64 = 1e-4;
/// Upper bound of the work: each attempt is at most [`NEWTON_ITERATIONS`] systems of [`SIZE`].
const ATTEMPTS: usize = 64;

type Unknowns = [f64; SIZE];

/// One extra-insensitive shaper.
pub(crate) struct EqualRipple {
    pub name: &'static str,
    /// Humps, 1 to 3.
    pub humps: usize,
    /// Up to which damping ratio the humps have which height, ascending.
    pub ranges: &'static [(f64, f64)],
}

impl EqualRipple {
    /// Solves the shaper: no allocation, at most 64 Newton solutions of 8 iterations (about 10 for
    /// a damping ratio of 0.1).
    pub fn design(&self, mode: Mode) -> Result<ImpulseTrain, ShaperError> {
        let damping_ratio = mode.damping_ratio();
        let Some(&(_, ripple)) = self.ranges.iter().find(|range| damping_ratio <= range.0) else {
            let limit = self.ranges.last().map_or(0.0, |range| range.0);
            return Err(ShaperError::DampingTooHigh {
                shaper: self.name,
                damping_ratio,
                limit,
            });
        };
        let system = System {
            impulses: self.humps + 2,
            ripple,
        };
        let unknowns = system
            .follow(damping_ratio)
            .ok_or(ShaperError::NotConverged {
                shaper: self.name,
                damping_ratio,
            })?;
        let start = system.delay(&unknowns, 0);
        let impulses: ArrayVec<Impulse, 5> = (0..system.impulses)
            .map(|i| Impulse {
                time: (start - system.delay(&unknowns, i)) / mode.natural_frequency(),
                amplitude: system.amplitude(&unknowns, i),
            })
            .collect();
        ImpulseTrain::new(&impulses)
    }
}

/// A zero or a hump: its frequency, and where that stands among the unknowns if it is free.
struct Point {
    frequency: f64,
    unknown: Option<usize>,
    is_zero: bool,
}

/// `H` at one frequency, with its derivatives by frequency, amplitudes and delays.
struct Response {
    value: Complex64,
    slope: Complex64,
    curvature: Complex64,
    by_amplitude: [(Complex64, Complex64); 4],
    by_delay: [(Complex64, Complex64); 4],
}

struct System {
    impulses: usize,
    ripple: f64,
}

impl System {
    /// Free amplitudes, and free delays: the last amplitude follows from the sum, its delay is 0.
    fn free(&self) -> usize {
        self.impulses - 1
    }

    fn size(&self) -> usize {
        2 * self.free() + 2 * (self.free() / 2) + 2 * ((self.free() - 1) / 2)
    }

    fn amplitude(&self, unknowns: &Unknowns, i: usize) -> f64 {
        let amplitudes = &unknowns[..self.free()];
        amplitudes
            .get(i)
            .copied()
            .unwrap_or_else(|| 1.0 - amplitudes.iter().sum::<f64>())
    }

    fn delay(&self, unknowns: &Unknowns, i: usize) -> f64 {
        if i < self.free() {
            unknowns[self.free() + i]
        } else {
            0.0
        }
    }

    /// Zeros from low to high, then humps; the middle of an odd number of them is the design mode.
    fn points(&self, unknowns: &Unknowns) -> ArrayVec<Point, 7> {
        let mut next = 2 * self.free();
        let mut points = ArrayVec::new();
        for (is_zero, count) in [(true, self.impulses - 1), (false, self.impulses - 2)] {
            for k in 0..count {
                let anchored = 2 * k + 1 == count;
                let unknown = (!anchored).then_some(next);
                next += usize::from(!anchored);
                let frequency = unknown.map_or(1.0, |index| unknowns[index]);
                points.push(Point {
                    frequency,
                    unknown,
                    is_zero,
                });
            }
        }
        points
    }

    /// The closed forms for `xi = 0`, by `c = cos(pi w)`: `H` is a polynomial in `c`.
    fn undamped(&self) -> Unknowns {
        let v = self.ripple;
        let mut amplitudes: ArrayVec<f64, 4> = ArrayVec::new();
        let mut cosines: ArrayVec<f64, 3> = ArrayVec::new();
        match self.impulses {
            3 => {
                amplitudes.extend([0.25 * (1.0 + v), 0.5 * (1.0 - v)]);
                cosines.extend([-(1.0 - v) / (1.0 + v)]);
            }
            4 => {
                let x = Float::cbrt(v * v * (Float::sqrt(1.0 - v * v) + 1.0));
                let a = (3.0 * x * x + 2.0 * x + 3.0 * v * v) / (16.0 * x);
                let b = 0.5 - a;
                amplitudes.extend([a, b, b]);
                cosines.extend([(a - b) / (2.0 * a), -(3.0 * a + b) / (6.0 * a)]);
            }
            _ => {
                let a = (1.0 + 3.0 * v + 2.0 * Float::sqrt(2.0 * (v * v + v))) / 16.0;
                let b = 0.25 * (1.0 - v);
                let c = 1.0 - 2.0 * (a + b);
                amplitudes.extend([a, b, c, b]);
                let root = Float::sqrt(b * b - 4.0 * a * (c - 2.0 * a));
                cosines.extend([
                    (root - b) / (4.0 * a),
                    (-root - b) / (4.0 * a),
                    -b / (4.0 * a),
                ]);
            }
        }
        self.assemble(&amplitudes, &cosines)
    }

    /// Frequencies `acos(c) / pi` below the design mode, and their mirror images above it.
    fn assemble(&self, amplitudes: &[f64], cosines: &[f64]) -> Unknowns {
        let mut unknowns = [0.0; SIZE];
        let free = self.free();
        unknowns[..free].copy_from_slice(amplitudes);
        for i in 0..free {
            unknowns[free + i] = PI * (free - i) as f64;
        }
        let mut next = 2 * free;
        let (zeros, humps) = cosines.split_at(free / 2);
        for group in [zeros, humps] {
            let below = group.iter().map(|c| Float::acos(*c) / PI);
            let above = group.iter().rev().map(|c| 2.0 - Float::acos(*c) / PI);
            for frequency in below.chain(above) {
                unknowns[next] = frequency;
                next += 1;
            }
        }
        unknowns
    }

    /// Follows the solution from `xi = 0` to `damping_ratio` by steps of adapted length.
    fn follow(&self, damping_ratio: f64) -> Option<Unknowns> {
        let mut current = (0.0, self.newton(self.undamped(), 0.0)?);
        let mut previous = current;
        let mut step = FIRST_STEP;
        for _ in 0..ATTEMPTS {
            if current.0 >= damping_ratio {
                return Some(current.1);
            }
            let xi = (current.0 + step).min(damping_ratio);
            let span = current.0 - previous.0;
            let ratio = if span > 0.0 {
                (xi - current.0) / span
            } else {
                0.0
            };
            let mut guess = current.1;
            for (value, old) in guess.iter_mut().zip(&previous.1) {
                *value += ratio * (*value - old);
            }
            if let Some(solution) = self.newton(guess, xi) {
                previous = current;
                current = (xi, solution);
                step *= 1.5;
            } else {
                step *= 0.5;
                if step < SMALLEST_STEP {
                    return None;
                }
            }
        }
        None
    }

    fn newton(&self, guess: Unknowns, damping_ratio: f64) -> Option<Unknowns> {
        let mut unknowns = guess;
        for _ in 0..NEWTON_ITERATIONS {
            let (mut jacobian, mut residual) = self.linearise(&unknowns, damping_ratio);
            let change = solve(self.size(), &mut jacobian, &mut residual)?;
            let mut largest = 0.0_f64;
            for ((value, delta), first) in unknowns.iter_mut().zip(change).zip(guess) {
                *value -= delta;
                largest = largest.max(delta.abs());
                let same_branch = (*value - first).abs() < SAME_BRANCH;
                if !same_branch {
                    return None;
                }
            }
            if largest < CONVERGED {
                return self.is_ordered(&unknowns).then_some(unknowns);
            }
        }
        None
    }

    fn is_ordered(&self, unknowns: &Unknowns) -> bool {
        let positive = (0..self.impulses).all(|i| self.amplitude(unknowns, i) > 0.0);
        let delays =
            (0..self.free()).all(|i| self.delay(unknowns, i) > self.delay(unknowns, i + 1));
        positive && delays
    }

    fn response(&self, unknowns: &Unknowns, pole: Complex64, frequency: f64) -> Response {
        let mut response = Response {
            value: Complex64::default(),
            slope: Complex64::default(),
            curvature: Complex64::default(),
            by_amplitude: Default::default(),
            by_delay: Default::default(),
        };
        for i in 0..self.impulses {
            let (amplitude, delay) = (self.amplitude(unknowns, i), self.delay(unknowns, i));
            let rate = pole.scale(delay);
            let wave = rate.scale(frequency).exp();
            let slope = rate * wave;
            response.value += wave.scale(amplitude);
            response.slope += slope.scale(amplitude);
            response.curvature += (rate * slope).scale(amplitude);
            if i < self.free() {
                // The last amplitude is 1 less the others and its wave is 1.
                response.by_amplitude[i] = (wave - Complex64::ONE, slope);
                let turn = (pole * wave).scale(amplitude);
                response.by_delay[i] = (
                    turn.scale(frequency),
                    turn * (Complex64::ONE + rate.scale(frequency)),
                );
            }
        }
        response
    }

    fn linearise(&self, unknowns: &Unknowns, xi: f64) -> ([Unknowns; SIZE], Unknowns) {
        let pole = unit_pole(xi);
        let (mut jacobian, mut residual) = ([[0.0; SIZE]; SIZE], [0.0; SIZE]);
        for (k, point) in self.points(unknowns).iter().enumerate() {
            let at = self.response(unknowns, pole, point.frequency);
            let rows = [2 * k, 2 * k + 1];
            let mut set = |column: usize, value: Complex64, slope: Complex64| {
                let pair = if point.is_zero {
                    [value.re, value.im]
                } else {
                    let level = 2.0 * dot(at.value, value) / (self.ripple * self.ripple);
                    [
                        level,
                        (dot(value, at.slope) + dot(at.value, slope)) / self.ripple,
                    ]
                };
                jacobian[rows[0]][column] = pair[0];
                jacobian[rows[1]][column] = pair[1];
            };
            for i in 0..self.free() {
                set(i, at.by_amplitude[i].0, at.by_amplitude[i].1);
                set(self.free() + i, at.by_delay[i].0, at.by_delay[i].1);
            }
            if let Some(column) = point.unknown {
                set(column, at.slope, at.curvature);
            }
            [residual[rows[0]], residual[rows[1]]] = if point.is_zero {
                [at.value.re, at.value.im]
            } else {
                let level = at.value.norm_sqr() / (self.ripple * self.ripple) - 1.0;
                [level, dot(at.value, at.slope) / self.ripple]
            };
        }
        (jacobian, residual)
    }
}
