//! Dependence of the damping on the amplitude, cycle by cycle over a free decay.

use super::run::Run;
use quell_control::estimators::Sample;
use quell_control::estimators::offline::log_decrement;
use quell_signal::noise_floor;

/// Damping over one cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleDamping {
    /// Middle of the cycle, s.
    pub time: f64,
    /// Amplitude there (half of peak to peak), in the deformation's unit.
    pub amplitude: f64,
    /// Damping ratio of this cycle.
    pub damping_ratio: f64,
    /// One standard deviation of it.
    pub damping_ratio_std: f64,
}

/// Damping against amplitude over a free decay.
#[derive(Clone, Debug, PartialEq)]
pub struct AmplitudeDependence {
    /// One entry for each half period, each over a whole cycle, in the order of time.
    pub cycles: Vec<CycleDamping>,
    /// Kendall's rank correlation of damping and amplitude in standard deviations of chance.
    pub trend: f64,
}

impl AmplitudeDependence {
    /// Whether damping falls with the amplitude. The rank correlation must be beyond chance (two standard
    /// deviations, 5 % by chance; at least five cycles), and the medians of the first and last third must
    /// differ by three of their own standard deviations.
    pub fn falls_with_amplitude(&self) -> bool {
        self.trend > 2.0 && self.differs()
    }

    /// Whether damping grows as the amplitude falls, by the same rule.
    pub fn grows_as_amplitude_falls(&self) -> bool {
        self.trend < -2.0 && self.differs()
    }

    /// Medians of the first and of the last third of the cycles: amplitude and damping ratio.
    pub fn ends(&self) -> [CycleDamping; 2] {
        let third = self.cycles.len().div_ceil(3);
        [
            &self.cycles[..third],
            &self.cycles[self.cycles.len() - third..],
        ]
        .map(|part| {
            let mut part = part.to_vec();
            part.sort_by(|a, b| a.damping_ratio.total_cmp(&b.damping_ratio));
            part[part.len() / 2]
        })
    }

    fn differs(&self) -> bool {
        let [first, last] = self.ends();
        let std = first.damping_ratio_std.hypot(last.damping_ratio_std);
        (first.damping_ratio - last.damping_ratio).abs() > 3.0 * std
    }
}

/// Damping of successive cycles of a free decay, and its rank correlation with the amplitude.
///
/// Half of the distance between neighbouring extrema is an amplitude without offset; two of them a
/// period apart give a damping ratio by eq. (25). `None` with fewer than three cycles.
pub fn dependence(samples: &[Sample], run: &Run) -> Option<AmplitudeDependence> {
    let mode = run.batch()?.mode;
    let samples = run.stretch.of(samples);
    let values: Vec<f64> = samples.iter().map(|s| s.deformation).collect();
    let noise = noise_floor(&values).standard_deviation;
    let sample_time = (run.stretch.until - run.stretch.from) / samples.len().max(2) as f64;
    // The vertex of a parabola through m samples has a standard deviation of 1.5 sigma / sqrt m.
    let averaged = (mode.damped_period() / 4.0 / sample_time).max(1.0);
    let height_std = 1.5 * noise / averaged.sqrt();
    let halves: Vec<(f64, f64)> = run
        .extrema
        .windows(2)
        .map(|pair| {
            let amplitude = 0.5 * (pair[1].height - pair[0].height).abs();
            (0.5 * (pair[0].time + pair[1].time), amplitude)
        })
        .collect();
    let amplitude_std = height_std / core::f64::consts::SQRT_2;
    let cycles: Vec<CycleDamping> = halves
        .windows(3)
        .map(|three| {
            let (first, last) = (three[0].1, three[2].1);
            let relative = (amplitude_std / first).hypot(amplitude_std / last);
            CycleDamping {
                time: three[1].0,
                amplitude: (first * last).sqrt(),
                damping_ratio: log_decrement(first, last),
                damping_ratio_std: relative / core::f64::consts::TAU,
            }
        })
        .collect();
    let trend = trend(&cycles);
    (cycles.len() >= 3).then_some(AmplitudeDependence { cycles, trend })
}

/// Kendall's score of damping over amplitude, over its standard deviation without any dependence.
///
/// Source: M. G. Kendall, Rank Correlation Methods (1948), with the continuity correction.
fn trend(cycles: &[CycleDamping]) -> f64 {
    let count = cycles.len() as f64;
    let mut score = 0.0;
    for (k, a) in cycles.iter().enumerate() {
        for b in &cycles[k + 1..] {
            let product = (a.damping_ratio - b.damping_ratio) * (a.amplitude - b.amplitude);
            score += if product == 0.0 {
                0.0
            } else {
                product.signum()
            };
        }
    }
    let variance = count * (count - 1.0) * (2.0 * count + 5.0) / 18.0;
    if score == 0.0 {
        0.0
    } else {
        (score - f64::signum(score)) / variance.sqrt()
    }
}
