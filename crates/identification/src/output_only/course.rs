//! The complex amplitude of one mode over its decays, once each half period.
//!
//! Over a half period the cosine and the sine of a mode are orthogonal, and a force acts on both alike: there its amplitude is
//! found by least squares, beside the other modes of the fit.

use super::damped::{Damped, Fit, Segment, basis};
use nalgebra::{Complex, DMatrix};

/// Fewest samples of a half period: one more than the two parts of an amplitude.
const FEWEST: usize = 3;

/// The amplitude in one decay, along its strongest axis.
pub struct Course {
    /// Real and imaginary parts, at the start of each half period.
    pub amplitudes: [Vec<f64>; 2],
    /// The ratio by which the mode's law falls over each.
    pub falls: Vec<f64>,
    /// The time from one to the next, s.
    pub span: f64,
    /// By the fit, the square of the amplitude at the start.
    pub start: f64,
}

impl Course {
    /// Number of values.
    pub fn count(&self) -> usize {
        2 * self.falls.len()
    }

    /// The law at the start of each half period, over its start.
    pub fn law(&self) -> Vec<f64> {
        let next = |now: &mut f64, fall: &f64| Some(std::mem::replace(now, *now * fall));
        self.falls.iter().scan(1.0, next).collect()
    }

    /// The sum of the squares of the law over its start. After the decay it goes on at the rate of small amplitudes.
    pub fn kept_up(&self, own: &Damped) -> f64 {
        let law = self.law();
        let seen: f64 = law.iter().map(|own| own * own).sum();
        let last = law.last().zip(self.falls.last());
        let after = last.map_or(1.0, |(law, fall)| (law * fall).powi(2));
        seen + after / -(-2.0 * own.rate * self.span).exp_m1()
    }
}

/// The courses of a mode in all decays, beside those of the other modes that are `taken` out. `linear` has the amplitudes of
/// the fit in each.
pub fn courses(
    (fit, segments, linear): (&Fit, &[Segment], &[DMatrix<f64>]),
    own: &Damped,
    taken: &dyn Fn(&Damped) -> bool,
) -> Option<Vec<Course>> {
    let of = |(segment, linear)| course((fit, segment), linear, own, taken);
    segments.iter().zip(linear).map(of).collect()
}

fn course(
    (fit, segment): (&Fit, &Segment),
    linear: &DMatrix<f64>,
    own: &Damped,
    taken: &dyn Fn(&Damped) -> bool,
) -> Option<Course> {
    let place = fit.modes.iter().position(|other| other == own)?;
    let square = |axis: usize| linear.column(axis).rows(1 + 2 * place, 2).norm_squared();
    let axis = (0..linear.ncols()).max_by(|a, b| square(*a).total_cmp(&square(*b)))?;
    let mut others = linear.column(axis).into_owned();
    for (k, other) in fit.modes.iter().enumerate() {
        if k == place || !taken(other) {
            others.rows_mut(1 + 2 * k, 2).fill(0.0);
        }
    }
    let values = segment.values.column(axis) - basis(segment, &fit.modes)? * others;
    let law: Vec<Complex<f64>> = own.over(segment.period).take(values.len() + 1).collect();
    let half = std::f64::consts::PI / (own.frequency * segment.period);
    let half = (half.round() as usize).max(FEWEST);
    let mut found = Course {
        amplitudes: [Vec::new(), Vec::new()],
        falls: Vec::new(),
        span: half as f64 * segment.period,
        start: square(axis),
    };
    for first in (0..(values.len() / half) * half).step_by(half) {
        // A mode at rest stays there.
        let size = law[first].norm();
        let Some(amplitude) = amplitude(&law[first..first + half], &values.as_slice()[first..])
        else {
            break;
        };
        found.amplitudes[0].push(amplitude.re * size);
        found.amplitudes[1].push(amplitude.im * size);
        found.falls.push(law[first + half].norm() / size);
    }
    Some(found)
}

/// The complex amplitude whose real part, times a law, is nearest to some values; `None` where the law is at rest, or its cosine and sine
/// are one to rounding.
///
/// The determinant over the product of the diagonal is the square of the sine of the angle between both. The normal equations lose as
/// many digits as its reciprocal has; from `sqrt(epsilon)` on half of a double's are left.
///
/// Source: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. 2013, section 5.3.
fn amplitude(law: &[Complex<f64>], values: &[f64]) -> Option<Complex<f64>> {
    let (mut cc, mut cs, mut ss, mut cy, mut sy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (z, y) in law.iter().zip(values) {
        let (c, s) = (z.re, -z.im);
        cc += c * c;
        cs += c * s;
        ss += s * s;
        cy += c * y;
        sy += s * y;
    }
    let determinant = cc * ss - cs * cs;
    (determinant > f64::EPSILON.sqrt() * cc * ss)
        .then(|| Complex::new(ss * cy - cs * sy, cc * sy - cs * cy) / determinant)
}
