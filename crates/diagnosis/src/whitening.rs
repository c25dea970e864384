//! Whitening of noise by an autoregressive filter, with a moving average where the noise has passed a resonance.

use rand::Rng;
use rand_distr::StandardNormal;

/// `e_t = (r_t - a_1 r_{t-1} - ... - a_p r_{t-p}) / sigma`, less what the moving average keeps of former ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Whitening {
    /// `a_1 ... a_p`; empty for white noise.
    pub coefficients: Vec<f64>,
    /// The moving average from the first sample on, the last for all that follow; empty for autoregressive noise.
    pub moving_average: Vec<Innovation>,
    /// Standard deviation of the innovation, in the unit of the values.
    pub innovation: f64,
    /// Standard deviation of the noise itself.
    pub deviation: f64,
    /// Whether all that is the noise of the differences of neighbouring values, whose sum has no level of its own.
    pub walks: bool,
}

/// A sample of a moving average: `u_t = s_t e_t + b_1 s_{t-1} e_{t-1} + ... + b_q s_{t-q} e_{t-q}`.
#[derive(Clone, Debug, PartialEq)]
pub struct Innovation {
    /// `b_1 ... b_q`; fewer where fewer samples came before.
    pub gains: Vec<f64>,
    /// `s_t`: standard deviation of what earlier samples do not tell, in the unit of the values.
    pub deviation: f64,
}

/// Samples after which a drawn series is independent of its start.
const WARM_UP: usize = 500;

/// Highest order that is tried. A second-order resonance of the sensor needs 2; mains hum and a
/// low-pass need some more.
const HIGHEST_ORDER: usize = 8;

impl Whitening {
    /// White noise of this standard deviation.
    pub fn white(deviation: f64) -> Self {
        Self {
            coefficients: Vec::new(),
            moving_average: Vec::new(),
            innovation: deviation,
            deviation,
            walks: false,
        }
    }

    /// Noise of one pole, with an innovation of this standard deviation.
    pub fn one_pole(pole: f64, innovation: f64) -> Self {
        Self {
            coefficients: vec![pole],
            moving_average: Vec::new(),
            innovation,
            deviation: innovation / (1.0 - pole * pole).sqrt(),
            walks: false,
        }
    }

    /// The same colour at a level that is this many times as high.
    pub fn louder(&self, times: f64) -> Self {
        Self {
            coefficients: self.coefficients.clone(),
            moving_average: self
                .moving_average
                .iter()
                .map(|own| own.louder(times))
                .collect(),
            innovation: times * self.innovation,
            deviation: times * self.deviation,
            walks: self.walks,
        }
    }

    /// Standard deviation that third differences of the noise give if it is taken for white: `sd(D^3 r) /
    /// sqrt(20)`.
    pub fn roughness(&self) -> f64 {
        let response = self.response();
        let at = |t: usize, lag: usize| t.checked_sub(lag).map_or(0.0, |t| response[t]);
        let third = |t| at(t, 0) - 3.0 * at(t, 1) + 3.0 * at(t, 2) - at(t, 3);
        let power: f64 = (0..WARM_UP).map(|t| third(t).powi(2)).sum();
        self.innovation * (power / 20.0).sqrt()
    }

    /// Response of the noise to an innovation of 1 at the first sample.
    pub fn response(&self) -> Vec<f64> {
        let mut response: Vec<f64> = Vec::with_capacity(WARM_UP);
        for t in 0..WARM_UP {
            let past = self.coefficients.iter().take(t).enumerate();
            let echo: f64 = past.map(|(k, a)| a * response[t - 1 - k]).sum();
            let own = match t {
                0 => 1.0,
                t => self.echoes().get(t - 1).copied().unwrap_or(0.0),
            };
            response.push(echo + own);
        }
        self.summed(&mut response);
        response
    }

    /// Sums values up in place, where these are differences.
    fn summed(&self, values: &mut [f64]) {
        for k in 1..if self.walks { values.len() } else { 0 } {
            values[k] += values[k - 1];
        }
    }

    /// `b_1 ... b_q` of the moving average far from the start.
    fn echoes(&self) -> &[f64] {
        self.moving_average.last().map_or(&[], |own| &own.gains)
    }

