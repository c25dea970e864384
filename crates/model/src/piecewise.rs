//! The input of a chain between the nodes of the integration grid: one cubic a step.

use nalgebra::{Matrix4, Vector4};
use quell_signal::{CubicSpline, End, SignalError, check_knots};

/// Radians of the fastest mode in a step. With 0.25 the classical Runge-Kutta method errs by
/// `0.25^4 / 120 = 3e-5` of the frequency, a tenth of what the best recordings determine, and by
/// `0.25^5 / 144 = 7e-6` of the damping ratio.
pub const RADIANS_A_STEP: f64 = 0.25;

/// `c_0 + c_1 s + c_2 s^2 + c_3 s^3`, `s` seconds after the start of the step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cubic(pub [f64; 4]);

impl Cubic {
    /// The cubic through values and rates at two ends, `h` seconds apart, from the first on; a line where they coincide.
    pub(super) fn through(h: f64, [value, rate]: [f64; 2], [end, end_rate]: [f64; 2]) -> Self {
        if h == 0.0 {
            return Self([value, rate, 0.0, 0.0]);
        }
        let slope = (end - value) / h;
        let square = (3.0 * slope - 2.0 * rate - end_rate) / h;
        let third = (rate + end_rate - 2.0 * slope) / (h * h);
        Self([value, rate, square, third])
    }

    /// Value, first and second derivative.
    #[inline]
    pub fn at(&self, s: f64) -> [f64; 3] {
        let [c0, c1, c2, c3] = self.0;
        [
            c0 + s * (c1 + s * (c2 + s * c3)),
            c1 + s * (2.0 * c2 + s * 3.0 * c3),
            2.0 * c2 + s * 6.0 * c3,
        ]
    }

    /// Its turning points between two instants, in their order: the roots of its rate.
    pub fn turns(&self, from: f64, to: f64) -> impl Iterator<Item = f64> + use<> {
        let [_, c, b, a] = self.0;
        let (a, b) = (3.0 * a, 2.0 * b);
        // For each root the form without cancellation. Without roots the value is NaN, which is never inside.
        let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
        let mut roots = [q / a, c / q];
        roots.sort_by(f64::total_cmp);
        roots
            .into_iter()
            .filter(move |root| *root > from && *root < to)
    }

    /// The same polynomial, starting at `s`.
    pub(super) fn shifted(&self, s: f64) -> Self {
        let [value, rate, second] = self.at(s);
        Self([value, rate, second / 2.0, self.0[3]])
    }
}

/// The course of an input between its samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// Twice differentiable: positions, and band-limited forces.
    Spline,
    /// Straight lines.
    Linear,
    /// The value stays until the next sample: what a controller puts out.
    ZeroOrder,
    /// A spline through local cubics, at a spacing of about so many seconds, for positions that were sampled
    /// more densely than their motion needs.
    Smooth(f64),
    /// The mean over about so many seconds, for a force on dynamics that are slow beside its samples.
    Mean(f64),
}

/// Most nodes of a grid: 0.8 GB.
const MOST: f64 = 2e7;

/// Nodes of the integration and the input between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Node times, s, strictly increasing; n + 1 of them.
    pub time: Vec<f64>,
    /// The input after each node but the last; n.
    pub input: Vec<Cubic>,
}

impl Grid {
    /// The samples of an input, each interval divided into equal steps of at most `step` seconds.
    ///
    /// # Errors
    /// [`SignalError`] for fewer than two samples, values that are not finite, times that do not
    /// advance, and more than 2e7 nodes.
    pub fn new(time: &[f64], values: &[f64], hold: Hold, step: f64) -> Result<Self, SignalError> {
        check_knots(time, values)?;
        short_enough(time, hold, step)?;
        if let Hold::Smooth(spacing) = hold {
            let (time, values) = smooth(time, values, spacing);
            return Self::new(&time, &values, Hold::Spline, step);
        }
        if let Hold::Mean(spacing) = hold {
            let (time, values) = means(time, values, spacing);
            return Self::new(&time, &values, Hold::ZeroOrder, step);
        }
        let spline = match hold {
            Hold::Linear | Hold::ZeroOrder => None,
            _ => Some(CubicSpline::new(time, values, End::NotAKnot)?),
        };
        let mut grid = Self {
            time: Vec::with_capacity(time.len()),
            input: Vec::with_capacity(time.len()),
        };
        grid.time.push(time[0]);
        for k in 0..time.len() - 1 {
            let (t0, h) = (time[k], time[k + 1] - time[k]);
            let slope = (values[k + 1] - values[k]) / h;
            let whole = match &spline {
                Some(spline) => {
                    let (m0, m1) = (spline.second(k), spline.second(k + 1));
                    let rate = slope - h * (2.0 * m0 + m1) / 6.0;
                    Cubic([values[k], rate, m0 / 2.0, (m1 - m0) / (6.0 * h)])
                }
                None if hold == Hold::Linear => Cubic([values[k], slope, 0.0, 0.0]),
                None => Cubic([values[k], 0.0, 0.0, 0.0]),
            };
            // A hair below the quotient, so that an exact multiple is not divided further.
            let parts = (h / step * (1.0 - 1e-9)).ceil().max(1.0) as usize;
            for part in 0..parts {
                let s = h * part as f64 / parts as f64;
                grid.input.push(whole.shifted(s));
                let end = h * (part + 1) as f64 / parts as f64;
                grid.time.push(if part + 1 == parts {
                    time[k + 1]
                } else {
                    t0 + end
                });
            }
        }
        Ok(grid)
    }

