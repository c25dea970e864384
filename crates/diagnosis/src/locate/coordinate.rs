//! Which coordinate the missing force follows.

use super::Residual;
use super::basis::{Basis, dot};
use super::correlation::length;
use super::phases::REST;
use super::smoother::Smoothed;
use crate::CoordinateTrace;

/// Standard deviations above chance that a coordinate must reach: once in ten thousand, since seven are tried.
const CHANCE: f64 = 3.72;

/// A coordinate by name; between equals the first in the list wins.
pub(super) struct Coordinate {
    pub name: &'static str,
    pub unit: &'static str,
    pub values: Vec<f64>,
}

/// Share of the variance of the missing force that a coordinate explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Explained {
    /// Share, corrected for what chance explains.
    pub share: f64,
    /// Whether it is above chance.
    pub significant: bool,
}

/// Coordinates with which the force is compared. The link is at its simulated position plus the smoothed error,
/// so that its rate changes sign where the true one does.
pub(super) fn coordinates(residual: &Residual, error: &[[f64; 2]]) -> Vec<Coordinate> {
    let has_link = has_link(residual);
    let link = |i: usize, k: usize| residual.link[k][i] + error[k].get(i).unwrap_or(&0.0);
    let of = |f: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..error.len()).map(f).collect() };
    let deformation = of(&|k| link(0, k) - residual.motor[k][0]);
    let mut found = Vec::new();
    let mut add = |name, unit, values| found.push(Coordinate { name, unit, values });
    let position = of(&|k| link(0, k));
    let state = hysteresis(if has_link { &deformation } else { &position });
    if has_link {
        add(
            "deformation rate",
            "",
            of(&|k| link(1, k) - residual.motor[k][1]),
        );
        add("deformation", "", deformation);
    }
    add("velocity", "", of(&|k| link(1, k)));
    add("acceleration", "", of(&|k| link(2, k)));
    add("position", "", position);
    add("hysteresis", "", state);
    add("time", "s", residual.time.to_vec());
    found
}

/// Whether the link moves apart from the motor side.
pub(super) fn has_link(residual: &Residual) -> bool {
    let mut sides = residual.motor.iter().zip(residual.link);
    sides.any(|(motor, link)| motor[0] != link[0])
}

/// Coordinates whose linear part a refit of frequency and damping has absorbed: deformation and its rate, or
/// position and velocity where no motor side loads the spring.
fn linear(residual: &Residual, error: &[[f64; 2]]) -> Vec<Vec<f64>> {
    if residual.dynamics.natural_frequency == 0.0 || residual.sensor_only {
        return Vec::new();
    }
    let base = f64::from(u8::from(has_link(residual)));
    let at = |i: usize, k: usize| residual.link[k][i] + error[k][i] - base * residual.motor[k][i];
    (0..2)
        .map(|i| (0..error.len()).map(|k| at(i, k)).collect())
        .collect()
}

/// Dahl's state for a coordinate, with a length of a third of its root mean square: between a sign
/// of the rate and the coordinate itself.
fn hysteresis(x: &[f64]) -> Vec<f64> {
    let mean = x.iter().sum::<f64>() / x.len() as f64;
    let square = x.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / x.len() as f64;
    let length = (square.sqrt() / 3.0).max(f64::MIN_POSITIVE);
    let mut state = 0.0;
    let mut before = x[0];
    x.iter()
        .map(|&x| {
            let step = x - before;
            before = x;
            if step != 0.0 {
                let end = step.signum();
                state = end + (state - end) * (-step.abs() / length).exp();
            }
            state
        })
        .collect()
}

/// Stamps that are used: those in motion, unless nearly all is rest.
pub(super) fn moving(labels: &[usize]) -> Vec<usize> {
    let moving: Vec<usize> = (0..labels.len()).filter(|&k| labels[k] != REST).collect();
    if 4 * moving.len() < labels.len() {
        (0..labels.len()).collect()
    } else {
        moving
    }
}

/// The correlation ratio of the missing force against a coordinate, at these stamps.
///
/// `eta^2` is the share of the variance between bins. If the force is correlated in time, bins of neighbouring
/// stamps (of time, of position) differ by chance. With a correlation `rho` the expected share is `(sum_b
/// (1/n_b) sum_ij rho_ij - G) / (N - G)`, `G = sum_ij rho_ij / N`. The share is corrected for it. Its
/// significance is by the standard deviation of the Beta distribution for the number of independent values `N^2
/// / sum_ij rho_ij^2`.
///
/// Source: Kelley, "An unbiased correlation ratio measure" (1935), here with correlation.
///
/// The linear terms are what a refit has absorbed; multiples of them are removed from the force.
pub(super) fn explained(
    time: &[f64],
    force: &[f64],
    linear: &[Vec<f64>],
    x: &[f64],
    at: &[usize],
) -> Explained {
    let none = Explained {
        share: 0.0,
        significant: false,
    };
    if at.len() < 16 {
        return none;
    }
    let series: Vec<f64> = at.iter().map(|&k| force[k]).collect();
    let stamps: Vec<f64> = at.iter().map(|&k| time[k]).collect();
    let memory = length(&stamps, &series).constant;
    let n = at.len() as f64;
    let one = vec![0; at.len()];
    let independent = n * n / (n * correlated(&stamps, &one, 1, 0.5 * memory)).max(1.0);
    let count = (independent / 8.0).clamp(4.0, 16.0) as usize;
    let bins = bins(&at.iter().map(|&k| x[k]).collect::<Vec<_>>(), count);
    let all = correlated(&stamps, &one, 1, memory);
    let expected = (correlated(&stamps, &bins, count, memory) - all) / (n - all);
    if !(expected.is_finite() && expected < 0.95) {
        return none;
    }
    let expected = expected.max(0.0);
    let linear: Vec<Vec<f64>> = linear
        .iter()
        .map(|term| at.iter().map(|&k| term[k]).collect())
        .collect();
    let ratio = between(&series, &linear, &bins, count);
    let deviation = (2.0 * expected * (1.0 - expected) / (independent + 2.0)).sqrt();
    Explained {
        share: ((ratio - expected) / (1.0 - expected)).clamp(0.0, 1.0),
        significant: ratio > expected + CHANCE * deviation,
    }
}