    /// The filter for stretches of noise: Yule-Walker by the Levinson-Durbin recursion, with the order of least
    /// BIC. White where the stretches are too short.
    ///
    /// Source: Brockwell and Davis, Time Series: Theory and Methods (1991), sections 8.2 and 9.3.
    pub fn fit(stretches: &[&[f64]]) -> Self {
        let count: usize = stretches.iter().map(|s| s.len()).sum();
        let highest = HIGHEST_ORDER.min(count / 40);
        let mut covariance = vec![0.0; highest + 1];
        for stretch in stretches {
            for (lag, sum) in covariance.iter_mut().enumerate() {
                let pairs = stretch.iter().zip(stretch.iter().skip(lag));
                *sum += pairs.map(|(a, b)| a * b).sum::<f64>();
            }
        }
        let n = count.max(1) as f64;
        let variance = covariance[0] / n;
        let mut best = Self::white(variance.sqrt());
        let mut best_score = n * variance.max(f64::MIN_POSITIVE).ln();
        let (mut a, mut error) = (Vec::<f64>::new(), covariance[0]);
        for order in 1..=highest {
            let past = a.iter().enumerate();
            let known: f64 = past.map(|(k, a)| a * covariance[order - 1 - k]).sum();
            let reflection = (covariance[order] - known) / error.max(f64::MIN_POSITIVE);
            let before = a.clone();
            for k in 0..a.len() {
                a[k] -= reflection * before[before.len() - 1 - k];
            }
            a.push(reflection);
            error *= 1.0 - reflection * reflection;
            let innovation = (error / n).max(f64::MIN_POSITIVE);
            let score = n * innovation.ln() + n.ln() * order as f64;
            if score < best_score {
                best_score = score;
                best = Self {
                    coefficients: a.clone(),
                    moving_average: Vec::new(),
                    innovation: innovation.sqrt(),
                    deviation: variance.sqrt(),
                    walks: false,
                };
            }
        }
        best
    }

    /// Mean square of values in units of the noise. Of a walk that is the mean square of the whitened values, since it has
    /// no level.
    pub fn power(&self, values: &[f64]) -> f64 {
        let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>();
        let all = match self.walks {
            true => {
                let mut rows = Vec::new();
                self.apply(values, &mut rows);
                square(&rows)
            }
            false => square(values) / self.deviation.powi(2),
        };
        all / values.len() as f64
    }

    /// Appends the whitened values. Without a moving average the first ones, which have no known past, are
    /// divided by the noise's own standard deviation; so is the first one of a walk.
    pub fn apply(&self, values: &[f64], rows: &mut Vec<f64>) {
        if self.walks {
            rows.extend(values.first().map(|first| first / self.deviation));
            return self.apply_still(&differences(values), rows);
        }
        self.apply_still(values, rows);
    }

    fn apply_still(&self, values: &[f64], rows: &mut Vec<f64>) {
        let p = self.coefficients.len();
        let mut innovations = Vec::with_capacity(values.len());
        for (t, value) in values.iter().enumerate() {
            let own = self.moving_average.get(t).or(self.moving_average.last());
            let past = self
                .coefficients
                .iter()
                .enumerate()
                .take(if t < p { 0 } else { p });
            let mut expected: f64 = past.map(|(k, a)| a * values[t - 1 - k]).sum();
            let Some(own) = own else {
                let deviation = if t < p {
                    self.deviation
                } else {
                    self.innovation
                };
                rows.push((value - expected) / deviation);
                continue;
            };
            let former = own.gains.iter().zip(innovations.iter().rev());
            expected += former
                .map(|(b, innovation): (_, &f64)| b * innovation)
                .sum::<f64>();
            innovations.push(value - expected);
            rows.push((value - expected) / own.deviation);
        }
    }

    /// Noise of this level and colour.
    pub fn draw(&self, count: usize, random: &mut impl Rng) -> Vec<f64> {
        let p = self.coefficients.len();
        let before = if p == 0 { 0 } else { WARM_UP };
        let mut values: Vec<f64> = Vec::with_capacity(before + count);
        let mut innovations: Vec<f64> = Vec::with_capacity(before + count);
        for t in 0..before + count {
            let past = self.coefficients.iter().take(t).enumerate();
            let expected: f64 = past.map(|(k, a)| a * values[t - 1 - k]).sum();
            let moving = self.echoes().iter().take(t).enumerate();
            let echo: f64 = moving.map(|(k, b)| b * innovations[t - 1 - k]).sum();
            let innovation: f64 = self.innovation * random.sample::<f64, _>(StandardNormal);
            innovations.push(innovation);
            values.push(expected + echo + innovation);
        }
        let mut own = values.split_off(before);
        self.summed(&mut own);
        own
    }
}

/// Differences of neighbouring values.
pub fn differences(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

impl Innovation {
    fn louder(&self, times: f64) -> Self {
        Self {
            gains: self.gains.clone(),
            deviation: times * self.deviation,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Of one pole `a` the variance of third differences is `20 - 30 a + 12 a^2 - 2 a^3` times the noise's.
        #[test]
        fn roughness_of_one_pole(a in -0.9..0.95f64, deviation in 1e-6..1e3f64) {
            let noise = Whitening::one_pole(a, deviation * (1.0 - a * a).sqrt());
            let variance = 20.0 - 30.0 * a + 12.0 * a * a - 2.0 * a.powi(3);
            let expected = deviation * (variance / 20.0).sqrt();
            prop_assert!((noise.roughness() / expected - 1.0).abs() < 1e-9);
        }
    }
}
