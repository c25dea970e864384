//! Instants of possible events: impacts, forces that set in, a payload that is gripped.

use nalgebra::{Matrix4, Vector4};

use super::correlation::length;
use super::smoother::Smoothed;
use super::{MOST, Residual, time_scale};
use quell_model::effects::CandidateStop;

/// Probability that noise alone gives a candidate.
const FALSE_ALARM: f64 = 0.01;
/// Number of instants that are tried for a lasting change.
const CANDIDATES: usize = 200;

/// What kind of event an instant is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A jump of the velocity: an impact.
    Impact,
    /// A jump of the missing force.
    Onset,
    /// A lasting change of how the force depends on the motion.
    Change,
}

/// An instant at which something seems to happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CandidateEvent {
    /// Stamp.
    pub at: usize,
    /// When, s.
    pub time: f64,
    /// What.
    pub kind: Kind,
    /// Log-likelihood gain.
    pub gain: f64,
    /// Share of the missing force's variance that it explains; 0 for jumps.
    pub share: f64,
}

/// Candidate events, the most likely first, at least `apart` seconds from one another.
pub(super) fn candidate_events(
    residual: &Residual,
    smoothed: &Smoothed,
    at: &[usize],
    apart: f64,
) -> Vec<CandidateEvent> {
    let mut found = jumps(residual.time, &smoothed.velocity_jump, Kind::Impact);
    found.extend(jumps(residual.time, &smoothed.force_jump, Kind::Onset));
    found.extend(change(residual, &smoothed.missing, at));
    found.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut kept: Vec<CandidateEvent> = Vec::new();
    for event in found {
        if kept.len() < MOST && kept.iter().all(|k| (k.time - event.time).abs() > apart) {
            kept.push(event);
        }
    }
    kept
}

/// What the link may have met at a stamp. It pushes as the missing force does; the link was at its farthest within a
/// quarter of a period.
pub(super) fn stop(residual: &Residual, missing: &[f64], at: usize) -> CandidateStop {
    let side = -missing[at].signum();
    let near = time_scale(residual) / 4.0;
    let within = |t: f64| residual.time.partition_point(|own| *own < t);
    let now = residual.time[at];
    let positions = residual.link[within(now - near)..within(now + near)].iter();
    let position = residual.link[at][0];
    let farthest = positions
        .map(|own| side * own[0])
        .fold(side * position, f64::max);
    CandidateStop {
        position,
        farthest: side * farthest,
        side,
    }
}

/// Local maxima of a jump's gain that are beyond noise: half a chi-squared of one degree of freedom exceeds `g`
/// with a probability below `exp(-g)`, at `n` stamps in two directions. If the gains are on the whole greater
/// than that law's median, the noise is coloured, and they are scaled down.
fn jumps(time: &[f64], gain: &[f64], kind: Kind) -> Vec<CandidateEvent> {
    /// Median of half a chi-squared of one degree.
    const MEDIAN: f64 = 0.227;
    let n = gain.len();
    let threshold = (2.0 * n as f64 / FALSE_ALARM).ln();
    let typical = *gain
        .to_vec()
        .select_nth_unstable_by(n / 2, f64::total_cmp)
        .1;
    let scale = (typical / MEDIAN).max(1.0);
    (1..n.saturating_sub(1))
        .filter(|&k| gain[k] > threshold * scale)
        .filter(|&k| gain[k] > gain[k - 1] && gain[k] >= gain[k + 1])
        .map(|at| CandidateEvent {
            at,
            time: time[at],
            kind,
            gain: gain[at] / scale,
            share: 0.0,
        })
        .collect()
}