/// Bins, half of their edges at equal counts and half at equal distances, so that both the tails and the middle
/// are resolved. Equal values share a bin.
fn bins(x: &[f64], count: usize) -> Vec<usize> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (least, greatest) = (sorted[0], sorted[x.len() - 1]);
    let half = count / 2;
    let even = (1..half).map(|b| least + (greatest - least) * b as f64 / half as f64);
    let alike = (1..=count - half).map(|b| sorted[b * x.len() / (count - half + 1)]);
    let mut edges: Vec<f64> = even.chain(alike).collect();
    edges.sort_by(f64::total_cmp);
    x.iter()
        .map(|x| edges.partition_point(|edge| edge <= x))
        .collect()
}

/// `sum_b (1/n_b) sum_ij rho_ij` for `rho = exp(-|t_i - t_j| / constant)`, in one sweep.
fn correlated(time: &[f64], bins: &[usize], count: usize, constant: f64) -> f64 {
    let mut memory = vec![(f64::NEG_INFINITY, 0.0); count];
    let (mut sums, mut members) = (vec![0.0; count], vec![0.0; count]);
    for (&t, &bin) in time.iter().zip(bins) {
        let (last, past) = memory[bin];
        let kept = if constant > 0.0 {
            past * ((last - t) / constant).exp()
        } else {
            0.0
        };
        sums[bin] += 1.0 + 2.0 * kept;
        members[bin] += 1.0;
        memory[bin] = (t, kept + 1.0);
    }
    sums.iter()
        .zip(&members)
        .filter(|(_, n)| **n > 0.0)
        .map(|(s, n)| s / n)
        .sum()
}

/// Share of the variance that bins explain beyond the linear terms: one minus the ratio of the sums of squares
/// with and without bins (Frisch, Waugh and Lovell: all centred within bins, or as a whole).
fn between(series: &[f64], linear: &[Vec<f64>], bins: &[usize], count: usize) -> f64 {
    let one = vec![0; series.len()];
    let whole = left(series, linear, &one, 1);
    if whole > 0.0 {
        1.0 - left(series, linear, bins, count) / whole
    } else {
        0.0
    }
}

/// Sum of squares after the means of bins and the linear terms.
fn left(series: &[f64], linear: &[Vec<f64>], bins: &[usize], count: usize) -> f64 {
    let mut rest = within(series, bins, count);
    let mut basis = Basis::default();
    for term in linear {
        basis.add(&within(term, bins, count));
    }
    basis.remove(&mut rest);
    dot(&rest, &rest)
}

/// A series less the mean of its bin.
fn within(series: &[f64], bins: &[usize], count: usize) -> Vec<f64> {
    let (mut sums, mut members) = (vec![0.0; count], vec![0.0; count]);
    for (x, &bin) in series.iter().zip(bins) {
        sums[bin] += x;
        members[bin] += 1.0;
    }
    series
        .iter()
        .zip(bins)
        .map(|(x, &bin)| x - sums[bin] / members[bin])
        .collect()
}

/// Every coordinate's share, and the trace over the best one that is above chance.
pub(super) fn best(
    residual: &Residual,
    smoothed: &Smoothed,
    at: &[usize],
) -> (Vec<(String, f64)>, Option<CoordinateTrace>) {
    let force = &smoothed.missing;
    let coordinates = coordinates(residual, &smoothed.error);
    let linear = linear(residual, &smoothed.error);
    let shares: Vec<Explained> = coordinates
        .iter()
        .map(|c| explained(residual.time, force, &linear, &c.values, at))
        .collect();
    let list: Vec<(String, f64)> = coordinates
        .iter()
        .zip(&shares)
        .map(|(c, e)| (c.name.to_string(), e.share))
        .collect();
    // The last of equals would win. In reversed order the first one does.
    let winner = (0..shares.len())
        .rev()
        .filter(|&c| shares[c].significant)
        .max_by(|&a, &b| shares[a].share.total_cmp(&shares[b].share));
    let trace = winner.map(|c| CoordinateTrace {
        coordinate: coordinates[c].name.into(),
        coordinate_unit: coordinates[c].unit.into(),
        unit: String::new(),
        x: at.iter().map(|&k| coordinates[c].values[k]).collect(),
        missing: at.iter().map(|&k| force[k]).collect(),
        explained: list.clone(),
    });
    (list, trace)
}
