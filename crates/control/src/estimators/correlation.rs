//! The effect of a coloured residual on standard deviations.

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
        let doubt = 2.0 / self.count.sqrt();
        match self.rho() {
            Some(rho) if rho >= doubt => inflation(rho),
            _ => 1.0,
        }
    }

    /// Part of the residual's variance that is not white. Neighbours are uncorrelated in white noise, and have
    /// a correlation near 1 in a vibration. 0 where `rho` is within two standard deviations of 0.
    pub fn coloured(&self) -> f64 {
        let doubt = 2.0 / self.count.sqrt();
        self.rho().filter(|rho| *rho >= doubt).unwrap_or(0.0)
    }

    /// The same with `rho` one standard deviation higher: an upper value for decisions that coloured noise must
    /// not cause. Infinite where there are too few samples.
    pub fn largest_inflation(&self) -> f64 {
        let doubt = self.count.sqrt().recip();
        self.rho()
            .map_or(f64::INFINITY, |rho| inflation((rho + doubt).max(0.0)))
    }

    fn rho(&self) -> Option<f64> {
        (self.count >= 16.0 && self.square > 0.0).then(|| self.product / self.square)
    }
}

fn inflation(rho: f64) -> f64 {
    let rho = rho.min(0.999);
    (1.0 + rho) / (1.0 - rho)
}
