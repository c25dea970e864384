//! A channel as evenly spaced samples.

use crate::IdentificationError;
use nalgebra::{Complex, DMatrix};
use quell_recording::{Channel, Recording, Role, are_even, health};
use quell_signal::{CubicSpline, End, SignalError};
use std::f64::consts::TAU;

/// Roles of vibrating channels, the preferred one first.
const ROLES: [Role; 8] = [
    Role::TipAcceleration,
    Role::LinkAcceleration,
    Role::LinkVelocity,
    Role::Deformation,
    Role::LinkPosition,
    Role::TipPosition,
    Role::Torque,
    Role::MotorPosition,
];
/// Deviation from a whole number that is the rounding of a stamp's digits.
const WHOLE: f64 = 1e-3;
/// Longest gap, in samples, that is interpolated.
const HOLE: f64 = 4.5;

/// A vibrating channel, evenly sampled.
#[derive(Clone, Debug, PartialEq)]
pub struct Vibration {
    /// The channel's role.
    pub role: Role,
    /// Its unit.
    pub unit: String,
    /// First stamp, s.
    pub start: f64,
    /// Samples a second, Hz.
    pub rate: f64,
    /// One to three axes, of one length.
    pub axes: Vec<Vec<f64>>,
    /// Share of the recording that is used: with holes, the longest stretch without one.
    pub used: f64,
    /// Instants at which an accelerometer is at the limit of its range, s.
    pub clipped: Vec<f64>,
}

impl Vibration {
    /// Whether no axis varies.
    pub fn is_still(&self) -> bool {
        let still = |axis: &Vec<f64>| axis.iter().all(|value| *value == axis[0]);
        self.axes.iter().all(still)
    }

    /// The place of the axis with the largest Fourier coefficient at a frequency, Hz; `None` with a single axis.
    pub fn strongest_axis(&self, hertz: f64) -> Option<usize> {
        let size = |axis: &Vec<f64>| {
            let mean = axis.iter().sum::<f64>() / axis.len() as f64;
            let turn = Complex::from_polar(1.0, TAU * hertz / self.rate);
            // Horner's rule: the sum of the samples times powers of the turn.
            let sum = axis.iter().fold(Complex::new(0.0, 0.0), |sum, value| {
                sum * turn + (value - mean)
            });
            sum.norm()
        };
        let sizes = self.axes.iter().map(size).enumerate();
        let most = sizes.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (self.axes.len() > 1).then_some(most.0)
    }

    /// The vibration along the direction of most motion, the first principal component of the axes. A sum of
    /// the powers of several directions is not the power of one, since each direction combines the modes
    /// differently.
    #[must_use]
    pub fn principal(&self) -> Self {
        let count = self.axes.len();
        let means: Vec<f64> = self.axes.iter().map(|axis| mean(axis)).collect();
        let product = |i: usize, j: usize| -> f64 {
            let pairs = self.axes[i].iter().zip(&self.axes[j]);
            pairs.map(|(a, b)| (a - means[i]) * (b - means[j])).sum()
        };
        let eigen = DMatrix::from_fn(count, count, product).symmetric_eigen();
        let direction = eigen.eigenvectors.column(eigen.eigenvalues.imax());
        let along = |k: usize| -> f64 {
            let axes = self.axes.iter().zip(&means).zip(&direction);
            axes.map(|((axis, mean), share)| share * (axis[k] - mean))
                .sum()
        };
        Self {
            axes: vec![(0..self.axes[0].len()).map(along).collect()],
            role: self.role,
            unit: self.unit.clone(),
            clipped: self.clipped.clone(),
            ..*self
        }
    }

    /// The part of a stretch, in samples from and before, after its last reading at the limit of the sensor: what
    /// clips a vibration makes multiples of it.
    pub fn unclipped(&self, [from, until]: [usize; 2]) -> [usize; 2] {
        let sample = |time: &f64| ((time - self.start) * self.rate).round().max(0.0) as usize;
        let within = |sample: &usize| (from..until).contains(sample);
        let last = self.clipped.iter().map(sample).filter(within).max();
        [last.map_or(from, |last| last + 1), until]
    }

    /// The instant of a sample, s.
    pub fn time(&self, sample: usize) -> f64 {
        self.start + sample as f64 / self.rate
    }
}

/// The vibration in a recording: of an accelerometer, else of another channel of the link.
///
/// # Errors
/// [`IdentificationError`] where there is no such channel, or its stamps cannot be brought onto an even grid.
pub fn vibration(recording: &Recording) -> Result<Vibration, IdentificationError> {
    let found = ROLES.iter().filter_map(|role| recording.channel(*role));
    let channel = found.clone().find(|channel| channel.varies());
    // What has no other channel beside it vibrates itself, whatever it is.
    let sole = match recording.channels.as_slice() {
        [one] => Some(one),
        _ => None,
    };
    let channel = channel
        .or_else(|| found.clone().next())
        .or(sole)
        .ok_or_else(|| SignalError::MissingChannel {
            recording: recording.name.clone(),
            channel: "tip_acceleration, or another channel that vibrates",
        })?;
    if let Some(value) = channel.impossible() {
        return Err(IdentificationError::NoMeasurement {
            channel: channel.role,
            value,
            unit: channel.unit.clone(),
        });
    }
    even(channel)
}

