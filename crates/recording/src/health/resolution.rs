//! Resolution of a column's values: white noise and the quantisation step.

use super::median;

/// Orders of difference that are tried for the noise.
const ORDERS: std::ops::RangeInclusive<usize> = 2..=6;
/// `median(|x|) / sigma` of a Gaussian.
const MEDIAN_ABSOLUTE: f64 = 0.674_489_750_196_081_7;

/// Standard deviation of the white noise on top of a smooth signal.
///
/// The k-th difference of white noise has the variance `sigma^2 C(2k, k)`; that of a signal at angular
/// frequency w, sampled with period T, shrinks as `(w T)^k`. Each order therefore gives sigma or more (by the
/// median of absolute values, so that steps do not count), and the least value over the orders 2 to 6 is taken.
/// It is 0 if more than half of the differences vanish: the noise is then below the quantisation step. What the rounding of
/// doubles leaves of such differences is 0, too. `None` below 20 samples.
///
/// Source: von Neumann (1941) for k = 1; Gasser, Sroka, Jennen-Steinmetz (1986) for k = 2.
pub fn noise_std(values: &[f64]) -> Option<f64> {
    let orders = noise_by_order(values);
    let least = orders.into_iter().fold(f64::INFINITY, f64::min);
    let largest = values.iter().fold(0.0_f64, |most, own| most.max(own.abs()));
    let least = if least <= DUST * largest { 0.0 } else { least };
    (values.len() >= 20).then_some(least)
}

/// Whether values show white noise of a quantisation step or more. One value is then seen many times in a row only where the
/// sensor gives none: a joint that rests, or is held by friction or a stop, shows the noise as one that moves.
///
/// From one order of difference to the next the standard deviation of white noise stays (see [`noise_std`]), and what a
/// motion of angular frequency w leaves in it falls by half of `w T`. It is noise where it falls by less than half, so that
/// no motion with six samples a period or more is taken for it.
pub fn shows_noise(values: &[f64], step: f64) -> bool {
    let orders = noise_by_order(values);
    let [.., fifth, sixth] = orders;
    let is_white = sixth > 0.5 * fifth;
    let is_seen = noise_std(values).is_some_and(|noise| noise > 0.0 && noise >= step);
    is_seen && is_white
}

/// The noise, as a share of the largest value, that the rounding of doubles can make: each of the terms of a sixth difference
/// is off by half of an epsilon at most, before and after its unit was converted.
const DUST: f64 = 4.0 * f64::EPSILON;

/// Whether noise of this standard deviation is below what rounding to a step makes, `step / sqrt(12)`: it cannot be told then.
///
/// Source: B. Widrow, I. Kollar, Quantization Noise, Cambridge University Press 2008.
pub fn is_rounding(noise_std: f64, step: f64) -> bool {
    noise_std < step / f64::sqrt(12.0)
}

/// The standard deviation of white noise by each order of difference.
fn noise_by_order(values: &[f64]) -> [f64; 5] {
    let mut differences = values.to_vec();
    let mut all = [f64::INFINITY; 5];
    let mut central_binomial = 1.0; // C(2k, k)
    for order in 1..=*ORDERS.end() {
        differences = differences
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect();
        let k = order as f64;
        central_binomial *= (4.0 * k - 2.0) / k;
        if ORDERS.contains(&order) {
            let spread = median(differences.iter().map(|value| value.abs()).collect());
            all[order - ORDERS.start()] = spread / MEDIAN_ABSOLUTE / f64::sqrt(central_binomial);
        }
    }
    all
}

/// Fewest distinct values for a step: with 7 increments a random set would pass the test of [`quantum`] with
/// probability 0.2^7, about 1e-5.
const DISTINCT: usize = 8;
/// Tolerance of an increment's distance from a whole number of steps, as a share of a step.
const MISS: f64 = 0.1;

/// The quantisation step q: the increments between neighbouring distinct values are whole numbers
/// of it.
///
/// The least increment is the first guess; the others, from the least upwards, refine it by least
/// squares, `q = sum(g k) / sum(k^2)` with `k = round(g / q)`. Accepted where 99 % of them lie
/// within 0.1 q of a whole number of steps (a random set: 20 %). Numbers printed with few decimals
/// are quantised too: their last digit is found. Nothing for fewer than 8 distinct values.
pub fn quantum(values: &[f64]) -> Option<f64> {
    let mut distinct = values.to_vec();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if distinct.len() < DISTINCT {
        return None;
    }
    let mut increments: Vec<f64> = distinct.windows(2).map(|pair| pair[1] - pair[0]).collect();
    increments.sort_by(f64::total_cmp);
    let largest = distinct
        .iter()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let mut step = increments[0];
    // Differences near the rounding of a double give no information about the sensor.
    if step < 1e3 * f64::EPSILON * largest {
        return None;
    }
    let (mut moment, mut weight, mut whole) = (0.0, 0.0, 0_usize);
    for increment in &increments {
        let steps = (increment / step).round();
        if (increment / step - steps).abs() <= MISS {
            whole += 1;
            moment += increment * steps;
            weight += steps * steps;
            step = moment / weight;
        }
    }
    (whole * 100 >= increments.len() * 99).then_some(step)
}
