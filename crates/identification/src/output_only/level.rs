//! How loud what a fit leaves is at a mode.
//!
//! Frequency and damping of a mode feel the noise at its own line alone. Where the noise is not white, as where something drives
//! the mode on a little, or a law does not describe it to the end, that is far from its mean. The lines of the spectrum about the
//! mode give it: `2 |X|^2 / n` of each has two degrees of freedom, of which the fit takes what it has there of unknowns.
//!
//! Source: P. Stoica and R. Moses, Spectral Analysis of Signals, Prentice Hall (2005), chapter 2.

use super::damped::{Damped, Segment};
use nalgebra::DVector;
use std::f64::consts::TAU;

/// Lines of the spectrum on either side of a mode that are about it, and within which two modes are at the same one:
/// beyond them a line has less than a sixtieth of its energy.
pub const ABOUT: f64 = 2.5;

/// The variance that white noise as loud as a residual about a mode would have, beside these modes of its fit.
pub fn level(segments: &[Segment], modes: &[Damped], left: &DVector<f64>, own: &Damped) -> f64 {
    let (mut energy, mut free, mut shared, mut from) = (0.0, 0.0, 0.0_f64, 0);
    for segment in segments {
        let (rows, axes) = segment.values.shape();
        let line = |mode: &Damped| mode.frequency * segment.period * rows as f64 / TAU;
        let is_about = |other: &f64| (other - line(own)).abs() <= ABOUT;
        let beside: Vec<&Damped> = modes.iter().filter(|mode| is_about(&line(mode))).collect();
        let unknowns: usize = beside.iter().map(|mode| mode.unknowns()).sum();
        shared = shared.max(unknowns as f64);
        free -= (2 * beside.len() * axes) as f64;
        for axis in left.as_slice()[from..from + rows * axes].chunks_exact(rows) {
            // The offset takes the first line.
            let lines = quell_signal::fourier(axis.to_vec()).into_iter().enumerate();
            for (_, value) in lines.skip(1).filter(|(line, _)| is_about(&(*line as f64))) {
                energy += 2.0 * value.norm_sqr() / rows as f64;
                free += 2.0;
            }
        }
        from += rows * axes;
    }
    energy / (free - shared).max(1.0)
}
