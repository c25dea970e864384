//! Forces periodic in position: the spectrum of the missing force over position.

use std::f64::consts::TAU;

use realfft::RealFftPlanner;

use super::peaks::lines;
use super::{MOST, Residual};

/// Cells over the travel, and as many empty ones behind, which interpolate between the lines.
const CELLS: usize = 2048;
/// Cycles over the travel from which a force is periodic rather than a slope.
const FEWEST: f64 = 3.0;

/// Radians of phase for one unit of position, the strongest first, with the share of the force's
/// variance that each explains.
///
/// The sum of `d dx exp(-i k x)` over the path: a force that repeats with position adds up over all
/// passages, whatever their speed, and any other does not.
pub(super) fn orders(residual: &Residual, force: &[f64], at: &[usize]) -> Vec<(f64, f64)> {
    let x = |k: usize| residual.motor[k][0];
    let bounds = at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |b, &k| {
        (b.0.min(x(k)), b.1.max(x(k)))
    });
    let travel = bounds.1 - bounds.0;
    if at.len() < 64 || travel <= 0.0 {
        return Vec::new();
    }
    let mut path: Vec<(usize, f64)> = at
        .windows(2)
        .filter(|w| w[1] == w[0] + 1)
        .map(|w| (w[0], (x(w[1]) - x(w[0])).abs()))
        .collect();
    let length: f64 = path.iter().map(|p| p.1).sum();
    // Where it stands, noise alone moves it.
    path.retain(|p| p.1 > 0.1 * length / at.len() as f64);
    let mean =
        path.iter().map(|&(k, dx)| force[k] * dx).sum::<f64>() / length.max(f64::MIN_POSITIVE);
    let mut cells = vec![0.0; 2 * CELLS];
    for &(k, dx) in &path {
        let cell = (x(k) - bounds.0) / travel * (CELLS - 2) as f64;
        let (whole, part) = (cell.floor(), cell.fract());
        cells[whole as usize] += (1.0 - part) * dx * (force[k] - mean);
        cells[whole as usize + 1] += part * dx * (force[k] - mean);
    }
    let transform = RealFftPlanner::<f64>::new().plan_fft_forward(2 * CELLS);
    let mut spectrum = transform.make_output_vec();
    if transform.process(&mut cells, &mut spectrum).is_err() {
        return Vec::new();
    }
    let power: Vec<f64> = spectrum.iter().map(|line| line.norm_sqr()).collect();
    let resolution = TAU / (2.0 * CELLS as f64 / (CELLS - 2) as f64 * travel);
    // Half the frequency at which neighbouring stamps of a typical passage are half a cycle apart.
    let stride = length / path.len().max(1) as f64;
    let highest = (0.25 * TAU / stride / resolution) as usize;
    let first = (FEWEST * TAU / travel / resolution).ceil() as usize;
    let mut found: Vec<(f64, f64)> = Vec::new();
    for line in lines(&power, first, highest.min(power.len())) {
        let order = line.at * resolution;
        if found.len() < MOST
            && found
                .iter()
                .all(|f| (f.0 - order).abs() > 2.0 * TAU / travel)
        {
            found.push((order, share(residual, force, at, order)));
        }
    }
    found
}

/// Share of the force's variance that a sine of this order explains.
fn share(residual: &Residual, force: &[f64], at: &[usize], order: f64) -> f64 {
    let n = at.len() as f64;
    let mean = at.iter().map(|&k| force[k]).sum::<f64>() / n;
    let (mut sums, mut whole) = ([0.0; 5], 0.0);
    for &k in at {
        let (s, c) = (order * residual.motor[k][0]).sin_cos();
        let f = force[k] - mean;
        whole += f * f;
        let products = [s * s, s * c, c * c, s * f, c * f];
        sums.iter_mut().zip(products).for_each(|(sum, p)| *sum += p);
    }
    let [ss, sc, cc, sf, cf] = sums;
    let determinant = ss * cc - sc * sc;
    if determinant > 1e-9 * n * n && whole > 0.0 {
        ((cc * sf * sf - 2.0 * sc * sf * cf + ss * cf * cf) / determinant / whole).clamp(0.0, 1.0)
    } else {
        0.0
    }
}
