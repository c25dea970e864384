//! `A / C` of [`input_noise`](super::input_noise), for samples at even distances.

use nalgebra::{Complex, DMatrix};
use quell_control::estimators::Sample;
use quell_shapers::Mode;
use quell_signal::polynomial::product;

/// Modes with their shares of the motion's deformation and the amplitudes of their free vibration, and an offset.
pub struct Ringing {
    pub modes: Vec<(Mode, f64, [f64; 2])>,
    pub offset: f64,
}

impl Ringing {
    /// The greatest `|H|^2` at the frequency of a mode.
    pub fn loudest(&self) -> f64 {
        let at = |s: Complex<f64>| {
            let each = self.modes.iter().map(|(mode, share, _)| {
                let w = mode.natural_frequency();
                share * w * w / (s * s + 2.0 * mode.damping_ratio() * w * s + w * w)
            });
            each.sum::<Complex<f64>>().norm_sqr()
        };
        let peaks = self.modes.iter().map(|(mode, ..)| {
            let frequency = mode.natural_frequency();
            at(Complex::new(0.0, frequency))
        });
        peaks.fold(0.0, f64::max)
    }

    /// Coefficients of `s^0`, `s^1`, ... of `A` and of `B`.
    fn polynomials(&self) -> [Vec<f64>; 2] {
        let own = |mode: &Mode| {
            let w = mode.natural_frequency();
            vec![w * w, 2.0 * mode.damping_ratio() * w, 1.0]
        };
        let without = |left_out: Option<usize>| {
            let others = self.modes.iter().enumerate();
            let others = others.filter(|(m, _)| Some(*m) != left_out);
            others.fold(vec![1.0], |all, (_, (mode, ..))| product(&all, &own(mode)))
        };
        let mut response = vec![0.0; 2 * self.modes.len() - 1];
        for (m, (mode, share, _)) in self.modes.iter().enumerate() {
            for (sum, other) in response.iter_mut().zip(without(Some(m))) {
                *sum += share * mode.natural_frequency().powi(2) * other;
            }
        }
        [without(None), response]
    }

    /// The free vibration and the offset, `count` steps before the first sample.
    fn before(&self, count: usize, step: f64) -> f64 {
        let each = self.modes.iter().map(|(mode, _, free)| {
            let turn = pole(mode, step).powi(-(count as i32));
            free[0] * turn.re + free[1] * turn.im
        });
        self.offset + each.sum::<f64>()
    }
}

/// A filter of as many zeros as poles.
pub struct Whitener {
    step: f64,
    /// Coefficients of the delays from the first on, of zeros and of poles.
    zeros: Vec<f64>,
    poles: Vec<f64>,
}

impl Whitener {
    /// The filter for modes and a ratio of noise; `None` where `C` is faster than the samples tell.
    pub fn new(ringing: &Ringing, ratio: f64, step: f64) -> Option<Self> {
        let [a, b] = ringing.polynomials();
        let mut squared = even(&a);
        for (sum, other) in squared.iter_mut().zip(even(&b)) {
            *sum += ratio * other;
        }
        let left: Vec<Complex<f64>> = roots(&squared)?.map(|x| -x.sqrt()).collect();
        let is_slow = |s: &Complex<f64>| s.norm() * step < core::f64::consts::PI;
        let zeros = ringing.modes.iter().flat_map(|(mode, ..)| {
            let own = pole(mode, step);
            [own, own.conj()]
        });
        left.iter().all(is_slow).then(|| Self {
            step,
            zeros: delays(zeros),
            poles: delays(left.iter().map(|s| (s * step).exp())),
        })
    }

    /// Filters values; `before(k)` is the value `k` steps before the first, and `rest` is the output then.
    pub fn of(&self, values: &[f64], before: impl Fn(usize) -> f64, rest: f64) -> Vec<f64> {
        let order = self.zeros.len();
        let mut filtered: Vec<f64> = Vec::with_capacity(values.len());
        for (k, value) in values.iter().enumerate() {
            let mut own = *value;
            for delay in 1..=order {
                let x = match k.checked_sub(delay) {
                    Some(earlier) => [values[earlier], filtered[earlier]],
                    None => [before(delay - k), rest],
                };
                own += self.zeros[delay - 1] * x[0] - self.poles[delay - 1] * x[1];
            }
            filtered.push(own);
        }
        filtered
    }

    /// Both signals. Before the first sample the motor side stood still, and the deformation was that of the free
    /// vibration.
    pub fn samples(&self, samples: &[Sample], ringing: &Ringing) -> Vec<Sample> {
        let constant = |delays: &[f64]| 1.0 + delays.iter().sum::<f64>();
        let gain = constant(&self.zeros) / constant(&self.poles);
        // Counted from the first, so that a constant has no rounding.
        let origin = samples[0].motor_position;
        let moved: Vec<f64> = samples.iter().map(|s| s.motor_position - origin).collect();
        let deformation: Vec<f64> = samples.iter().map(|s| s.deformation).collect();
        let moved = self.of(&moved, |_| 0.0, 0.0);
        let free = |count| ringing.before(count, self.step);
        let deformation = self.of(&deformation, free, gain * ringing.offset);
        let both = moved.into_iter().zip(deformation);
        let white = |(own, (motor_position, deformation)): (&Sample, (f64, f64))| Sample {
            motor_position,
            deformation,
            ..*own
        };
        samples.iter().zip(both).map(white).collect()
    }
}

/// `e^(lambda T)` of a mode.
fn pole(mode: &Mode, step: f64) -> Complex<f64> {
    let (w, xi) = (mode.natural_frequency(), mode.damping_ratio());
    (Complex::new(-xi, (1.0 - xi * xi).max(0.0).sqrt()) * (w * step)).exp()
}

/// Coefficients of the delays of `product (1 - p z)`, whose `p` come in pairs.
fn delays(all: impl Iterator<Item = Complex<f64>>) -> Vec<f64> {
    let one = Complex::new(1.0, 0.0);
    let all = all.fold(vec![one], |all, own| product(&all, &[one, -own]));
    all[1..].iter().map(|own| own.re).collect()
}

/// `P(s) P(-s)` as a polynomial in `s^2`.
fn even(own: &[f64]) -> Vec<f64> {
    let signs = [1.0, -1.0].into_iter().cycle();
    let turned: Vec<f64> = own
        .iter()
        .zip(signs)
        .map(|(own, sign)| sign * own)
        .collect();
    product(own, &turned).into_iter().step_by(2).collect()
}

/// Roots of a polynomial: the eigenvalues of its companion matrix, in units of the geometric mean of the roots.
fn roots(own: &[f64]) -> Option<impl Iterator<Item = Complex<f64>> + use<>> {
    let order = own.len() - 1;
    let unit = (own[0] / own[order]).abs().powf(1.0 / order as f64);
    let mut companion = DMatrix::<f64>::zeros(order, order);
    for k in 0..order {
        companion[(k, order - 1)] = -own[k] / own[order] * unit.powi(k as i32 - order as i32);
        if k > 0 {
            companion[(k, k - 1)] = 1.0;
        }
    }
    if companion.iter().any(|own| !own.is_finite()) {
        return None;
    }
    let eigenvalues: Vec<_> = companion.complex_eigenvalues().iter().copied().collect();
    Some(eigenvalues.into_iter().map(move |own| own * unit))
}
