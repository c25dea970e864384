//! Running integrals of sampled signals.

/// Running integral of a sampled signal, by the parabola through the last three samples.
///
/// With equal steps an interval counts `h (5 f_1 + 8 f_0 - f_-1) / 12`, exact to second degree;
/// a trapezoid where there is no interval before, or one unlike in length (gap). O(1) a sample.
///
/// # Example
/// ```
/// use quell_control::estimators::Integral;
/// let mut integral = Integral::default();
/// for k in 0..=100 {
///     let t = k as f64 * 0.01;
///     integral.push(t * t, if k == 0 { 0.0 } else { 0.01 });
/// }
/// // The parabola is exact but for the first trapezoid, h^3 / 6.
/// assert!((integral.value() - 1.0 / 3.0).abs() < 2e-7);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct Integral {
    value: f64,
    last: f64,
    before: f64,
    step_before: f64,
}

impl Integral {
    /// Takes the next sample, `step` seconds after the one before (0 for the first).
    pub fn push(&mut self, sample: f64, step: f64) -> f64 {
        if step > 0.0 {
            self.value += 0.5 * step * (self.last + sample);
            let ratio = self.step_before / step;
            if (0.25..=4.0).contains(&ratio) {
                let slope = (sample - self.last) / step;
                let slope_before = (self.last - self.before) / self.step_before;
                // The trapezoid errs by h^3 / 6 times the second divided difference.
                let curvature = (slope - slope_before) / (step + self.step_before);
                self.value -= curvature * step * step * step / 6.0;
            }
        }
        self.before = self.last;
        self.last = sample;
        self.step_before = step;
        self.value
    }

    /// The integral up to the last sample.
    pub fn value(&self) -> f64 {
        self.value
    }
}
