//! The response of one mode to a sampled input, with its sensitivities, in exact steps.
//!
//! With `lambda = -xi w + j w_d` and `z' = lambda z + u`, the link's position (damper to ground) is
//! `q = (w^2 / w_d) Im z` and its velocity `q' = (w^2 / w_d) Im(lambda z)`; the damper across the
//! joint adds `(2 xi / w) q'`. As `z` is holomorphic in `lambda`, one more state `s = dz / dlambda`,
//! `s' = lambda s + z`, carries every sensitivity.

use nalgebra::Complex;
use quell_shapers::Mode;

/// Length of a [`ModalResponse::row`]: the columns below and a 0, since processors handle pairs of numbers.
pub const WIDTH: usize = 14;
/// Index of `dq / d ln w`, followed by `dq / d xi`.
pub const LINK: usize = 0;
/// Index of `dq' / d ln w`, followed by `dq' / d xi`.
pub const RATE: usize = 2;
/// Index of `Re t e^(lambda t)`, followed by its imaginary part.
pub const FREE_SLOPE: usize = 4;
/// Index of `Re e^(lambda t)`, followed by its imaginary part; the first of the six linear unknowns.
pub const FREE: usize = 6;
/// Index of the constant 1.
pub const OFFSET: usize = 8;
/// Index of `q'`: a clock's offset, or the damper across the joint.
pub const VELOCITY: usize = 9;
/// Index of `q - u`: the deformation's scale.
pub const DEFORMATION: usize = 10;
/// Index of `u`: the static gain.
pub const INPUT: usize = 11;
/// Index of the measured deformation minus `q - u`.
pub const RESIDUAL: usize = 12;

/// The last stamps and inputs, as needed for a parabola through three samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interval {
    /// Input at the interval's start.
    pub start: f64,
    /// Input at its end.
    pub end: f64,
    /// Its length, s.
    pub step: f64,
    /// Input one sample before its start.
    pub before: f64,
    /// Length of the interval before, s; 0 where there is none.
    pub step_before: f64,
}

impl Interval {
    /// Coefficients of the parabola `u0 + u1 tau + u2 tau^2` on this interval.
    ///
    /// A straight line if there is no interval before, or if the lengths differ so much that the parabola would
    /// extrapolate noise.
    pub fn parabola(&self) -> [f64; 3] {
        parabola(self.start, self.bend(), self.step)
    }

    /// Slope of the chord, and the parabola's `u2`.
    pub fn bend(&self) -> [f64; 2] {
        let slope = (self.end - self.start) / self.step;
        let ratio = self.step_before / self.step;
        if !(0.25..=4.0).contains(&ratio) {
            return [slope, 0.0];
        }
        let slope_before = (self.start - self.before) / self.step_before;
        [
            slope,
            (slope - slope_before) / (self.step + self.step_before),
        ]
    }
}

/// Coefficients of an input from its value at the start of an interval, its [`Interval::bend`] and its length.
#[inline]
pub fn parabola(start: f64, [slope, curvature]: [f64; 2], step: f64) -> [f64; 3] {
    [start, slope - curvature * step, curvature]
}

/// `phi_k(x) = sum_j x^j / (j + k)!` for k = 0..=3 and their derivatives, `phi_0 = exp`.
fn phi(x: Complex<f64>) -> ([Complex<f64>; 4], [Complex<f64>; 4]) {
    let one = Complex::new(1.0, 0.0);
    let inverse_factorial = [1.0, 1.0, 0.5, 1.0 / 6.0];
    let mut value = [one; 4];
    let mut slope = [one; 4];
    if x.norm_sqr() > 16.0 {
        // Upwards the recursion divides by x: stable only where x is large.
        value[0] = x.exp();
        slope[0] = value[0];
        for k in 1..4 {
            value[k] = (value[k - 1] - inverse_factorial[k - 1]) / x;
            slope[k] = (slope[k - 1] - value[k]) / x;
        }
        return (value, slope);
    }
    let mut term = one / 6.0;
    value[3] = term;
    slope[3] = Complex::new(0.0, 0.0);
    // |x| <= 4: the 40th term is below 1e-17 of the sum.
    for j in 1..40 {
        let next = term / f64::from(j + 3);
        slope[3] += next * f64::from(j);
        term = next * x;
        value[3] += term;
        if term.norm_sqr() < 1e-36 {
            break;
        }
    }
    for k in (0..3).rev() {
        value[k] = x * value[k + 1] + inverse_factorial[k];
        slope[k] = value[k + 1] + x * slope[k + 1];
    }
    (value, slope)
}

/// Exact weights of one step of length `step`.
#[derive(Clone, Copy, Debug)]
struct Weights {
    step: f64,
    growth: Complex<f64>,
    input: [Complex<f64>; 3],
    input_slope: [Complex<f64>; 3],
}

