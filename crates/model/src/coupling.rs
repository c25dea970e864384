//! Coupling of a free motor side to its measured motion.

use super::piecewise::{Cubic, Grid, RADIANS_A_STEP, smooth};
use crate::effects::Sensor;
use quell_signal::{CubicSpline, End};
use std::sync::Arc;

/// A critically damped spring from the motor side to its measured position:
/// `u'' = ... + w^2 (r - u) + 2 w (r' - u')`.
///
/// Nothing brings the motor side of a force-driven axis back, so that the error by a small force error grows
/// without bound. Coupled to the measured motion `r`, the simulation has a memory of `1 / w` only. A force
/// error `dF` then shows as `dF / (m w^2)`, where and when it occurs. This is an observer of fixed gain, and
/// its residual is the innovation.
///
/// Source: Forssell and Ljung, Identification of unstable systems using output error and Box-Jenkins model
/// structures, IEEE Trans. Automatic Control 45 (2000); Abarbanel, Creveling, Farsian, Kostuk, Dynamical state and
/// parameter estimation, SIAM J. Applied Dynamical Systems 8 (2009).
#[derive(Clone, Debug)]
pub struct Coupling {
    /// `w`, rad/s.
    pub rate: f64,
    /// `r`, as a spline.
    motion: Arc<CubicSpline>,
    /// Nodes of a grid, s.
    nodes: Arc<[f64]>,
    /// The same between these nodes.
    pieces: Arc<[Cubic]>,
}

impl Coupling {
    /// A coupling to samples of the motor side's motion; `None` where they are too few.
    pub(super) fn new([time, values]: [&[f64]; 2], rate: f64, grid: &Grid) -> Option<Self> {
        let (time, values) = smooth(time, values, RADIANS_A_STEP / rate);
        let motion = CubicSpline::new(&time, &values, End::NotAKnot).ok()?;
        let coupling = Self {
            rate,
            motion: Arc::new(motion),
            nodes: Arc::new([]),
            pieces: Arc::new([]),
        };
        Some(coupling.over(grid, &[]))
    }

    /// The same for other steps of the integration, and an encoder with these effects. If it shows at `t` the motion of another
    /// instant `f(t)`, the motion at an instant was measured at `f^-1` of it, which to first order is `2 t - f(t)`. Without that a
    /// motion ahead of the measured one would be pulled back to it.
    pub(super) fn over(&self, grid: &Grid, sensors: &[Box<dyn Sensor>]) -> Self {
        let shown = |t: f64| sensors.iter().fold(t, |t, sensor| sensor.instant(t));
        let (first, last) = self.motion.span();
        let in_time = shown(first) == first && shown(last) == last;
        if in_time && self.nodes[..] == grid.time[..] {
            return self.clone();
        }
        let measured = |t: f64| (2.0 * t - shown(t)).clamp(first, last);
        let piece = |ends: &[f64]| {
            let at = |t| {
                let t = measured(t);
                [self.motion.value(t), self.motion.derivative(t)]
            };
            Cubic::through(ends[1] - ends[0], at(ends[0]), at(ends[1]))
        };
        Self {
            nodes: match in_time {
                true => grid.time.as_slice().into(),
                false => Arc::new([]),
            },
            pieces: grid.time.windows(2).map(piece).collect(),
            ..self.clone()
        }
    }
}

/// A coupling with its position in the grid.
#[derive(Clone, Debug)]
pub struct Pull {
    coupling: Coupling,
    start: f64,
    piece: Cubic,
}

impl Pull {
    /// At the first step of the grid.
    pub(super) fn new(coupling: Coupling, grid: &Grid) -> Self {
        let (start, piece) = (grid.time[0], coupling.pieces.first().copied());
        Self {
            piece: piece.unwrap_or_default(),
            start,
            coupling,
        }
    }

    /// Moves to a step and its start.
    #[inline]
    pub(super) fn go_to(&mut self, step: usize, start: f64) {
        (self.piece, self.start) = (self.coupling.pieces[step], start);
    }

    /// Acceleration of a motor side at an instant of the step.
    #[inline]
    pub(super) fn acceleration(&self, time: f64, [position, velocity]: [f64; 2]) -> f64 {
        let [r, rate, _] = self.piece.at(time - self.start);
        let w = self.coupling.rate;
        w * w * (r - position) + 2.0 * w * (rate - velocity)
    }

    /// Position of a motor side that friction has held for a time `h` until an instant. The coupling is no
    /// force and does not move it, but its error decays as in motion.
    pub(super) fn forgotten(&self, time: f64, position: f64, h: f64) -> f64 {
        let measured = self.piece.at(time - self.start)[0];
        measured + (position - measured) * (-self.coupling.rate * h).exp()
    }
}
