//! Amplitude of the vibration after a move, measured, and as it would have been without shaping.
//!
//! Both are defined alike: the amplitude over a period of the slowest mode, `sqrt(2)` times the standard
//! deviation of the deformation, where nothing accelerates. The measured one comes from the sensor's samples.
//! The unshaped one comes from the response of the fitted modes to the same plan ([`super::response`]),
//! including the change of their frequencies along the way.

use core::f64::consts::TAU;

use super::fit::Fit;
use super::forecast::Expected;
use super::path::{NODES, Way};
use super::point::Point;
use super::response::columns;
use crate::estimators::Sample;

/// Fewest samples of a period for an amplitude: the unknowns are mean and amplitude.
const FEWEST: usize = 4;
/// Change of a tick's increment, rad, that may be rounding of positions.
const STEADY: f64 = 1e-12;

/// A move as it was planned and measured.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Planned positions, one each `period`, rad.
    pub planned: &'a [f64],
    /// Control period, s.
    pub period: f64,
    /// Stamps (s) and deformations (rad) in each stretch in which the command did not accelerate.
    pub cruise: &'a [Vec<(f64, f64)>],
    /// The same after the command had come to rest and the motor side had followed.
    pub after: &'a [(f64, f64)],
    /// Time in which the motor side reaches the command, s.
    pub follows: f64,
}

/// Amplitudes of the vibration of a move, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Account {
    /// After its end; none where too little was measured.
    pub left: Option<f64>,
    /// The largest, in cruise and after its end.
    pub vibration: Option<f64>,
    /// After its end, without shaping.
    pub unshaped: f64,
    /// The largest one, without shaping.
    pub unshaped_vibration: f64,
    /// One standard deviation of both, from the uncertainty of shares and frequencies and from the unexplained
    /// part.
    pub unshaped_std: f64,
}

/// A move with the fit of its modes.
#[derive(Clone, Debug)]
pub struct Explained {
    pub(super) fit: Fit,
    pub(super) way: Way,
}

impl Explained {
    /// The account of a move.
    pub fn account(&self, seen: &Seen<'_>) -> Account {
        let period = self.slowest_period();
        // White noise is no vibration; the part that the modes do not explain is.
        let noise = self.fit.variance - self.fit.unexplained();
        let left = window(seen.after, period).and_then(|seen| amplitude(seen, noise));
        let largest = seen
            .cruise
            .iter()
            .filter_map(|one| largest(one, period, noise));
        let vibration = left.map(|left| largest.fold(left, f64::max));
        let centre: Vec<Point> = self.fit.modes.iter().map(|mode| mode.point).collect();
        let traces: Vec<_> = centre
            .iter()
            .map(|point| self.response(point, seen))
            .collect();
        let shares: Vec<f64> = self.fit.modes.iter().map(|mode| mode.share).collect();
        let [unshaped, unshaped_vibration] = measured(&traces, &shares, period);
        Account {
            left,
            vibration,
            unshaped,
            unshaped_vibration,
            unshaped_std: self.doubt(seen, &traces, [unshaped, unshaped_vibration]),
        }
    }

    fn slowest_period(&self) -> f64 {
        let ends = self
            .fit
            .modes
            .iter()
            .map(|mode| mode.point.log_w[NODES - 1].exp());
        TAU / ends.fold(f64::INFINITY, f64::min)
    }

    /// One standard deviation of the unshaped vibration: by each mode's share, by its frequencies and damping
    /// (sigma points), and by the unexplained part.
    fn doubt(&self, seen: &Seen<'_>, traces: &[Trace], centre: [f64; 2]) -> f64 {
        let period = self.slowest_period();
        let shares: Vec<f64> = self.fit.modes.iter().map(|mode| mode.share).collect();
        let away = |[end, all]: [f64; 2]| (end - centre[0]).abs().max((all - centre[1]).abs());
        let mut variance = 2.0 * self.fit.unexplained();
        for (m, mode) in self.fit.modes.iter().enumerate() {
            let mut moved = shares.clone();
            moved[m] += mode.share_std;
            variance += away(measured(traces, &moved, period)).powi(2);
            let points = Expected::from(mode).sigma_points();
            let others = points.len() - 1;
            for point in &points[1..] {
                let mut moved = traces.to_vec();
                moved[m] = self.response(point, seen);
                variance += away(measured(&moved, &shares, period)).powi(2) / others as f64;
            }
        }
        variance.sqrt()
    }

