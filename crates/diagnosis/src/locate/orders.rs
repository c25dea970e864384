//! Forces periodic in position: the spectrum of the missing force over position.

use std::f64::consts::TAU;

use quell_signal::fourier;

use super::peaks::lines;
use super::{MOST, Residual};

/// Cells over the travel. As many empty ones follow, for interpolation between the lines.
const CELLS: usize = 2048;
/// Fewest cycles over the travel of a line of the spectrum; fewer are in the skirt of its slope.
const FEWEST: f64 = 3.0;

/// Significant orders, in radians of phase per unit of position, the strongest first.
///
/// The sum of `d dx exp(-i k x)` over the path: a force that repeats with position adds up over all passages at
/// any speed, and other forces do not.
pub(super) fn orders(residual: &Residual, force: &[f64], at: &[usize]) -> Vec<f64> {
    let x = |k: usize| residual.motor[k][0];
    let bounds = bounds(residual, at);
    let travel = bounds.1 - bounds.0;
    if at.len() < 64 || travel <= 0.0 {
        return Vec::new();
    }
    let path = path(residual, at);
    let length: f64 = path.iter().map(|p| p.1).sum();
    let mut cells = vec![0.0; 2 * CELLS];
    let mean =
        path.iter().map(|&(k, dx)| force[k] * dx).sum::<f64>() / length.max(f64::MIN_POSITIVE);
    for &(k, dx) in &path {
        let cell = (x(k) - bounds.0) / travel * (CELLS - 2) as f64;
        let (whole, part) = (cell.floor(), cell.fract());
        cells[whole as usize] += (1.0 - part) * dx * (force[k] - mean);
        cells[whole as usize + 1] += part * dx * (force[k] - mean);
    }
    let resolution = TAU / (2.0 * CELLS as f64 / (CELLS - 2) as f64 * travel);
    // Half the frequency at which neighbouring stamps of a typical passage are half a cycle apart.
    let stride = length / path.len().max(1) as f64;
    let highest = (0.25 * TAU / stride / resolution) as usize;
    let first = (FEWEST * TAU / travel / resolution).ceil() as usize;
    let mut found: Vec<f64> = Vec::new();
    for line in lines(&power(cells), first, highest) {
        let order = line.at * resolution;
        let apart = |known: &f64| (known - order).abs() > 2.0 * TAU / travel;
        if found.len() < MOST && found.iter().all(apart) {
            found.push(order);
        }
    }
    found
}

/// Orders of fewer cycles over the travel than a line has, half a cycle apart: an order between two of them is
/// less than a quarter of a cycle from the nearer one.
pub(super) fn slow(residual: &Residual, at: &[usize]) -> Vec<f64> {
    let bounds = bounds(residual, at);
    let travel = bounds.1 - bounds.0;
    let cycles = (1..).map(|k| 0.5 * f64::from(k));
    let cycles = cycles.take_while(|cycles| *cycles < FEWEST && travel > 0.0);
    cycles.map(|cycles| cycles * TAU / travel).collect()
}

/// Least and greatest position of the motor side.
fn bounds(residual: &Residual, at: &[usize]) -> (f64, f64) {
    let positions = at.iter().map(|&k| residual.motor[k][0]);
    positions.fold((f64::INFINITY, f64::NEG_INFINITY), |b, x| {
        (b.0.min(x), b.1.max(x))
    })
}

/// The stamps of passages, and the distance from each to the next. Stamps at rest are left out, where only
/// noise moves the motor side.
fn path(residual: &Residual, at: &[usize]) -> Vec<(usize, f64)> {
    let way = |k: usize| (residual.motor[k + 1][0] - residual.motor[k][0]).abs();
    let steps = at.windows(2).filter(|w| w[1] == w[0] + 1);
    let mut path: Vec<(usize, f64)> = steps.map(|w| (w[0], way(w[0]))).collect();
    let mean = path.iter().map(|p| p.1).sum::<f64>() / at.len() as f64;
    path.retain(|p| p.1 > 0.1 * mean);
    path
}

fn power(cells: Vec<f64>) -> Vec<f64> {
    fourier(cells).iter().map(|line| line.norm_sqr()).collect()
}
