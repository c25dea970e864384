//! Distortion: multiples of a mode's frequency that a nonlinear sensor or spring makes of it.
//!
//! A power law `x^n` makes `cos^n`, damped by `e^(-n s t)`, of a mode `e^(-s t) cos w t`: its frequency and rate are `n`
//! times those of the mode, its phase is `n` times that of the mode, and its amplitude is bounded.

use super::damped::Damped;
use nalgebra::Complex;
use std::cmp::Ordering;
use std::f64::consts::PI;

/// Standard deviations within which two values agree: 0.3 % by chance.
const AGREES: f64 = 3.0;
/// Relative standard deviation of a rate from which it is not told from zero: two of them, 5 % by chance.
const UNDAMPED: f64 = 0.5;

/// A fitted mode, and what the data say of it.
pub struct Component {
    /// The mode.
    pub mode: Damped,
    /// Its amplitude at the start of the strongest decay.
    pub amplitude: f64,
    /// Its amplitude and phase at the start of the first decay, along its strongest axis.
    pub phasor: Complex<f64>,
    /// Relative standard deviations of frequency and rate.
    pub deviations: [f64; 2],
    /// Number of decays that were fitted together.
    pub decays: usize,
}

impl Component {
    /// Whether its rate is told from zero; not of a rate at its bound, whose deviation is without end or none.
    pub fn is_damped(&self) -> bool {
        self.deviations[1] < UNDAMPED
    }
}

/// The order of a component that is a distortion of a stronger one; `None` if it is a mode of its own.
pub fn order(own: &Component, of: &Component) -> Option<u32> {
    let order = (own.mode.frequency / of.mode.frequency).round();
    let bend = of
        .mode
        .bend
        .map_or([0.0; 2], |bend| [bend.frequency, bend.rate]);
    let frequency = against(
        own,
        of,
        0,
        own.mode.frequency / (order * of.mode.frequency),
        bend[0],
    );
    let rate = against(own, of, 1, own.mode.rate / (order * of.mode.rate), bend[1]);
    let is_distortion = order >= 2.0
        && frequency == Ordering::Equal
        && own.amplitude < greatest(order, rate) * of.amplitude
        && has_phase(own, of, order);
    is_distortion.then_some(order as u32)
}

/// The greatest amplitude of a distortion, as a share of the mode's.
///
/// Of the rate `n s` it is that of one power. `x + c x^n` rises throughout, as the law of a sensor or a spring does,
/// while `n c x^(n-1) < 1`; its multiple is `c x^n / 2^(n-1)`. A spring's multiple is enlarged in an acceleration by
/// the mode's own response, `n^2 / (n^2 - 1)`. Higher powers, as of a sensor at its limit, make it with a higher rate:
/// the law that makes most of it is a switch, with `1 / n`. No law makes it with a lower one.
fn greatest(order: f64, rate: Ordering) -> f64 {
    match rate {
        Ordering::Less => 0.0,
        Ordering::Equal => order / (order * order - 1.0) / 2.0_f64.powf(order - 1.0),
        Ordering::Greater => 1.0 / order,
    }
}

/// How a ratio of frequencies (0) or rates (1) that should be 1 compares with it, within the deviations; with a mode
/// that depends on its amplitude, with any value that it takes.
fn against(own: &Component, of: &Component, which: usize, ratio: f64, bend: f64) -> Ordering {
    let beside = AGREES * own.deviations[which].hypot(of.deviations[which]);
    if ratio < 1.0 + bend.min(0.0) - beside {
        Ordering::Less
    } else if ratio > 1.0 + bend.max(0.0) + beside {
        Ordering::Greater
    } else {
        Ordering::Equal
    }
}

/// Whether the phase is the mode's, times the order, up to a sign. The phase of a damped sinusoid has the
/// deviation of the logarithm of its rate over the root of 2 (the inverse of its information matrix), in each
/// of several decays of one rate the root of their number times that; damping turns a forced response by at
/// most its ratio for each order. A mode that depends on its amplitude drifts in phase: nothing is told by it.
fn has_phase(own: &Component, of: &Component, order: f64) -> bool {
    if of.mode.bend.is_some() {
        return true;
    }
    let off = own.phasor.arg() - order * of.phasor.arg();
    let off = (off - PI * (off / PI).round()).abs();
    let deviation = own.deviations[1].hypot(order * of.deviations[1]);
    let deviation = deviation * (own.decays as f64 / 2.0).sqrt();
    off < AGREES * deviation + order * of.mode.rate / of.mode.frequency
}
