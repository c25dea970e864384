//! Whether a decay is free: nothing that drives its strongest mode on has made its start, and one that falls by little decays
//! as a free one does.
//!
//! A decay is seen by its fall. What is driven falls, too, by chance: [driven_on](super::driven_on) tells them apart. One that
//! ends early, as a light mode's in a short recording, falls by little, as does a machine's line whose loudness drifts. The envelope
//! of a free decay is an exponential. That of a line which drifts is a straight one to first order, of amplitude and of phase; it
//! has no fewer unknowns. The likelihood ratio of both, `N ln(S_line / S_decay)`, is very strong evidence from 10 on.
//!
//! A mode that depends on its amplitude has an envelope of no known form, and is not told by that.
//!
//! Source: R. E. Kass and A. E. Raftery, J. American Statistical Association 90 (1995).

use super::damped::{Damped, Fit, Segment, basis, project};
use super::driven_on::is_let_go;
use nalgebra::DMatrix;
use quell_signal::STRONG;

/// Unknowns of a mode on one axis.
const UNKNOWNS: usize = 4;

/// Least share of the variance that modes explain in a free decay, as opposed to a machine at work.
const EXPLAINED: f64 = 0.8;

/// What says that a stretch is a free decay, besides strong evidence for damped modes that are let go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// That the motor side rests, or how far it falls; and the share that modes explain.
    Before,
    /// The envelope of its strongest mode, and the share that modes explain.
    After,
    /// Of a decay in noise: that the motor side rests, and the envelope of its strongest mode.
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

/// Whether the strongest mode of a fit is free; `frequency` is its damped one, rad/s, `independent` the number of independent
/// samples, and the recording is so long, s.
pub fn is_free(
    (fit, segments): (&Fit, &[Segment]),
    seen: Seen,
    [frequency, independent, duration]: [f64; 3],
) -> bool {
    let off = |mode: &Damped| (mode.frequency - frequency).abs();
    let nearest = fit.modes.iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let Some(own) = nearest else {
        return false;
    };
    let is_exponential = || {
        let [segment] = segments else {
            return false;
        };
        let evidence = drifting(fit, segment, own).map(|left| (left / fit.minimum.cost).ln());
        own.bend.is_none() && evidence.is_some_and(|evidence| independent * evidence > STRONG)
    };
    (seen == Seen::Before || is_exponential()) && is_let_go(fit, segments, own, duration)
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
