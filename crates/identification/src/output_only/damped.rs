//! Damped sinusoids, fitted to free decays by maximum likelihood.
//!
//! `y(t) = c + sum_m a_m(t) (p_m cos W_m(t) + q_m sin W_m(t))`, with the amplitude `a` and the phase `W` of an
//! [oscillation](super::oscillation). Offsets and amplitudes `p`, `q` are linear and are solved for (variable
//! projection); frequencies and rates are shared by all decays.
//!
//! Source: G. H. Golub and V. Pereyra, SIAM J. Numerical Analysis 10 (1973).

use super::least_squares::{Minimum, Squares, minimise};
pub use super::oscillation::{Bend, Damped, Law};
use crate::stop::Stop;
use nalgebra::{Complex, DMatrix, DVector, DVectorView};

/// One decay, from its first sample on.
#[derive(Clone, Debug)]
pub struct Segment {
    /// Time between samples, s.
    pub period: f64,
    /// One column for each axis.
    pub values: DMatrix<f64>,
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

/// Decays, and modes of the form that is fitted to them.
struct Decays<'a> {
    segments: &'a [Segment],
    form: &'a [Damped],
}

impl Squares for Decays<'_> {
    fn residual(&self, at: &[f64]) -> Option<DVector<f64>> {
        residual(self.segments, &modes_at(self.form, at))
    }

    /// Kaufman's: of the derivative `D` of the modes at fixed amplitudes, what the basis `B` cannot make, so that
    /// `J^T J = D^T D - D^T B (B^T B)^-1 B^T D`. With `r` orthogonal to `B`, `J^T r = -D^T r`.
    /// Source: L. Kaufman, BIT 15 (1975).
    fn normal(&self, at: &[f64], residual: &DVector<f64>) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let modes = modes_at(self.form, at);
        let mut normal = DMatrix::zeros(at.len(), at.len());
        let mut gradient = DVector::zeros(at.len());
        let mut from = 0;
        for segment in self.segments {
            let basis = basis(segment, &modes)?;
            let factor = regular(&basis).cholesky()?;
            let amplitudes = factor.solve(&basis.tr_mul(&segment.values));
            for axis in 0..segment.values.ncols() {
                let rows = segment.values.nrows();
                let along = derivatives(segment, &modes, (&basis, &amplitudes.column(axis)));
                let made = basis.tr_mul(&along);
                normal += along.tr_mul(&along) - made.tr_mul(&factor.solve(&made));
                gradient -= along.tr_mul(&residual.rows(from, rows));
                from += rows;
            }
        }
        Some((normal, gradient))
    }
}

/// Derivatives of the modes in a basis at these amplitudes, one column for each unknown.
fn derivatives(
    segment: &Segment,
    modes: &[Damped],
    (basis, amplitudes): (&DMatrix<f64>, &DVectorView<f64>),
) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(basis.nrows(), unknowns(modes).len());
    let mut column = 0;
    for (k, mode) in modes.iter().enumerate() {
        let (straight, turned) = (1 + 2 * k, 2 + 2 * k);
        // The real part of it, times the mode, is what the mode makes at these amplitudes.
        let amplitude = Complex::new(amplitudes[straight], -amplitudes[turned]);
        let count = unknowns(std::slice::from_ref(mode)).len();
        for sample in 0..basis.nrows() {
            let mode_then = Complex::new(basis[(sample, straight)], basis[(sample, turned)]);
            let made = amplitude * mode_then;
            let slopes = mode.slopes(sample as f64 * segment.period);
            for (by, slope) in slopes.iter().take(count).enumerate() {
                all[(sample, column + by)] = made.re * slope.re - made.im * slope.im;
            }
        }
        column += count;
    }
    all
}

/// Fits the modes from a start.
pub fn fit(segments: &[Segment], start: &[Damped], stop: Stop) -> Option<Fit> {
    let decays = Decays {
        segments,
        form: start,
    };
    let minimum = minimise(&decays, &unknowns(start), stop)?;
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
pub fn basis(segment: &Segment, modes: &[Damped]) -> Option<DMatrix<f64>> {
    let samples = segment.values.nrows();
    let mut basis = DMatrix::from_element(samples, 1 + 2 * modes.len(), 1.0);
    for (k, mode) in modes.iter().enumerate() {
        let nyquist = std::f64::consts::PI / segment.period;
        if !(mode.frequency < nyquist && mode.rate < mode.frequency && mode.rate > 0.0) {
            return None;
        }
        for (sample, turn) in mode.over(segment.period).take(samples).enumerate() {
            basis[(sample, 1 + 2 * k)] = turn.re;
            basis[(sample, 2 + 2 * k)] = turn.im;
        }
    }
    Some(basis)
}

/// The normal equations of the linear coefficients.
fn regular(basis: &DMatrix<f64>) -> DMatrix<f64> {
    let mut normal = basis.tr_mul(basis);
    // Regularisation at the level of rounding: nearly equal columns must not stop the descent.
    let small = 1e-13 * normal.trace();
    for k in 0..normal.nrows() {
        normal[(k, k)] += small;
    }
    normal
}

/// The linear coefficients, one column for each axis.
pub fn project(basis: &DMatrix<f64>, values: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    Some(regular(basis).cholesky()?.solve(&basis.tr_mul(values)))
}
