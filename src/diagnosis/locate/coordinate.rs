//! Which coordinate the missing force follows.

use super::Residual;
use super::correlation::length;
use super::phases::REST;
use crate::diagnosis::CoordinateTrace;

/// Standard deviations above chance that a coordinate must reach: one in ten thousand, for seven are
/// tried.
const CHANCE: f64 = 3.72;

/// A coordinate by name, in the order of preference where two explain alike.
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

/// What the force is held against.
pub(super) fn coordinates(residual: &Residual) -> Vec<Coordinate> {
    let motion = |f: &dyn Fn(&[f64; 3], &[f64; 3]) -> f64| -> Vec<f64> {
        residual
            .motor
            .iter()
            .zip(residual.link)
            .map(|(m, l)| f(m, l))
            .collect()
    };
    let deformation = motion(&|m, l| l[0] - m[0]);
    let has_link = deformation.iter().any(|d| *d != 0.0);
    let mut found = Vec::new();
    let mut add = |name, unit, values| found.push(Coordinate { name, unit, values });
    let wound = if has_link {
        &deformation
    } else {
        &motion(&|m, _| m[0])
    };
    let state = hysteresis(wound);
    if has_link {
        add("deformation rate", "", motion(&|m, l| l[1] - m[1]));
        add("deformation", "", deformation);
    }
    add("velocity", "", motion(&|_, l| l[1]));
    add("acceleration", "", motion(&|_, l| l[2]));
    add("position", "", motion(&|_, l| l[0]));
    add("hysteresis", "", state);
    add("time", "s", residual.time.to_vec());
    found
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

/// Which stamps tell: those in motion, unless nearly all is rest.
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
/// `eta^2` is the share of the variance between bins. Where the force remembers itself, bins that
/// hold stretches of neighbouring stamps (of time, of position) differ by chance; with a correlation
/// `rho` the expected share is `(sum_b (1/n_b) sum_ij rho_ij - G) / (N - G)`, `G = sum_ij rho_ij / N`.
/// The share is corrected for it, and significant above it by the deviation of the Beta distribution
/// that has the number of independent values `N^2 / sum_ij rho_ij^2`.
///
/// Source: Kelley, "An unbiased correlation ratio measure" (1935), here with correlation.
pub(super) fn explained(time: &[f64], force: &[f64], x: &[f64], at: &[usize]) -> Explained {
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
    let ratio = between(&series, &bins, count);
    let deviation = (2.0 * expected * (1.0 - expected) / (independent + 2.0)).sqrt();
    Explained {
        share: ((ratio - expected) / (1.0 - expected)).clamp(0.0, 1.0),
        significant: ratio > expected + CHANCE * deviation,
    }
}

/// Bins of about equal count; equal values share a bin.
fn bins(x: &[f64], count: usize) -> Vec<usize> {
    let mut sorted = x.to_vec();
    sorted.sort_by(f64::total_cmp);
    let edges: Vec<f64> = (1..count).map(|b| sorted[b * x.len() / count]).collect();
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

/// Share of the variance that lies between bins.
fn between(series: &[f64], bins: &[usize], count: usize) -> f64 {
    let n = series.len() as f64;
    let mean = series.iter().sum::<f64>() / n;
    let (mut sums, mut members) = (vec![0.0; count], vec![0.0; count]);
    let mut whole = 0.0;
    for (x, &bin) in series.iter().zip(bins) {
        sums[bin] += x - mean;
        members[bin] += 1.0;
        whole += (x - mean).powi(2);
    }
    let part: f64 = sums
        .iter()
        .zip(&members)
        .filter(|(_, n)| **n > 0.0)
        .map(|(s, n)| s * s / n)
        .sum();
    if whole > 0.0 { part / whole } else { 0.0 }
}

/// Every coordinate's share, and the trace over the best one that is above chance.
pub(super) fn best(
    residual: &Residual,
    force: &[f64],
    at: &[usize],
) -> (Vec<(String, f64)>, Option<CoordinateTrace>) {
    let coordinates = coordinates(residual);
    let shares: Vec<Explained> = coordinates
        .iter()
        .map(|c| explained(residual.time, force, &c.values, at))
        .collect();
    let list: Vec<(String, f64)> = coordinates
        .iter()
        .zip(&shares)
        .map(|(c, e)| (c.name.to_string(), e.share))
        .collect();
    // The last of equals would win: reversed, the first does.
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