impl Weights {
    /// `int_0^h e^(lambda (h - tau)) tau^n dtau = n! h^(n+1) phi_(n+1)(lambda h)`, n = 0, 1, 2.
    fn new(lambda: Complex<f64>, step: f64) -> Self {
        let (value, slope) = phi(lambda * step);
        let scale = [step, step * step, 2.0 * step * step * step];
        Self {
            step,
            growth: value[0],
            input: [
                value[1] * scale[0],
                value[2] * scale[1],
                value[3] * scale[2],
            ],
            input_slope: [
                slope[1] * (scale[0] * step),
                slope[2] * (scale[1] * step),
                slope[3] * (scale[2] * step),
            ],
        }
    }
}

/// State and sensitivities of one mode driven by the motor side.
#[derive(Clone, Copy, Debug)]
pub struct ModalResponse {
    lambda: Complex<f64>,
    lambda_slopes: [Complex<f64>; 2],
    /// `w^2 / w_d` and its derivatives by `ln w` and `xi`.
    amplitude: f64,
    amplitude_slopes: [f64; 2],
    weights: Weights,
    state: Complex<f64>,
    sensitivity: Complex<f64>,
    free: Complex<f64>,
    free_slope: Complex<f64>,
    time: f64,
}

impl ModalResponse {
    /// A mode at rest at `u = 0`, to be advanced in steps near `step`.
    pub fn new(mode: Mode, step: f64) -> Self {
        let w = mode.natural_frequency();
        let xi = mode.damping_ratio();
        let root = (1.0 - xi * xi).sqrt();
        let lambda = Complex::new(-xi * w, w * root);
        let amplitude = w / root;
        let zero = Complex::new(0.0, 0.0);
        Self {
            lambda,
            lambda_slopes: [lambda, Complex::new(-w, -w * xi / root)],
            amplitude,
            amplitude_slopes: [amplitude, amplitude * xi / (root * root)],
            weights: Weights::new(lambda, step),
            state: zero,
            sensitivity: zero,
            free: Complex::new(1.0, 0.0),
            free_slope: zero,
            time: 0.0,
        }
    }

    /// `d lambda / d ln w` and `d lambda / d xi`.
    pub fn lambda_slopes(&self) -> [Complex<f64>; 2] {
        self.lambda_slopes
    }

    /// Restarts at rest; the present vibration is left to the free columns.
    pub fn restart(&mut self) {
        let zero = Complex::new(0.0, 0.0);
        (self.state, self.sensitivity, self.free_slope) = (zero, zero, zero);
        self.free = Complex::new(1.0, 0.0);
        self.time = 0.0;
    }

    /// Advances over one interval of length `step` (s) with the input [`Interval::parabola`].
    ///
    /// The weights of the step are computed again only if its length changes by more than 1e-6 of itself. After
    /// a thousand steps that causes a phase error of a thousandth of a step.
    #[inline]
    pub fn advance(&mut self, step: f64, parabola: &[f64; 3]) {
        if (step - self.weights.step).abs() > 1e-6 * self.weights.step {
            self.weights = Weights::new(self.lambda, step);
        }
        let weights = &self.weights;
        let h = weights.step;
        let mut forced = Complex::new(0.0, 0.0);
        let mut forced_slope = Complex::new(0.0, 0.0);
        for (n, &coefficient) in parabola.iter().enumerate() {
            forced += weights.input[n] * coefficient;
            forced_slope += weights.input_slope[n] * coefficient;
        }
        self.sensitivity = weights.growth * (self.sensitivity + self.state * h) + forced_slope;
        self.state = weights.growth * self.state + forced;
        self.free *= weights.growth;
        self.time += step;
        self.free_slope = self.free * self.time;
    }

    /// The row of one sample for this mode: sensitivities, nuisance columns, residual.
    pub fn row(&self, input: f64, deformation: f64) -> [f64; WIDTH] {
        let rate = self.lambda * self.state;
        let rate_slope = self.state + self.lambda * self.sensitivity;
        let modelled = self.amplitude * self.state.im - input;
        let mut row = [0.0; WIDTH];
        for k in 0..2 {
            let direction = self.lambda_slopes[k];
            row[LINK + k] = self.amplitude_slopes[k] * self.state.im
                + self.amplitude * (direction * self.sensitivity).im;
            row[RATE + k] =
                self.amplitude_slopes[k] * rate.im + self.amplitude * (direction * rate_slope).im;
        }
        row[FREE] = self.free.re;
        row[FREE + 1] = self.free.im;
        row[FREE_SLOPE] = self.free_slope.re;
        row[FREE_SLOPE + 1] = self.free_slope.im;
        row[OFFSET] = 1.0;
        row[VELOCITY] = self.amplitude * rate.im;
        row[DEFORMATION] = modelled;
        row[INPUT] = input;
        row[RESIDUAL] = deformation - modelled;
        row
    }
}
