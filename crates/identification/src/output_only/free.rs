//! Whether a decay that falls by little is free: its strongest mode decays as one does, and leaves noise.
//!
//! A decay is seen by its fall. One that ends early, as a light mode's in a short recording, falls by little. So does by chance
//! what is driven: a machine's line, whose loudness drifts, or the response to a noise. What tells them apart:
//!
//! - the envelope of a free decay is an exponential. That of a line which drifts is a straight one to first order, of amplitude
//!   and of phase; it has no fewer unknowns. The likelihood ratio of both, `N ln(S_line / S_decay)`, is very strong evidence
//!   from 10 on;
//! - nothing drives it. A force that goes on turns amplitude and phase at random, and what the fit leaves is then loudest at the
//!   mode. Without it, the lines of the spectrum about the mode are as loud as those beside them: by Fisher's test of two
//!   variances.
//!
//! A mode that depends on its amplitude has an envelope of no known form, and is not told by these.
//!
//! Source: R. E. Kass and A. E. Raftery, J. American Statistical Association 90 (1995); R. A. Fisher, Proc. Int. Congress of
//! Mathematics, Toronto (1924): the logarithm of the ratio of two variances of `a` and `b` degrees of freedom has the variance
//! `2 / a + 2 / b`.

use super::damped::{Damped, Fit, Segment, basis, project};
use crate::evidence::STRONG;
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Lines of the spectrum on either side of a mode that are about it: beyond them a line has less than a sixtieth of its energy.
const ABOUT: f64 = 2.5;
/// Further ones on either side that are beside it.
const BESIDE: f64 = 8.0;
/// Standard deviations of a logarithm within which two variances are one: 999 of 1000, to one side.
const CERTAIN: f64 = 3.0;
/// Unknowns of a mode on one axis.
const UNKNOWNS: usize = 4;

/// Least share of the variance that modes explain in a free decay, as opposed to a machine at work.
const EXPLAINED: f64 = 0.8;

/// What says that a stretch is a free decay, besides strong evidence for damped modes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// That nothing drives it, or how far it falls; and the share that modes explain.
    Before,
    /// The envelope of its strongest mode and what that leaves ([`is_free`]), and the share that modes explain.
    After,
    /// Of a decay in noise: that nothing drives it, the envelope of its strongest mode, and what that leaves.
    Faint,
}

impl Seen {
    /// The least share of the variance that modes explain.
    pub fn least(self) -> f64 {
        match self {
            Self::Before | Self::After => EXPLAINED,
            Self::Faint => 0.0,
        }
    }
}

/// Whether a mode of the fit to a single decay is free; `frequency` is its damped one, rad/s, and `independent` the number of
/// independent samples.
pub fn is_free(fit: &Fit, segments: &[Segment], frequency: f64, independent: f64) -> bool {
    let [segment] = segments else {
        return false;
    };
    let lines = |frequency: f64| frequency * segment.period * segment.values.nrows() as f64 / TAU;
    let is_about = |own: &&Damped| (lines(own.frequency) - lines(frequency)).abs() <= ABOUT;
    let [own] = fit.modes.iter().filter(is_about).collect::<Vec<_>>()[..] else {
        return false;
    };
    let evidence = drifting(fit, segment, own).map(|left| (left / fit.minimum.cost).ln());
    own.bend.is_none()
        && evidence.is_some_and(|evidence| independent * evidence > STRONG)
        && leaves_noise(fit, segment, lines(frequency))
}

/// The sum of squares that is left where a mode is replaced by a line whose amplitude and phase drift.
fn drifting(fit: &Fit, segment: &Segment, own: &Damped) -> Option<f64> {
    let others: Vec<Damped> = fit
        .modes
        .iter()
        .filter(|other| *other != own)
        .copied()
        .collect();
    let kept = basis(segment, &others)?;
    let (rows, columns) = kept.shape();
    let middle = rows as f64 / 2.0;
    let all = DMatrix::from_fn(rows, columns + UNKNOWNS, |row, column| {
        let Some(added) = column.checked_sub(columns) else {
            return kept[(row, column)];
        };
        let (sin, cos) = (own.frequency * segment.period * row as f64).sin_cos();
        let straight = if added < 2 {
            1.0
        } else {
            row as f64 / middle - 1.0
        };
        straight * if added % 2 == 0 { cos } else { sin }
    });
    let left = &segment.values - &all * project(&all, &segment.values)?;
    Some(left.norm_squared())
}

/// Whether what a fit leaves is no louder about a mode, at this line of the spectrum, than beside it.
fn leaves_noise(fit: &Fit, segment: &Segment, mode: f64) -> bool {
    let [[inside, about], [outside, beside]] = variances(fit, segment, mode);
    let a = about - (UNKNOWNS * segment.values.ncols()) as f64;
    let ratio = inside / a / (outside / beside);
    a >= 2.0 && beside >= 2.0 && ratio.ln() < CERTAIN * (2.0 / a + 2.0 / beside).sqrt()
}

/// Energy and number of values of the residual's lines about a mode, and of those beside it.
fn variances(fit: &Fit, segment: &Segment, mode: f64) -> [[f64; 2]; 2] {
    let mut found = [[0.0; 2]; 2];
    let rows = segment.values.nrows();
    for axis in fit.minimum.residual.as_slice().chunks_exact(rows) {
        // The offset takes the first line.
        for (line, value) in quell_signal::fourier(axis.to_vec())
            .iter()
            .enumerate()
            .skip(1)
        {
            let away = (line as f64 - mode).abs();
            if away <= ABOUT + BESIDE {
                let place = &mut found[usize::from(away > ABOUT)];
                place[0] += value.norm_sqr();
                place[1] += 2.0;
            }
        }
    }
    found
}
