//! Which modes of a fit are told, and why others are not.

use super::FoundMode;
use super::damped::{Damped, Fit, Segment, amplitudes, coefficients};
use super::distortion::{self, Component};
use super::level::level;
use nalgebra::{Complex, DMatrix};
use quell_model::NO_RESONANCE;
use quell_shapers::{Mode, UncertainMode};
use std::f64::consts::TAU;

/// Smallest reported share of the strongest mode.
const LEAST: f64 = 0.005;
/// Number of periods in the record below which it is drift, not vibration, as it is where it is no resonance.
const PERIODS: f64 = 2.0;
/// A fitted vibration that is no mode of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOut {
    /// Its natural frequency, Hz.
    pub hertz: f64,
    /// Share of the largest mode's amplitude.
    pub share: f64,
    /// Why it is no mode.
    pub reason: Reason,
}

/// Why a fitted vibration is no mode of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reason {
    /// A nonlinear sensor or spring makes it of a mode.
    Distortion {
        /// The multiple.
        order: u32,
        /// The mode's natural frequency, Hz.
        of: f64,
    },
    /// It lies within the half-power width of a stronger mode, and describes how that departs from an
    /// exponential decay; the data cannot tell it from a mode.
    Beside {
        /// The stronger mode's natural frequency, Hz.
        of: f64,
    },
    /// Its damping ratio is not told from zero.
    Undamped,
}

/// The reported modes, the strongest first, and what else was fitted; drift is in neither. The noise at each mode, at least this
/// variance, makes the covariance of the inverse of the normal equations.
pub fn told(
    best: &Fit,
    segments: &[Segment],
    least: f64,
) -> Option<(Vec<FoundMode>, Vec<LeftOut>)> {
    let first = segments.first()?;
    let span = first.period * first.values.nrows() as f64;
    let covariance = covariance(best, segments, least);
    let all = components(best, segments, covariance.as_ref())?;
    let amplitude = |k: usize| all[k].amplitude;
    let vibrates = |k: &usize| {
        let mode = all[*k].mode;
        mode.rate < NO_RESONANCE * natural(&mode) && mode.frequency * span > TAU * PERIODS
    };
    let mut order: Vec<usize> = (0..all.len()).filter(vibrates).collect();
    order.sort_by(|a, b| amplitude(*b).total_cmp(&amplitude(*a)));
    // The amplitude of drift, or of what does not decay, says nothing: two slow terms may be large and cancel.
    let damped = order.iter().find(|k| all[**k].is_damped());
    let largest = amplitude(*damped?);
    let greatest = segments.iter().map(|own| own.values.amax());
    let greatest = greatest.fold(0.0, f64::max);
    order.retain(|k| {
        let is_real = all[*k].is_damped() || amplitude(*k) <= greatest;
        is_real && amplitude(*k) > LEAST * largest
    });
    let (mut kept, mut left_out): (Vec<usize>, Vec<LeftOut>) = (Vec::new(), Vec::new());
    for k in order {
        let stronger = || kept.iter().map(|of| &all[*of]);
        match reason(&all[k], stronger()) {
            None => kept.push(k),
            Some(reason) => left_out.push(LeftOut {
                hertz: natural(&all[k].mode) / TAU,
                share: amplitude(k) / largest,
                reason,
            }),
        }
    }
    let one = |k: usize| found(best, k, covariance.as_ref(), amplitude(k) / largest);
    Some((kept.into_iter().filter_map(one).collect(), left_out))
}

/// The covariance of the unknowns.
fn covariance(best: &Fit, segments: &[Segment], least: f64) -> Option<DMatrix<f64>> {
    let inverse = best.minimum.inverse.as_ref()?;
    let of = |mode: &Damped| {
        let loud = level(segments, &best.modes, &best.minimum.residual, mode);
        vec![loud.max(least).sqrt(); mode.unknowns()]
    };
    let noise: Vec<f64> = best.modes.iter().flat_map(of).collect();
    let count = noise.len();
    Some(DMatrix::from_fn(count, count, |a, b| {
        inverse[(a, b)] * noise[a] * noise[b]
    }))
}

/// Why a component is no mode beside the stronger ones; `None` if it is one.
fn reason<'a>(
    own: &Component,
    mut stronger: impl Iterator<Item = &'a Component>,
) -> Option<Reason> {
    if !own.is_damped() {
        return Some(Reason::Undamped);
    }
    stronger.find_map(|of| {
        let hertz = natural(&of.mode) / TAU;
        let beside = (own.mode.frequency - of.mode.frequency).abs() < of.mode.rate;
        let order = distortion::order(own, of);
        let distortion = order.map(|order| Reason::Distortion { order, of: hertz });
        distortion.or_else(|| beside.then_some(Reason::Beside { of: hertz }))
    })
}

/// The natural frequency of a mode, rad/s.
fn natural(mode: &Damped) -> f64 {
    mode.frequency.hypot(mode.rate)
}

/// The place of a mode among the unknowns.
fn place(modes: &[Damped], k: usize) -> usize {
    modes[..k].iter().map(Damped::unknowns).sum()
}

/// The modes of a fit with what the data say of each.
fn components(
    best: &Fit,
    segments: &[Segment],
    covariance: Option<&DMatrix<f64>>,
) -> Option<Vec<Component>> {
    let shares = amplitudes(segments, &best.modes)?;
    let linear = coefficients(segments, &best.modes)?;
    let first = linear.first()?;
    let one = |k: usize| {
        let phasor =
            |axis: usize| Complex::new(first[(1 + 2 * k, axis)], -first[(2 + 2 * k, axis)]);
        let at = place(&best.modes, k);
        let deviation = |by: usize| match covariance {
            Some(c) => c[(at + by, at + by)].max(0.0).sqrt(),
            None => f64::NAN,
        };
        Some(Component {
            mode: best.modes[k],
            amplitude: shares[k],
            phasor: (0..first.ncols())
                .map(phasor)
                .max_by(|a, b| a.norm().total_cmp(&b.norm()))?,
            deviations: [deviation(0), deviation(1)],
            decays: segments.len(),
        })
    };
    (0..best.modes.len()).map(one).collect()
}

fn found(best: &Fit, k: usize, covariance: Option<&DMatrix<f64>>, share: f64) -> Option<FoundMode> {
    let mode = best.modes[k];
    let place = place(&best.modes, k);
    let ratio = mode.rate / natural(&mode);
    let variance = |a: usize, b: usize| covariance.map_or(f64::NAN, |c| c[(place + a, place + b)]);
    let ratio_variance = variance(0, 0) + variance(1, 1) - 2.0 * variance(0, 1);
    Some(FoundMode {
        known: UncertainMode {
            mode: Mode::new(natural(&mode), ratio).ok()?,
            natural_frequency_std: natural(&mode) * variance(0, 0).max(0.0).sqrt(),
            damping_ratio_std: ratio * ratio_variance.max(0.0).sqrt(),
        },
        share,
        frequency_shift: mode.bend.map_or(0.0, |bend| bend.frequency),
        frequency_shift_std: mode.bend.map_or(0.0, |_| variance(2, 2).max(0.0).sqrt()),
        damping_shift: mode.bend.map_or(0.0, |bend| ratio * bend.rate),
    })
}
