//! Positions of motor side and link at the same instants, and the windows over which their laws are integrated.

use super::spline::{CubicSpline, End};
use core::f64::consts::TAU;
use quell_recording::{Channel, range};

/// Samples in the shortest window, and windows that the longest one leaves.
pub(super) const SHORTEST: usize = 8;
pub(super) const FEWEST: usize = 8;
/// Windows that overlap at a sample.
pub(super) const OVERLAP: usize = 4;
/// Longest span of a window against that of its samples: with a sample more, it has a gap.
const GAP: f64 = 1.0 + 1.0 / SHORTEST as f64;

/// A channel without jumps of a turn. What leaves a turn has not wrapped: its jumps are motion, or degrees that are called radians.
pub(super) fn unwrapped(channel: &Channel) -> Channel {
    let mut own = channel.clone();
    if own.columns.iter().all(|column| range(column) <= TAU) {
        own.unwrap_turns();
    }
    own
}

/// Both positions at the stamps of the link.
#[derive(Clone)]
pub(super) struct Series {
    pub time: Vec<f64>,
    pub motor: Vec<f64>,
    pub link: Vec<f64>,
}

impl Series {
    /// Of two channels that are [`unwrapped`].
    pub fn of(motor: &Channel, link: &Channel) -> Option<Self> {
        let spline = CubicSpline::new(&motor.time, motor.columns.first()?, End::NotAKnot).ok()?;
        let (first, last) = spline.span();
        let from = link.time.partition_point(|t| *t < first);
        let until = link.time.partition_point(|t| *t <= last);
        let time = link.time.get(from..until)?.to_vec();
        Some(Self {
            motor: time.iter().map(|t| spline.value(*t)).collect(),
            link: link.columns.first()?.get(from..until)?.to_vec(),
            time,
        })
    }

    /// Numbers of samples of windows, each twice the one before.
    pub fn widths(&self) -> impl Iterator<Item = usize> + use<> {
        let most = self.time.len() / FEWEST;
        let widths = std::iter::successors(Some(SHORTEST), |width| Some(2 * width));
        widths.take_while(move |width| *width <= most)
    }

    /// Where windows of so many samples begin, without those that have a gap.
    pub(super) fn starts(&self, width: usize) -> Option<Vec<usize>> {
        let duration = self.time.last()? - self.time.first()?;
        let usual = duration / (self.time.len() - 1) as f64 * width as f64;
        let starts = (0..self.time.len() - width).step_by(width / OVERLAP);
        let whole = |at: &usize| self.time[at + width] - self.time[*at] <= GAP * usual;
        Some(starts.filter(whole).collect())
    }

    /// The window that begins at a sample, its first and second derivative at another one, in half its spans, each times the
    /// step there in half its spans: an integral by the trapezoidal rule is a sum with these.
    pub(super) fn window(&self, at: usize, width: usize, k: usize) -> [f64; 3] {
        let (first, last) = (self.time[at], self.time[at + width]);
        let half = 0.5 * (last - first);
        let step = 0.5 * (self.time[k + 1] - self.time[k - 1]) / half;
        let s = (self.time[k] - first) / half - 1.0;
        let g = 1.0 - s * s;
        let twice = 48.0 * s * s * g.powi(2) - 8.0 * g.powi(3);
        [g.powi(4), -8.0 * s * g.powi(3), twice].map(|value| value * step)
    }
}