/// The stamp from which the regression of the force on `1`, acceleration, velocity and rate (or
/// position) has other coefficients than before: the supremum of likelihood ratios (Andrews, 1993),
/// for as many independent values as the force has.
fn change(residual: &Residual, force: &[f64], at: &[usize]) -> Option<CandidateEvent> {
    let n = at.len();
    if n < 64 {
        return None;
    }
    let rows = regressors(residual, at);
    let mut sums = vec![Sums::default()];
    for (row, &k) in rows.iter().zip(at) {
        let mut next = *sums.last()?;
        next.add(row, force[k]);
        sums.push(next);
    }
    let whole = *sums.last()?;
    let mut best = (0, 0.0, 0.0);
    // Each side keeps a twentieth, so that its coefficients mean something.
    for candidate in 0..CANDIDATES {
        let k = n / 20 + candidate * (n - n / 10) / CANDIDATES;
        let split = sums[k].left() + whole.minus(&sums[k]).left();
        let gain = 0.5 * n as f64 * (whole.left() / split.max(f64::MIN_POSITIVE)).ln();
        if gain > best.1 {
            best = (k, gain, (whole.left() - split) / whole.about_mean());
        }
    }
    let stamps: Vec<f64> = at.iter().map(|&k| residual.time[k]).collect();
    let series: Vec<f64> = at.iter().map(|&k| force[k]).collect();
    let gain = best.1 / length(&stamps, &series).samples;
    let (at, share) = (at[best.0], best.2);
    let found = CandidateEvent {
        at,
        time: residual.time[at],
        kind: Kind::Change,
        gain,
        share,
    };
    (gain > threshold()).then_some(found)
}

/// Half the chi-squared of four degrees, tail `exp(-g) (1 + g)`, that all candidates together exceed
/// by chance with the false alarm's probability (Bonferroni).
fn threshold() -> f64 {
    let log = (CANDIDATES as f64 / FALSE_ALARM).ln();
    (0..20).fold(log, |g: f64, _| log + (1.0 + g).ln())
}

/// Regressors of unit mean square.
fn regressors(residual: &Residual, at: &[usize]) -> Vec<Vector4<f64>> {
    let has_link = at
        .iter()
        .any(|&k| residual.link[k][0] != residual.motor[k][0]);
    let mut rows: Vec<Vector4<f64>> = at
        .iter()
        .map(|&k| {
            let (motor, link) = (residual.motor[k], residual.link[k]);
            let last = if has_link {
                link[1] - motor[1]
            } else {
                motor[0]
            };
            Vector4::new(1.0, link[2], link[1], last)
        })
        .collect();
    let squares = rows
        .iter()
        .fold(Vector4::zeros(), |s, r| s + r.component_mul(r));
    let scale = squares.map(|s: f64| (s / at.len() as f64).sqrt().max(f64::MIN_POSITIVE));
    rows.iter_mut()
        .for_each(|row| row.component_div_assign(&scale));
    rows
}

/// Normal equations of a regression.
#[derive(Clone, Copy, Default)]
struct Sums {
    matrix: Matrix4<f64>,
    right: Vector4<f64>,
    square: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, row: &Vector4<f64>, value: f64) {
        self.matrix += row * row.transpose();
        self.right += row * value;
        self.square += value * value;
        self.count += 1.0;
    }

    fn minus(&self, other: &Self) -> Self {
        Self {
            matrix: self.matrix - other.matrix,
            right: self.right - other.right,
            square: self.square - other.square,
            count: self.count - other.count,
        }
    }

    /// Sum of squares about the mean; the first regressor is 1.
    fn about_mean(&self) -> f64 {
        (self.square - self.right[0] * self.right[0] / self.count).max(f64::MIN_POSITIVE)
    }

    /// Sum of squares that the regression leaves. A ridge of 1e-6 keeps regressors that do not move
    /// on one side harmless.
    fn left(&self) -> f64 {
        let ridge = Matrix4::identity() * (1e-6 * self.count);
        match (self.matrix + ridge).cholesky() {
            Some(factor) => (self.square - self.right.dot(&factor.solve(&self.right))).max(0.0),
            None => self.square,
        }
    }
}
