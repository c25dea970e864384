//! The density of modes that something excites, and its derivatives.
//!
//! `S(f) = (f / f_0)^p |d + sum_k (c_k + j r_k e_k) / (1 - r_k^2 + 2 j xi_k r_k)|^2 + n`, `r_k = f / f_k`: see
//! [resonances](super::resonances).

use nalgebra::Complex;

/// Number of unknowns besides the modes (direct term, logarithm of the noise, power of the frequency), and of a mode
/// (logarithm of the frequency, logit of the damping ratio over the largest, two amplitudes).
pub const SHARED: usize = 3;
pub const EACH: usize = 4;
/// Largest damping ratio of a mode: above it a response has no peak.
pub const DRIFT: f64 = 0.7;
/// Range of the power: from a little less than a constant acceleration to a constant displacement. Four less
/// gives the same spectrum with other amplitudes: a force that drives a mass instead of a moving base.
pub const POWERS: [f64; 2] = [-1.0, 4.0];

/// A resonance.
#[derive(Clone, Copy, Debug)]
pub struct Resonance {
    /// Natural frequency, Hz.
    pub frequency: f64,
    /// Damping ratio.
    pub ratio: f64,
    /// Amplitudes `c` and `e`.
    pub amplitudes: [f64; 2],
}

impl Resonance {
    /// From its unknowns. Of a sweep's normal modes the second amplitude follows from the first.
    pub fn at(unknowns: &[f64], is_sweep: bool) -> Self {
        let (frequency, ratio) = (unknowns[0].exp(), DRIFT / (1.0 + (-unknowns[1]).exp()));
        let turned = match is_sweep {
            true => 2.0 * ratio * unknowns[2],
            false => unknowns[3],
        };
        Self {
            frequency,
            ratio,
            amplitudes: [unknowns[2], turned],
        }
    }

    /// The response at a frequency, Hz.
    fn response(&self, frequency: f64) -> Complex<f64> {
        let r = frequency / self.frequency;
        let [straight, turned] = self.amplitudes;
        Complex::new(straight, r * turned) / Complex::new(1.0 - r * r, 2.0 * self.ratio * r)
    }

    /// Derivatives of the response after its unknowns.
    fn slopes(&self, frequency: f64, is_sweep: bool) -> [Complex<f64>; EACH] {
        let r = frequency / self.frequency;
        let [straight, turned] = self.amplitudes;
        let one = Complex::new(1.0 - r * r, 2.0 * self.ratio * r).inv();
        let response = one * Complex::new(straight, r * turned);
        let by_r =
            one * (Complex::new(0.0, turned) - response * Complex::new(-2.0 * r, 2.0 * self.ratio));
        let by_turned = one * Complex::new(0.0, r);
        let mut by_ratio = -one * response * Complex::new(0.0, 2.0 * r);
        let mut by_straight = one;
        if is_sweep {
            by_ratio += by_turned * 2.0 * straight;
            by_straight += by_turned * 2.0 * self.ratio;
        }
        let by_turned = if is_sweep {
            Complex::new(0.0, 0.0)
        } else {
            by_turned
        };
        let logit = self.ratio * (1.0 - self.ratio / DRIFT);
        [-by_r * r, by_ratio * logit, by_straight, by_turned]
    }
}

/// The density of a model.
pub struct Response {
    direct: f64,
    noise: f64,
    /// Power of the frequency of what excites, and whether it is inside its range.
    power: f64,
    is_inside: bool,
    is_sweep: bool,
    resonances: Vec<Resonance>,
}

impl Response {
    /// From its unknowns: direct term, logarithm of the noise, power of the frequency, and those of each mode.
    pub fn at(unknowns: &[f64], is_sweep: bool) -> Self {
        let power = unknowns[2].clamp(POWERS[0], POWERS[1]);
        let modes = unknowns[SHARED..].chunks_exact(EACH);
        Self {
            direct: unknowns[0],
            noise: unknowns[1].exp(),
            power: if is_sweep { power } else { 0.0 },
            is_inside: is_sweep && power == unknowns[2],
            is_sweep,
            resonances: modes.map(|own| Resonance::at(own, is_sweep)).collect(),
        }
    }

    fn response(&self, frequency: f64) -> Complex<f64> {
        let direct = Complex::new(self.direct, 0.0);
        self.resonances
            .iter()
            .fold(direct, |sum, own| sum + own.response(frequency))
    }

    fn excited(&self, logarithm: f64) -> f64 {
        if self.power == 0.0 {
            1.0
        } else {
            (self.power * logarithm).exp()
        }
    }

    /// The density at a frequency, Hz, whose ratio to the middle has this logarithm.
    pub fn density(&self, frequency: f64, logarithm: f64) -> f64 {
        self.excited(logarithm) * self.response(frequency).norm_sqr() + self.noise
    }

    /// Derivatives of the density after the unknowns.
    pub fn slopes(&self, frequency: f64, logarithm: f64, slopes: &mut [f64]) {
        let (excited, response) = (self.excited(logarithm), self.response(frequency));
        // Of `|H|^2` it is twice the real part of the conjugate times the derivative of `H`.
        let twice = response.conj() * 2.0 * excited;
        slopes[0] = twice.re;
        slopes[1] = self.noise;
        slopes[2] = match self.is_inside {
            true => logarithm * excited * response.norm_sqr(),
            false => 0.0,
        };
        let each = slopes[SHARED..].chunks_exact_mut(EACH);
        for (slopes, own) in each.zip(&self.resonances) {
            let all = own.slopes(frequency, self.is_sweep);
            for (slope, by) in slopes.iter_mut().zip(all) {
                *slope = twice.re * by.re - twice.im * by.im;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes are those of central differences, of a sweep and of a machine at work, on and beside a peak.
    #[test]
    fn slopes_of_the_density() {
        let at = [0.7, -2.0, 1.3, 3.0, -1.5, 0.4, -0.2, 3.4, -2.5, -0.3, 0.6];
        for (is_sweep, frequency) in [true, false]
            .into_iter()
            .flat_map(|s| [7.0, 20.1, 29.0].map(|f| (s, f)))
        {
            let logarithm = (frequency / 15.0_f64).ln();
            let mut slopes = [0.0; 11];
            Response::at(&at, is_sweep).slopes(frequency, logarithm, &mut slopes);
            for (k, slope) in slopes.into_iter().enumerate() {
                let beside = |by: f64| {
                    let mut at = at;
                    at[k] += by;
                    Response::at(&at, is_sweep).density(frequency, logarithm)
                };
                let difference = (beside(1e-6) - beside(-1e-6)) / 2e-6;
                assert!(
                    (difference - slope).abs() < 1e-7 * (1.0 + slope.abs()),
                    "{k}: {slope}, {difference}"
                );
            }
        }
    }
}