    /// The deformation of a mode of share 1 in the planned motion and for a period of the slowest mode after
    /// it.
    fn response(&self, point: &Point, seen: &Seen<'_>) -> Trace {
        let followed = (seen.follows / seen.period).ceil() as usize;
        let rest = followed + (self.slowest_period() / seen.period).ceil() as usize + 2;
        let last = seen.planned.last().copied().unwrap_or_default();
        let positions = seen.planned.iter().copied();
        let samples: Vec<Sample> = positions
            .chain(core::iter::repeat_n(last, rest))
            .enumerate()
            .map(|(k, motor_position)| Sample {
                time: k as f64 * seen.period,
                motor_position,
                deformation: 0.0,
            })
            .collect();
        let log_w = |position| self.way.value(&point.log_w, position);
        let [across, ..] = columns(&samples, log_w, point.xi, self.fit.cause).of;
        // The measured amplitude is taken after this delay, too.
        let end = seen.planned.len() + followed;
        let at = |range: core::ops::Range<usize>| -> Vec<(f64, f64)> {
            range.map(|k| (samples[k].time, across[k])).collect()
        };
        Trace {
            cruise: steady(seen.planned).into_iter().map(at).collect(),
            after: at(end..samples.len()),
        }
    }
}

impl From<&super::fit::Fitted> for Expected {
    fn from(mode: &super::fit::Fitted) -> Self {
        Self {
            point: mode.point,
            covariance: mode.covariance,
            share: mode.share,
        }
    }
}

/// Response of a mode where nothing accelerates.
#[derive(Clone)]
struct Trace {
    cruise: Vec<Vec<(f64, f64)>>,
    after: Vec<(f64, f64)>,
}

/// Amplitude after the end, and the largest, of modes with these shares.
fn measured(traces: &[Trace], shares: &[f64], period: f64) -> [f64; 2] {
    let sum = |of: &dyn Fn(&Trace) -> &Vec<(f64, f64)>| -> Vec<(f64, f64)> {
        let mut sum = traces
            .first()
            .map(|first| of(first).clone())
            .unwrap_or_default();
        for (k, value) in sum.iter_mut().enumerate() {
            value.1 = traces
                .iter()
                .zip(shares)
                .map(|(trace, share)| share * of(trace)[k].1)
                .sum();
        }
        sum
    };
    let end = amplitude(&sum(&|trace| &trace.after), 0.0).unwrap_or(0.0);
    let stretches = traces.first().map_or(0, |trace| trace.cruise.len());
    let cruise =
        (0..stretches).filter_map(|k| largest(&sum(&|trace| &trace.cruise[k]), period, 0.0));
    [end, cruise.fold(end, f64::max)]
}

/// Stretches of constant velocity other than 0.
fn steady(planned: &[f64]) -> Vec<core::ops::Range<usize>> {
    let mut stretches: Vec<core::ops::Range<usize>> = Vec::new();
    for k in 2..planned.len() {
        let [before, now] = [planned[k - 1] - planned[k - 2], planned[k] - planned[k - 1]];
        if (now - before).abs() > STEADY || now == 0.0 {
            continue;
        }
        match stretches.last_mut() {
            Some(last) if last.end == k => last.end = k + 1,
            _ => stretches.push(k..k + 1),
        }
    }
    stretches
}

/// The largest amplitude over any period of a stretch, in steps of half a period.
fn largest(stretch: &[(f64, f64)], period: f64, noise: f64) -> Option<f64> {
    let (first, last) = (stretch.first()?.0, stretch.last()?.0);
    let halves = ((last - first) / (0.5 * period)) as usize;
    let each = (0..halves.max(2) - 1).filter_map(|k| {
        let from = first + 0.5 * k as f64 * period;
        let start = stretch.partition_point(|(time, _)| *time < from);
        amplitude(window(&stretch[start..], period)?, noise)
    });
    each.reduce(f64::max)
}

/// The first period of a stretch; none where it is shorter.
fn window(stretch: &[(f64, f64)], period: f64) -> Option<&[(f64, f64)]> {
    let (first, last) = (stretch.first()?.0, stretch.last()?.0);
    let end = stretch.partition_point(|(time, _)| *time <= first + period);
    // One sample interval may be missing.
    let interval = (last - first) / (stretch.len() - 1).max(1) as f64;
    (last - first + 2.0 * interval >= period).then(|| &stretch[..end])
}

/// `sqrt(2)` times the standard deviation without white noise of this variance; 0 where two standard deviations
/// of the noise's mean square, `noise sqrt(2 / n)`, explain it. None where there are too few samples.
pub fn amplitude(window: &[(f64, f64)], noise: f64) -> Option<f64> {
    if window.len() < FEWEST {
        return None;
    }
    let n = window.len() as f64;
    let mean = window.iter().map(|one| one.1).sum::<f64>() / n;
    let square = window.iter().map(|one| (one.1 - mean).powi(2)).sum::<f64>() / n;
    let more = square - noise;
    let is_noise = more <= 2.0 * noise * (2.0 / n).sqrt();
    Some(if is_noise { 0.0 } else { (2.0 * more).sqrt() })
}