    /// The longest step, s.
    pub fn step(&self) -> f64 {
        let steps = self.time.windows(2).map(|w| w[1] - w[0]);
        steps.fold(0.0, f64::max)
    }
}

/// Refuses stamps over which there would be more than [`MOST`] nodes.
fn short_enough(time: &[f64], hold: Hold, step: f64) -> Result<(), SignalError> {
    let spacing = match hold {
        Hold::Smooth(spacing) | Hold::Mean(spacing) => spacing.min(step),
        _ => step,
    };
    let steps = (time[time.len() - 1] - time[0]) / spacing;
    if steps <= MOST {
        return Ok(());
    }
    let pause = |pair: &[f64]| pair[1] - pair[0];
    let longest = time.windows(2).max_by(|a, b| pause(a).total_cmp(&pause(b)));
    let [before, after] = longest.map_or([time[0]; 2], |pair| [pair[0], pair[1]]);
    Err(SignalError::TooLong {
        what: "the input",
        before,
        after,
        steps,
        most: MOST,
    })
}

/// Stamps at about this spacing, with the first and the last, and the mean of an input from each to the next. A force and its mean
/// have the same effect on slow dynamics.
fn means(time: &[f64], values: &[f64], spacing: f64) -> (Vec<f64>, Vec<f64>) {
    let knots = spaced(time, spacing);
    let mean = |pair: &[usize]| {
        let own = pair[0]..pair[1];
        let whole: f64 = own.map(|k| values[k] * (time[k + 1] - time[k])).sum();
        whole / (time[pair[1]] - time[pair[0]])
    };
    let mut means: Vec<f64> = knots.windows(2).map(mean).collect();
    means.extend(values.last());
    (knots.iter().map(|&knot| time[knot]).collect(), means)
}

/// What means over a spacing leave out of an input, as a share of its standard deviation; 0 of a constant one.
pub(super) fn left_out(time: &[f64], values: &[f64], spacing: f64) -> f64 {
    let variance = |values: &[f64]| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>()
    };
    let knots = spaced(time, spacing);
    let within: f64 = knots
        .windows(2)
        .map(|pair| variance(&values[pair[0]..pair[1]]))
        .sum();
    let whole = variance(values);
    if whole > 0.0 {
        (within / whole).sqrt()
    } else {
        0.0
    }
}

/// Stamps at about this spacing, with the first and the last, and at each the value of the cubic fitted to the
/// samples within one spacing. The noise is reduced as in a slower sensor that averages.
///
/// Source: Savitzky and Golay, Analytical Chemistry 36 (1964); here for stamps that need not be regular.
pub(super) fn smooth(time: &[f64], values: &[f64], spacing: f64) -> (Vec<f64>, Vec<f64>) {
    let knots = spaced(time, spacing);
    let near = |&knot: &usize| local_cubic(time, values, knot, spacing);
    (
        knots.iter().map(|&knot| time[knot]).collect(),
        knots.iter().map(near).collect(),
    )
}

/// Indices of the stamps nearest to a regular spacing, with the first and the last.
fn spaced(time: &[f64], spacing: f64) -> Vec<usize> {
    let last = time.len().saturating_sub(1);
    let (mut knots, mut at) = (Vec::new(), 0);
    while at < last {
        knots.push(at);
        let next = time[at] + spacing;
        let after = time.partition_point(|t| *t < next).clamp(at + 1, last);
        let before_is_nearer = next - time[after - 1] < time[after] - next;
        at = if after > at + 1 && before_is_nearer {
            after - 1
        } else {
            after
        };
    }
    knots.push(last);
    knots
}

/// Value at a stamp of the cubic fitted to the samples within a step of it; the sample itself where there are
/// no more than the cubic needs.
fn local_cubic(time: &[f64], values: &[f64], at: usize, step: f64) -> f64 {
    let from = time.partition_point(|t| *t < time[at] - step);
    let to = time.partition_point(|t| *t <= time[at] + step);
    if to - from < 5 {
        return values[at];
    }
    let (mut normal, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for k in from..to {
        let s = (time[k] - time[at]) / step;
        let row = Vector4::new(1.0, s, s * s, s * s * s);
        normal += row * row.transpose();
        // Relative to the sample itself, so that a large position loses no digits.
        right += row * (values[k] - values[at]);
    }
    let solved = normal.cholesky().map(|c| c.solve(&right)[0]);
    values[at] + solved.filter(|v| v.is_finite()).unwrap_or(0.0)
}