/// The longest stretch of a channel without holes, at even stamps.
fn even(channel: &Channel) -> Result<Vibration, IdentificationError> {
    let time = &channel.time;
    let steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let mut sorted = steps.clone();
    sorted.sort_unstable_by(f64::total_cmp);
    let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
    let (first, last) = longest(&steps, HOLE * middle);
    let stamps = &time[first..=last];
    let samples = stamps.len();
    // If samples are missing, the grid includes them; if stamps only jitter, the grid has as many points as
    // there are samples.
    let missing = sorted.last().is_some_and(|longest| *longest > 1.5 * middle);
    let Grid {
        start,
        period,
        is_even,
    } = grid(stamps, middle, missing);
    let mut axes = Vec::new();
    for column in &channel.columns {
        let values = &column[first..=last];
        axes.push(match is_even || samples < 5 {
            true => values.to_vec(),
            false => {
                let spline = CubicSpline::new(stamps, values, End::NotAKnot)?;
                let count = ((stamps[samples - 1] - stamps[0]) / period) as usize + 1;
                (0..count)
                    .map(|k| spline.value(stamps[0] + k as f64 * period))
                    .collect()
            }
        });
    }
    Ok(Vibration {
        role: channel.role,
        unit: channel.unit.clone(),
        start,
        rate: 1.0 / period,
        axes,
        used: samples as f64 / time.len().max(1) as f64,
        clipped: clipped(channel),
    })
}

/// Instants at which an accelerometer is at the limit of its range, s; in no order.
fn clipped(channel: &Channel) -> Vec<f64> {
    let found = health::clipped_axes(channel).into_iter();
    let samples = found.flat_map(|found| found.samples);
    samples.map(|sample| channel.time[sample]).collect()
}

/// An even grid, s, and whether each sample is at its place there.
struct Grid {
    start: f64,
    period: f64,
    is_even: bool,
}

/// The grid for stamps of this median period.
fn grid(stamps: &[f64], middle: f64, missing: bool) -> Grid {
    let samples = stamps.len();
    let start = stamps[0];
    let period = match samples {
        1 => middle,
        _ => (stamps[samples - 1] - start) / (samples - 1) as f64,
    };
    let is_even = are_even(stamps.iter().copied(), [start, period]);
    if let Some([start, period]) = rounded(stamps).filter(|_| !is_even) {
        let is_even = true;
        return Grid {
            start,
            period,
            is_even,
        };
    }
    let period = if !is_even && missing { middle } else { period };
    Grid {
        start,
        period,
        is_even,
    }
}

/// Start and period, s, of even stamps that were rounded, or cut off, to a power of ten of a second: `None` where
/// they leave their regression line by more than that allows. A sample that is missing shifts all behind it by a
/// period, and so leaves it.
fn rounded(stamps: &[f64]) -> Option<[f64; 2]> {
    let digits = (0..=9).find(|digits| {
        let per_second = 10.0_f64.powi(*digits);
        let is_whole =
            |stamp: &f64| (stamp * per_second - (stamp * per_second).round()).abs() < WHOLE;
        stamps.iter().all(is_whole)
    })?;
    let count = stamps.len() as f64;
    let (middle, centre) = ((count - 1.0) / 2.0, mean(stamps));
    let (mut along, mut square) = (0.0, 0.0);
    for (k, stamp) in stamps.iter().enumerate() {
        along += (k as f64 - middle) * (stamp - centre);
        square += (k as f64 - middle).powi(2);
    }
    let period = along / square;
    let off = |(k, stamp): (usize, &f64)| stamp - centre - (k as f64 - middle) * period;
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    for off in stamps.iter().enumerate().map(off) {
        (least, most) = (least.min(off), most.max(off));
    }
    let step = 0.1_f64.powi(digits);
    // The line itself is known to the deviation of the rounding, over the root of the number of stamps.
    let unsure = step * (12.0 / count).sqrt();
    (most - least <= step + unsure)
        .then_some([centre - middle * period + 0.5 * (least + most), period])
}

/// First and last sample of the longest stretch whose steps stay below a limit.
fn longest(steps: &[f64], limit: f64) -> (usize, usize) {
    let (mut best, mut first) = ((0, 0), 0);
    for (k, step) in steps.iter().enumerate() {
        if *step > limit {
            first = k + 1;
        } else if k + 1 - first > best.1 - best.0 {
            best = (first, k + 1);
        }
    }
    best
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
