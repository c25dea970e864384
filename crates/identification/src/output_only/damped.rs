//! Damped sinusoids, fitted to free decays by maximum likelihood.
//!
//! `y(t) = c + sum_m e^(-S_m(t)) (p_m cos W_m(t) + q_m sin W_m(t))`, with `S = s t`, `W = w t` for a linear mode. Where a
//! mode depends on a power of its amplitude, `W = w t + w_1 (1 - e^(-r s t)) / (r s)`, and `S` alike; under dry friction
//! `e^(-S) = (1 + k) e^(-s t) - k`, until it rests. Offsets and amplitudes are linear and are solved for (variable projection); frequencies and rates are shared by all decays.
//!
//! Source: G. H. Golub and V. Pereyra, SIAM J. Numerical Analysis 10 (1973).

use super::least_squares::{Minimum, minimise};
use crate::stop::Stop;
use nalgebra::{DMatrix, DVector};

/// Steps of the differences for the Jacobian: of logarithms, and of shifts as shares.
const STEP: f64 = 1e-6;

/// One decay, from its first sample on.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Time between samples, s.
    pub period: f64,
    /// One column for each axis.
    pub values: DMatrix<f64>,
}

/// One mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damped {
    /// Damped angular frequency, rad/s; at small amplitude.
    pub frequency: f64,
    /// Decay rate, 1/s; at small amplitude.
    pub rate: f64,
    /// Dependence on the amplitude, where it has one.
    pub bend: Option<Bend>,
}

/// Dependence of a mode on its amplitude: relative differences of frequency and rate at the start of a decay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Of the frequency.
    pub frequency: f64,
    /// Of the rate.
    pub rate: f64,
    /// The law that it follows.
    pub law: Law,
}

/// The law of a mode's frequency and rate over the amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// A power of the amplitude: 1 for clamps and material, 2 for geometry and drag.
    Power(f64),
    /// The rate follows one over the amplitude, as under dry friction; the frequency follows the amplitude.
    Friction,
}

/// Fitted modes, and their residual.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The modes.
    pub modes: Vec<Damped>,
    /// The minimum; its unknowns are in the order of [`unknowns`].
    pub minimum: Minimum,
}

/// Logarithms of frequency and rate of each mode, then its bend.
fn unknowns(modes: &[Damped]) -> Vec<f64> {
    let of = |mode: &Damped| {
        let bend = mode.bend.map(|bend| vec![bend.frequency, bend.rate]);
        [
            vec![mode.frequency.ln(), mode.rate.ln()],
            bend.unwrap_or_default(),
        ]
        .concat()
    };
    modes.iter().flat_map(of).collect()
}

/// The modes at some unknowns.
fn modes_at(modes: &[Damped], at: &[f64]) -> Vec<Damped> {
    let mut next = at.iter().copied();
    let mut take = || next.next().unwrap_or(0.0);
    let one = |mode: &Damped| Damped {
        frequency: take().exp(),
        rate: take().exp(),
        bend: mode.bend.map(|bend| Bend {
            frequency: take(),
            rate: take(),
            ..bend
        }),
    };
    modes.iter().map(one).collect()
}

/// Fits the modes from a start.
pub fn fit(segments: &[Segment], start: &[Damped], stop: Stop) -> Option<Fit> {
    let at = unknowns(start);
    let steps = vec![STEP; at.len()];
    let residual = |at: &[f64]| residual(segments, &modes_at(start, at));
    let minimum = minimise(residual, &at, &steps, stop)?;
    Some(Fit {
        modes: modes_at(start, &minimum.at),
        minimum,
    })
}

/// Residual of all axes of all decays, one after the other; none where the modes are no vibration.
pub fn residual(segments: &[Segment], modes: &[Damped]) -> Option<DVector<f64>> {
    let mut left = Vec::new();
    for segment in segments {
        let basis = basis(segment, modes)?;
        let amplitudes = project(&basis, &segment.values)?;
        left.extend_from_slice((&segment.values - &basis * amplitudes).as_slice());
    }
    Some(DVector::from_vec(left))
}

/// The linear coefficients of each decay, one column for each axis: an offset, then cosine and sine of each mode.
pub fn coefficients(segments: &[Segment], modes: &[Damped]) -> Option<Vec<DMatrix<f64>>> {
    let of = |segment: &Segment| project(&basis(segment, modes)?, &segment.values);
    segments.iter().map(of).collect()
}

/// The amplitude of each mode at the start of the strongest decay: the root of the sum of squares over the axes.
pub fn amplitudes(segments: &[Segment], modes: &[Damped]) -> Option<Vec<f64>> {
    let mut most = vec![0.0_f64; modes.len()];
    for amplitudes in coefficients(segments, modes)? {
        for (k, most) in most.iter_mut().enumerate() {
            *most = most.max(amplitudes.rows(1 + 2 * k, 2).norm());
        }
    }
    Some(most)
}

/// An offset, and cosine and sine of each mode.
fn basis(segment: &Segment, modes: &[Damped]) -> Option<DMatrix<f64>> {
    let samples = segment.values.nrows();
    let mut basis = DMatrix::from_element(samples, 1 + 2 * modes.len(), 1.0);
    for (k, mode) in modes.iter().enumerate() {
        let nyquist = std::f64::consts::PI / segment.period;
        if !(mode.frequency < nyquist && mode.rate < mode.frequency && mode.rate > 0.0) {
            return None;
        }
        for sample in 0..samples {
            let time = sample as f64 * segment.period;
            let (mut phase, mut decay) = (mode.frequency * time, mode.rate * time);
            if let Some(bend) = mode.bend {
                let power = match bend.law {
                    Law::Power(power) => power,
                    Law::Friction => 1.0,
                };
                let speed = power * mode.rate;
                let away = -(-speed * time).exp_m1() / speed;
                phase += bend.frequency * mode.frequency * away;
                decay = match bend.law {
                    Law::Power(_) => decay + bend.rate * mode.rate * away,
                    Law::Friction => -((1.0 + bend.rate) * (-decay).exp() - bend.rate)
                        .max(0.0)
                        .ln(),
                };
            }
            let (sine, cosine) = phase.sin_cos();
            let amplitude = (-decay).exp();
            basis[(sample, 1 + 2 * k)] = amplitude * cosine;
            basis[(sample, 2 + 2 * k)] = amplitude * sine;
        }
    }
    Some(basis)
}

/// The linear coefficients, one column for each axis.
fn project(basis: &DMatrix<f64>, values: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let mut normal = basis.tr_mul(basis);
    // Regularisation at the level of rounding: nearly equal columns must not stop the descent.
    let small = 1e-13 * normal.trace();
    for k in 0..normal.nrows() {
        normal[(k, k)] += small;
    }
    Some(normal.cholesky()?.solve(&basis.tr_mul(values)))
}
