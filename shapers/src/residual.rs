//! The residual vibration of a mode after a train.

use crate::pole::unit_pole;
use crate::{Impulse, ImpulseTrain, ShaperError};
use num_complex::Complex64;
use num_traits::Float;

/// A hump that touches the tolerance counts as below it: the solved humps are exact to about 1e-13,
/// and 1e-9 is far below any vibration that matters.
const TOUCHING: f64 = 1e-9;
/// Step of the search for a band's edges, relative to the design frequency: well below the narrowest
/// hump of the table (0.3 of the design frequency).
const SEARCH_STEP: f64 = 1e-3;
/// The search for the upper edge ends at this multiple of the design frequency.
const SEARCH_END: f64 = 10.0;

/// Residual vibration of a train: the amplitude left after the last impulse, over the amplitude of
/// the response to one impulse of amplitude 1 given at the instant of that LAST impulse.
///
/// `V(omega, xi) = exp(-xi omega t_n) sqrt(C^2 + S^2)`,
/// `C, S = sum A_i exp(xi omega t_i) cos, sin (omega_d t_i)`.
///
/// * `frequency`: `omega`, rad/s, at or above 0 (0 gives 1);
/// * `damping_ratio`: `xi` in `[0, 1)`.
///
/// For the ratio to the unshaped response at the same instant see [`same_instant_ratio`].
///
/// # Example
/// ```
/// use quell_shapers::{Mode, Shaper, Zv, residual_vibration};
/// let zv = Zv.design(Mode::new(1.0, 0.0).unwrap()).unwrap();
/// assert!(residual_vibration(&zv, 1.0, 0.0) < 1e-15);
/// // ZV without damping leaves |cos(pi omega / 2 omega_0)|.
/// assert!((residual_vibration(&zv, 2.0, 0.0) - 1.0).abs() < 1e-15);
/// ```
/// Source: Singer and Seering 1990, eq. (5), with the amplitudes normalised to sum 1.
pub fn residual_vibration(train: &ImpulseTrain, frequency: f64, damping_ratio: f64) -> f64 {
    let impulses = train.impulses().iter().copied();
    residual_of(impulses, train.duration(), frequency, damping_ratio)
}

/// [`residual_vibration`] of impulses of which the last is at `end` s.
pub(crate) fn residual_of(
    impulses: impl Iterator<Item = Impulse>,
    end: f64,
    frequency: f64,
    damping_ratio: f64,
) -> f64 {
    let pole = unit_pole(damping_ratio).scale(frequency);
    impulses
        .map(|impulse| {
            pole.scale(end - impulse.time)
                .exp()
                .scale(impulse.amplitude)
        })
        .sum::<Complex64>()
        .norm()
}

/// Shaped over unshaped amplitude at the same instant: `V(omega, xi) exp(xi omega t_n)`.
///
/// Here the unshaped move starts with the FIRST impulse and has already decayed while the train
/// lasts, so that this ratio is larger than [`residual_vibration`] where there is damping.
///
/// * `frequency`: rad/s; `damping_ratio`: in `[0, 1)`.
pub fn same_instant_ratio(train: &ImpulseTrain, frequency: f64, damping_ratio: f64) -> f64 {
    let growth = Float::exp(damping_ratio * frequency * train.duration());
    residual_vibration(train, frequency, damping_ratio) * growth
}

/// [`residual_vibration`] over frequency: `points` pairs (rad/s, V), evenly spaced, ends included.
pub fn residual_curve(
    train: &ImpulseTrain,
    damping_ratio: f64,
    from: f64,
    to: f64,
    points: usize,
) -> impl Iterator<Item = (f64, f64)> + '_ {
    let step = (to - from) / points.saturating_sub(1).max(1) as f64;
    (0..points).map(move |k| {
        let frequency = from + step * k as f64;
        (
            frequency,
            residual_vibration(train, frequency, damping_ratio),
        )
    })
}

/// The band of frequencies around a design frequency in which the residual stays at or below a
/// tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower edge over the design frequency.
    pub from: f64,
    /// Upper edge over the design frequency; 10 where the residual stays below the tolerance.
    pub to: f64,
}

impl Band {
    /// Insensitivity: width of the band over the design frequency.
    pub fn width(&self) -> f64 {
        self.to - self.from
    }
}

/// Insensitivity `I(tolerance)`: the band around `frequency` (rad/s) in which `V <= tolerance`.
///
/// `None` where `V` is above the tolerance at `frequency` itself. The edges are bisected to the
/// last place; at most some 9000 evaluations of `V`: not for the tick.
///
/// # Errors
/// [`ShaperError::OutOfRange`] where `frequency` or `tolerance` is not a finite number above 0.
///
/// # Example
/// ```
/// use quell_shapers::{Mode, Shaper, Zv, insensitivity};
/// let zv = Zv.design(Mode::new(1.0, 0.0).unwrap()).unwrap();
/// let band = insensitivity(&zv, 0.0, 1.0, 0.05).unwrap().unwrap();
/// // |cos(pi r / 2)| <= 0.05, so the width is 4 asin(0.05) / pi.
/// assert!((band.width() - 0.063689).abs() < 1e-6);
/// ```
/// Source: Vaughan, Yano and Singhose 2008.
pub fn insensitivity(
    train: &ImpulseTrain,
    damping_ratio: f64,
    frequency: f64,
    tolerance: f64,
) -> Result<Option<Band>, ShaperError> {
    for (name, value) in [("frequency", frequency), ("tolerance", tolerance)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(ShaperError::OutOfRange { name, value });
        }
    }
    let holds = |ratio: f64| {
        residual_vibration(train, ratio * frequency, damping_ratio) <= tolerance + TOUCHING
    };
    if !holds(1.0) {
        return Ok(None);
    }
    let below = edge(&holds, -SEARCH_STEP, 0.0);
    let above = edge(&holds, SEARCH_STEP, SEARCH_END);
    Ok(Some(Band {
        from: below,
        to: above,
    }))
}

/// Walks from 1 by `step` until `holds` fails, then bisects; `end` where it never fails.
fn edge(holds: &impl Fn(f64) -> bool, step: f64, end: f64) -> f64 {
    let steps = ((end - 1.0) / step) as usize;
    let Some(first) = (1..=steps).find(|&k| !holds(1.0 + step * k as f64)) else {
        return end;
    };
    let (mut inside, mut outside) = (1.0 + step * (first - 1) as f64, 1.0 + step * first as f64);
    for _ in 0..50 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            inside = middle
        } else {
            outside = middle
        }
    }
    inside
}
