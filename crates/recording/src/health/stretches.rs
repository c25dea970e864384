//! Stretches of a column that cannot be motion: runs of one value, jumps by a turn, spikes.

use super::median;
use std::f64::consts::PI;

/// A long run of one and the same value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flat {
    /// Time of its first sample, s.
    pub from: f64,
    /// Time of its last sample, s.
    pub until: f64,
    /// Number of samples.
    pub samples: usize,
    /// The value.
    pub value: f64,
    /// The meaning of the run.
    pub kind: FlatKind,
    /// Whether it begins in full motion; one that begins a recording does not.
    pub begins_in_motion: bool,
}

/// The meaning of a run of one value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlatKind {
    /// The machine rests: the run begins and ends gently.
    Rest,
    /// The sensor is stuck: the run begins or ends in full motion, inside the range.
    Stuck,
    /// The range is exceeded: as stuck, at the column's least or greatest value.
    Saturated,
}

/// Probability that a column without faults has one run that long.
const CHANCE: f64 = 1e-3;
/// Greatest increment within two samples of a rest, as a share of the typical one in motion. An axis that stops at a constant rate in
/// `m` samples has `3 / (2 m)` of its speed there, and it takes three or more.
const GENTLE: f64 = 0.5;
/// The same in quantisation steps. Rounding adds up to one to the two that a move of four a sample has there.
const ROUNDED: f64 = 3.0;

/// Runs of one value that are too long for chance.
///
/// With p the share of repeated values outside of the run, n samples contain a run of L repeats by chance with
/// a probability of at most `n p^L`. Runs with less than 0.001 (and at least 4 samples) are reported. A run is
/// a rest unless the column moves, within two samples of an edge of it, by more than half its typical (median)
/// increment in motion and by more than 3 quantisation steps: an axis takes more than two samples to stop and
/// start again. A signal that is clipped just below its top, where it is slow, is taken for a rest.
pub fn flats(time: &[f64], values: &[f64], quantum: f64) -> Vec<Flat> {
    let increments: Vec<f64> = values
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    let moving: Vec<f64> = increments
        .iter()
        .copied()
        .filter(|step| *step > 0.0)
        .collect();
    let repeats = (increments.len() - moving.len()) as f64;
    let abrupt = (GENTLE * median(moving)).max(ROUNDED * quantum);
    let minimum = values.iter().copied().fold(f64::INFINITY, f64::min);
    let maximum = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let is_long = |run: &Run| {
        let inside = (run.last - run.first) as f64;
        let share = (repeats - inside) / (increments.len() as f64 - inside).max(1.0);
        let chance = values.len() as f64 * share.powf(inside);
        inside >= 3.0 && chance < CHANCE
    };
    let flat = |run: Run| {
        let value = values[run.first];
        let [before, after] = run.edges(&increments);
        let kind = match before.max(after) {
            edge if edge <= abrupt => FlatKind::Rest,
            _ if value == minimum || value == maximum => FlatKind::Saturated,
            _ => FlatKind::Stuck,
        };
        let samples = run.last - run.first + 1;
        Flat {
            from: time[run.first],
            until: time[run.last],
            samples,
            value,
            kind,
            begins_in_motion: before > abrupt,
        }
    };
    runs(values).into_iter().filter(is_long).map(flat).collect()
}

/// First and last sample of a run of one value.
struct Run {
    first: usize,
    last: usize,
}

impl Run {
    /// The greatest increments within two samples before and after the run. Two, since a clipping sensor
    /// shortens the one next to the run.
    fn edges(&self, increments: &[f64]) -> [f64; 2] {
        let before = &increments[self.first.saturating_sub(2)..self.first];
        let after = &increments[self.last..increments.len().min(self.last + 2)];
        [before, after].map(|own| own.iter().copied().fold(0.0, f64::max))
    }
}

fn runs(values: &[f64]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (sample, value) in values.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if values[run.first] == *value => run.last = sample,
            _ => runs.push(Run {
                first: sample,
                last: sample,
            }),
        }
    }
    runs
}

/// Samples after a jump by a turn: an angle (rad) that moves by more than pi in one interval,
/// where it moves by less than pi / 10 at the median.
pub fn wraps(angles: &[f64]) -> Vec<usize> {
    let increments: Vec<f64> = angles
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .collect();
    if median(increments.clone()) > PI / 10.0 {
        return Vec::new();
    }
    (1..angles.len())
        .filter(|&sample| increments[sample - 1] > PI)
        .collect()
}

/// Standard deviations beyond which a sample is not noise: a Gaussian exceeds 8 with probability 1e-15.
const SPIKE: f64 = 8.0;
/// Samples on either side that a spike is compared with.
const AROUND: usize = 8;

/// Samples that lie far beyond both their neighbours, on the same side, while those agree.
///
/// Far: by more than 8 standard deviations of the noise, 8 quantisation steps, 8 times the
/// distance between the two neighbours, and 8 times any second difference near by that does not
/// contain the sample (the top of an oscillation is as curved as what is around it).
pub fn spikes(values: &[f64], noise_std: f64, quantum: f64) -> Vec<usize> {
    let bend = |sample: Option<usize>| {
        let near = sample.and_then(|sample| values.get(sample.checked_sub(1)?..sample + 2));
        near.map_or(0.0, |near| (near[2] - 2.0 * near[1] + near[0]).abs())
    };
    let is_spike = |&sample: &usize| {
        let (before, after) = (values[sample - 1], values[sample + 1]);
        let (left, right) = (values[sample] - before, values[sample] - after);
        let floor = SPIKE * noise_std.max(quantum).max((after - before).abs());
        let height = left.abs().min(right.abs());
        left * right > 0.0
            && height > floor
            && (2..=AROUND).all(|far| {
                let near = bend(sample.checked_sub(far)).max(bend(Some(sample + far)));
                height > SPIKE * near
            })
    };
    (1..values.len().saturating_sub(1))
        .filter(is_spike)
        .collect()
}
