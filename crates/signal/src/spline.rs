//! Cubic spline through samples, for off-line interpolation.

use super::SignalError;

/// The condition at the two ends of a spline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Second derivative 0 at the ends.
    Natural,
    /// Third derivative continuous at the second and the last but one knot: reproduces a cubic.
    NotAKnot,
}

/// The twice differentiable piecewise cubic through `(t_k, x_k)`.
///
/// Interpolation error of the order of `h^4 x''''` inside. Beyond the ends the outermost cubic
/// continues. Evaluation takes `log n` steps and does not allocate.
///
/// # Example
/// ```
/// use quell_signal::{CubicSpline, End};
/// let t = [0.0, 1.0, 2.0, 4.0, 5.0];
/// let spline = CubicSpline::new(&t, &t.map(|t| t * t * t), End::NotAKnot).unwrap();
/// assert!((spline.value(3.0) - 27.0).abs() < 1e-12);
/// assert!((spline.derivative(3.0) - 27.0).abs() < 1e-12);
/// ```
///
/// Source: de Boor, "A Practical Guide to Splines", chapter IV.
#[derive(Clone, Debug, PartialEq)]
pub struct CubicSpline {
    time: Vec<f64>,
    values: Vec<f64>,
    second: Vec<f64>,
}

impl CubicSpline {
    /// A spline through samples at strictly increasing times; not-a-knot needs 4 of them and is
    /// natural with fewer.
    ///
    /// # Errors
    /// [`SignalError`] for fewer than 2 samples, different lengths, a value that is not finite or a
    /// time that does not advance.
    pub fn new(time: &[f64], values: &[f64], end: End) -> Result<Self, SignalError> {
        check_knots(time, values)?;
        let second = second_derivatives(time, values, end);
        Ok(Self {
            time: time.to_vec(),
            values: values.to_vec(),
            second,
        })
    }

    /// First and last knot, s.
    pub fn span(&self) -> (f64, f64) {
        (self.time[0], self.time[self.time.len() - 1])
    }

    /// Knots, s.
    pub fn knots(&self) -> &[f64] {
        &self.time
    }

    /// `x(t)`.
    pub fn value(&self, time: f64) -> f64 {
        let (k, s, h) = self.locate(time);
        let (m0, m1) = (self.second[k], self.second[k + 1]);
        let slope = self.slope(k, h);
        self.values[k] + s * (slope + s * (m0 / 2.0 + s * (m1 - m0) / (6.0 * h)))
    }

    /// `x'(t)`.
    pub fn derivative(&self, time: f64) -> f64 {
        let (k, s, h) = self.locate(time);
        let (m0, m1) = (self.second[k], self.second[k + 1]);
        self.slope(k, h) + s * (m0 + s * (m1 - m0) / (2.0 * h))
    }

    /// `x''(t)`, piecewise linear.
    pub fn second_derivative(&self, time: f64) -> f64 {
        let (k, s, h) = self.locate(time);
        self.second[k] + s * (self.second[k + 1] - self.second[k]) / h
    }

    /// Second derivative at knot `k`.
    pub fn second(&self, k: usize) -> f64 {
        self.second[k]
    }

    /// Interval, time into it, its length.
    pub(super) fn locate(&self, time: f64) -> (usize, f64, f64) {
        let last = self.time.len() - 1;
        let share = (time - self.time[0]) / (self.time[last] - self.time[0]);
        // With an even clock the guess is right; a share that is not finite becomes 0.
        let guess = ((share * last as f64) as usize).min(last - 1);
        let hit = self.time[guess] <= time && time < self.time[guess + 1];
        let k = match hit {
            true => guess,
            false => self.time.partition_point(|&t| t <= time).clamp(1, last) - 1,
        };
        (k, time - self.time[k], self.time[k + 1] - self.time[k])
    }

    /// First derivative at the start of interval `k`, whose length is `h`.
    pub(super) fn slope(&self, k: usize, h: f64) -> f64 {
        (self.values[k + 1] - self.values[k]) / h
            - h * (2.0 * self.second[k] + self.second[k + 1]) / 6.0
    }
}

/// Refuses what no curve goes through: fewer than 2 samples, and what [`CubicSpline::new`] refuses.
///
/// # Errors
/// [`SignalError`] with the first bad value and its index.
pub fn check_knots(time: &[f64], values: &[f64]) -> Result<(), SignalError> {
    check_series("spline", time, values)?;
    match time.len() < 2 {
        true => Err(SignalError::TooFew {
            what: "spline",
            found: time.len(),
            needed: 2,
        }),
        false => Ok(()),
    }
}

/// Refuses series of different lengths, values that are not finite, times that do not advance.
pub(super) fn check_series(
    what: &'static str,
    time: &[f64],
    values: &[f64],
) -> Result<(), SignalError> {
    if time.len() != values.len() {
        return Err(SignalError::Lengths {
            what,
            left: time.len(),
            right: values.len(),
        });
    }
    for (index, &value) in values.iter().enumerate() {
        if !value.is_finite() {
            return Err(SignalError::NotFinite { what, index, value });
        }
    }
    for (index, &time_now) in time.iter().enumerate() {
        if !time_now.is_finite() {
            return Err(SignalError::NotFinite {
                what,
                index,
                value: time_now,
            });
        }
        if index > 0 && time_now <= time[index - 1] {
            return Err(SignalError::TimeOrder {
                what,
                index,
                time: time_now,
            });
        }
    }
    Ok(())
}

/// Solves the tridiagonal system of the second derivatives.
fn second_derivatives(t: &[f64], x: &[f64], end: End) -> Vec<f64> {
    let n = t.len();
    let mut second = vec![0.0; n];
    if n < 3 {
        return second;
    }
    let not_a_knot = end == End::NotAKnot && n >= 4;
    let h: Vec<f64> = t.windows(2).map(|w| w[1] - w[0]).collect();
    let slope: Vec<f64> = x
        .windows(2)
        .zip(&h)
        .map(|(w, h)| (w[1] - w[0]) / h)
        .collect();
    // Row i (1 <= i <= n - 2): lower M_{i-1} + diagonal M_i + upper M_{i+1} = right.
    let mut diagonal: Vec<f64> = h.windows(2).map(|w| 2.0 * (w[0] + w[1])).collect();
    let mut right: Vec<f64> = slope.windows(2).map(|w| 6.0 * (w[1] - w[0])).collect();
    let mut lower: Vec<f64> = h[..n - 2].to_vec();
    let mut upper: Vec<f64> = h[1..].to_vec();
    let (first, last) = (0, n - 3);
    if not_a_knot {
        // M_0 = (1 + r) M_1 - r M_2 with r = h_0 / h_1, and likewise at the other end.
        let r = h[0] / h[1];
        diagonal[first] += h[0] * (1.0 + r);
        upper[first] -= h[0] * r;
        let r = h[n - 2] / h[n - 3];
        diagonal[last] += h[n - 2] * (1.0 + r);
        lower[last] -= h[n - 2] * r;
    }
    for i in 1..=last {
        let factor = lower[i] / diagonal[i - 1];
        diagonal[i] -= factor * upper[i - 1];
        right[i] -= factor * right[i - 1];
    }
    second[last + 1] = right[last] / diagonal[last];
    for i in (0..last).rev() {
        second[i + 1] = (right[i] - upper[i] * second[i + 2]) / diagonal[i];
    }
    if not_a_knot {
        let r = h[0] / h[1];
        second[0] = (1.0 + r) * second[1] - r * second[2];
        let r = h[n - 2] / h[n - 3];
        second[n - 1] = (1.0 + r) * second[n - 2] - r * second[n - 3];
    }
    second
}
