//! Whether damping depends on amplitude: cycle by cycle over a free decay.

use super::run::Run;
use crate::estimators::Sample;
use crate::estimators::offline::{extrema, log_decrement};
use crate::signal::noise_floor;

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
    /// One entry a half period, each over a whole cycle.
    pub cycles: Vec<CycleDamping>,
    /// Change of the damping ratio where the amplitude grows by a factor e.
    pub slope: f64,
    /// One standard deviation of it.
    pub slope_std: f64,
}

impl AmplitudeDependence {
    /// Whether damping falls as the amplitude does: the slope is above zero by three of its standard
    /// deviations, and the line falls by a fifth or more of the first cycle's over the record.
    pub fn falls_with_amplitude(&self) -> bool {
        self.matters() && self.slope > 0.0
    }

    /// Whether damping grows as the amplitude falls, by the same rule.
    pub fn grows_as_amplitude_falls(&self) -> bool {
        self.matters() && self.slope < 0.0
    }

    fn matters(&self) -> bool {
        let (Some(first), Some(last)) = (self.cycles.first(), self.cycles.last()) else {
            return false;
        };
        let change = self.slope * (first.amplitude / last.amplitude).ln();
        self.slope.abs() > 3.0 * self.slope_std && change.abs() > 0.2 * first.damping_ratio.abs()
    }
}

/// Damping of successive cycles of a free decay, and a line through it over the amplitude's
/// logarithm.
///
/// Half of the distance between neighbouring extrema is an amplitude without offset; two of them a
/// period apart give a damping ratio by eq. (25). `None` with fewer than three cycles.
pub fn dependence(samples: &[Sample], run: &Run) -> Option<AmplitudeDependence> {
    let mode = run.batch()?.mode;
    let samples = run.stretch.of(samples);
    let values: Vec<f64> = samples.iter().map(|s| s.deformation).collect();
    let noise = noise_floor(&values).standard_deviation;
    let found = extrema(samples, mode.damped_frequency(), run.offset, 3.0 * noise);
    let sample_time = (run.stretch.until - run.stretch.from) / samples.len().max(2) as f64;
    // The vertex of a parabola through m samples has a standard deviation of 1.5 sigma / sqrt m.
    let averaged = (mode.damped_period() / 4.0 / sample_time).max(1.0);
    let height_std = 1.5 * noise / averaged.sqrt();
    let halves: Vec<(f64, f64)> = found
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
    (cycles.len() >= 3).then(|| line(cycles))
}

/// Weighted line of damping over `ln amplitude`; its standard deviation from the larger of the
/// known noise and the scatter about the line.
fn line(cycles: Vec<CycleDamping>) -> AmplitudeDependence {
    let count = cycles.len() as f64;
    let mean_x = cycles.iter().map(|c| c.amplitude.ln()).sum::<f64>() / count;
    let mean_y = cycles.iter().map(|c| c.damping_ratio).sum::<f64>() / count;
    let square: f64 = cycles
        .iter()
        .map(|c| (c.amplitude.ln() - mean_x).powi(2))
        .sum();
    let product: f64 = cycles
        .iter()
        .map(|c| (c.amplitude.ln() - mean_x) * (c.damping_ratio - mean_y))
        .sum();
    let slope = product / square.max(f64::MIN_POSITIVE);
    let scatter: f64 = cycles
        .iter()
        .map(|c| (c.damping_ratio - mean_y - slope * (c.amplitude.ln() - mean_x)).powi(2))
        .sum::<f64>()
        / (count - 2.0).max(1.0);
    let noise: f64 = cycles
        .iter()
        .map(|c| c.damping_ratio_std.powi(2))
        .sum::<f64>()
        / count;
    // Cycles overlap by half, so half as many are independent.
    let slope_std = (2.0 * scatter.max(noise) / square.max(f64::MIN_POSITIVE)).sqrt();
    AmplitudeDependence {
        cycles,
        slope,
        slope_std,
    }
}
