//! Starting values: products of sizes, and instants, frequencies and positions to try.
//!
//! Each costs a simulation. An effect whose response is proportional to its size needs one size of each sign,
//! or four phases. An effect whose response changes its shape with the size needs a grid.

use super::Scales;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Four phases a quarter turn apart: one of them is always within 45 degrees of the true one.
pub(super) const PHASES: [f64; 4] = [-FRAC_PI_2, 0.0, FRAC_PI_2, 0.99 * PI];

/// Bounds that let a phase move half a turn in either direction.
pub(super) fn phase_bounds(_scales: &Scales) -> (f64, f64) {
    (-TAU, TAU)
}

/// The sizes of one parameter, in this unit.
pub(super) fn sizes<const N: usize>(unit: f64, sizes: [f64; N]) -> Vec<Vec<f64>> {
    sizes.map(|size| vec![size * unit]).to_vec()
}

/// Every combination of one value of each axis.
pub(super) fn product(axes: &[&[f64]]) -> Vec<Vec<f64>> {
    axes.iter().fold(vec![Vec::new()], |rows, axis| {
        rows.iter()
            .flat_map(|row| axis.iter().map(|value| [&row[..], &[*value]].concat()))
            .collect()
    })
}

/// Candidates within bounds first, then a coarse grid; `count` in all.
fn fill(
    candidates: &[f64],
    coarse: impl IntoIterator<Item = f64>,
    bounds: (f64, f64),
    count: usize,
) -> Vec<f64> {
    let inside = |value: &f64| *value > bounds.0 && *value < bounds.1;
    let candidates = candidates.iter().copied();
    candidates
        .chain(coarse)
        .filter(inside)
        .take(count)
        .collect()
}

/// Instants to try.
pub(super) fn times(scales: &Scales, count: usize) -> Vec<f64> {
    let found = scales.candidate_events.len().min(count / 2);
    let rest = count - found;
    let coarse =
        (0..rest).map(|k| scales.span.0 + scales.duration() * (k as f64 + 0.5) / rest as f64);
    fill(
        &scales.candidate_events[..found],
        coarse,
        scales.span,
        count,
    )
}

/// Bounds of angular frequencies of a further mode: from a soft base to a stiff part, and the candidates.
pub(super) fn frequency_bounds(scales: &Scales) -> (f64, f64) {
    let own = scales.natural_frequency;
    let highest = scales
        .candidate_frequencies
        .iter()
        .copied()
        .fold(0.0, f64::max);
    // A period of half the recording can still be distinguished from a drift.
    let lowest = (2.0 * TAU / scales.duration()).min(0.1 * own);
    (lowest, (20.0 * own).max(2.0 * highest))
}

/// Angular frequencies to try.
pub(super) fn frequencies(scales: &Scales, count: usize) -> Vec<f64> {
    let found = scales.candidate_frequencies.len().min(count / 2);
    // Stiff parts, a soft base, and a load that hangs like a pendulum, near 1 Hz.
    let coarse =
        [2.5, 0.6, 1.5, 4.0, 0.35, 0.12, 7.0, 0.2].map(|factor| factor * scales.natural_frequency);
    let candidates = &scales.candidate_frequencies[..found];
    fill(candidates, coarse, frequency_bounds(scales), count)
}

/// Angular frequencies to try where only a range is known: those that something vibrates with, then a coarse grid of equal ratios.
pub(super) fn frequencies_between(
    scales: &Scales,
    (slowest, fastest): (f64, f64),
    count: i32,
) -> Vec<f64> {
    let ratio = (fastest / slowest).powf(1.0 / f64::from(count));
    let coarse = (0..count).map(|k| slowest * ratio.powi(k));
    let closed = (slowest.next_down(), fastest.next_up());
    fill(&scales.candidate_frequencies, coarse, closed, usize::MAX)
}

/// Length of the range of positions, never 0.
pub(super) fn reach(scales: &Scales) -> f64 {
    scales.travel().max(scales.deformation)
}

/// The order that excites the axis' mode at full speed: `N v = w`.
pub(super) fn resonant_order(scales: &Scales) -> f64 {
    scales.natural_frequency / scales.velocity
}

/// Bounds of the orders of a periodic error, in radians per unit of position.
pub(super) fn order_bounds(scales: &Scales) -> (f64, f64) {
    let most = scales.candidate_orders.iter().copied().fold(0.0, f64::max);
    let fastest = (300.0 * TAU / reach(scales)).max(30.0 * resonant_order(scales));
    // With a spring to ground, less than a period is equivalent to offset, slope and cubic of the spring's law.
    // Without any spring it is equivalent to a constant force and a slow change with position.
    let slowest = match scales.forced || scales.rigid {
        true => TAU / reach(scales),
        false => (0.5 * TAU / reach(scales)).min(0.3 * resonant_order(scales)),
    };
    (slowest, fastest.max(2.0 * most))
}

/// Orders to try.
pub(super) fn orders(scales: &Scales, count: usize) -> Vec<f64> {
    let found = scales.candidate_orders.len().min(count.div_ceil(2));
    let resonant = [1.0, 2.0, 0.5, 4.0].map(|factor| factor * resonant_order(scales));
    let periods = [3.0, 10.0, 30.0].map(|periods| periods * TAU / reach(scales));
    let coarse = resonant.into_iter().chain(periods);
    let candidates = &scales.candidate_orders[..found];
    fill(candidates, coarse, order_bounds(scales), count)
}

/// An instant well inside the recording, not 0.
pub(super) fn typical_time(scales: &Scales) -> f64 {
    not_zero(scales.span.0, scales.duration())
}

/// A position well inside the range of positions, not 0.
pub(super) fn typical_position(scales: &Scales) -> f64 {
    not_zero(scales.position.0, reach(scales))
}

fn not_zero(start: f64, length: f64) -> f64 {
    let value = start + 0.6 * length;
    if value.abs() > 0.1 * length {
        value
    } else {
        start + 0.4 * length
    }
}
