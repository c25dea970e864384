//! What a coloured residual does to standard deviations.

/// Running first autocorrelation of the residual, which widens the standard deviations where the
/// model leaves more than white noise.
#[derive(Clone, Copy, Debug, Default)]
pub struct Correlation {
    last: f64,
    square: f64,
    product: f64,
    count: f64,
}

impl Correlation {
    /// Takes the next residual.
    pub fn observe(&mut self, residual: f64) {
        self.square += residual * residual;
        self.product += residual * self.last;
        self.last = residual;
        self.count += 1.0;
    }

    /// `(1 + rho) / (1 - rho)`, the variance inflation of a mean of AR(1) noise; 1 where `rho` is
    /// within two standard deviations (`1 / sqrt n`) of 0.
    pub fn inflation(&self) -> f64 {
        if self.count < 16.0 || self.square <= 0.0 {
            return 1.0;
        }
        let rho = (self.product / self.square).min(0.999);
        if rho < 2.0 / self.count.sqrt() {
            1.0
        } else {
            (1.0 + rho) / (1.0 - rho)
        }
    }
}
