//! The known modes of a joint, and the residual that is allowed.

use quell_shapers::UncertainMode;
use quell_trajectories::AxisProfile;

use super::swing::Swing;
use super::{Moving, Tolerance};

/// Standard deviations to each side of a box: 95 % of a Gaussian.
const WITHIN: f64 = 2.0;
/// Nodes over a box for each hump of the residual over frequency; there is one hump for each Hz and second.
const PER_HUMP: f64 = 6.0;
/// Most intervals between nodes over the frequency. Of random long moves 100 of them find nothing faster.
const MOST: usize = 24;
/// Refinement of the nodes of the check, on a move of any length: a parabola through three of them errs by 1e-5 of a hump.
const FINER: usize = 4;
/// Nodes of the check over the damping ratio, over which there are no humps.
const OVER_DAMPING: usize = 5;
/// Damping ratio above which there is no oscillation.
const HIGHEST_DAMPING: f64 = 0.99;

/// The modes of a joint within their boxes, and the residual that is allowed.
pub struct Known {
    boxes: Vec<ModeBox>,
    /// Amplitude that the unshaped move leaves, rad, and the allowed one.
    pub unshaped: f64,
    pub allowed: f64,
    /// Distance of the tip from the axis, m.
    pub lever: f64,
}

/// Ranges of the natural frequency (rad/s) and of the damping ratio.
#[derive(Clone, Copy)]
struct ModeBox {
    frequency: [f64; 2],
    damping_ratio: [f64; 2],
}

impl Known {
    /// The known modes of a joint; `full` is the unshaped course of its path parameter.
    pub fn new(joint: &Moving, full: &AxisProfile, tolerance: Tolerance) -> Self {
        let duration = full.phases().iter().map(|phase| phase.duration).sum();
        let mut known = Self {
            boxes: joint.modes.iter().map(ModeBox::around).collect(),
            unshaped: 0.0,
            allowed: f64::INFINITY,
            lever: joint.lever,
        };
        let left = known.most(duration, |swing| swing.left_by_plan(full));
        known.unshaped = joint.distance().abs() * left;
        if let Some(share) = tolerance.residual {
            known.allowed = share * known.unshaped;
        }
        if let Some(distance) = tolerance.deviation {
            known.allowed = known.allowed.min(distance / joint.lever);
        }
        known
    }

    /// The allowed share of the unshaped vibration; 1 without oscillation.
    pub fn share(&self) -> f64 {
        if self.unshaped > 0.0 {
            self.allowed / self.unshaped
        } else {
            1.0
        }
    }

    /// Modes over the whole boxes, as many as a motion of a duration (s) needs, up to [`MOST`] intervals.
    pub fn nodes(&self, duration: f64) -> impl Iterator<Item = Swing> {
        self.boxes.iter().flat_map(move |one| {
            let frequencies = evenly(one.frequency, one.intervals(duration).min(MOST) + 1);
            frequencies.flat_map(|frequency| {
                let ratios = evenly(one.damping_ratio, 2);
                ratios.map(move |ratio| Swing::new(frequency, ratio))
            })
        })
    }

    /// The largest amplitude that a motion of a duration (s) leaves of a mode anywhere in the boxes.
    ///
    /// The largest is on the edge of a box. The amplitude is `|f(mu)| / omega_d`, where `f` is analytic in the pole `mu`. So `log |f|` is
    /// subharmonic, and `-log omega_d` is subharmonic, too. Between nodes of an edge the square of the amplitude is nearly a parabola.
    pub fn most(&self, duration: f64, left: impl Fn(Swing) -> f64) -> f64 {
        let edges = self.boxes.iter().flat_map(|one| one.edges(duration));
        edges
            .map(|edge| peak(edge.into_iter().map(&left)))
            .fold(0.0, f64::max)
    }
}

impl ModeBox {
    fn around(known: &UncertainMode) -> Self {
        let (frequency, ratio) = (known.mode.natural_frequency(), known.mode.damping_ratio());
        let reach = WITHIN * known.natural_frequency_std;
        let rise = WITHIN * known.damping_ratio_std;
        Self {
            // A frequency of 0 is no mode.
            frequency: [(frequency - reach).max(0.1 * frequency), frequency + reach],
            damping_ratio: [(ratio - rise).max(0.0), (ratio + rise).min(HIGHEST_DAMPING)],
        }
    }

    /// Intervals between nodes that the humps over the frequency need.
    fn intervals(&self, duration: f64) -> usize {
        let [low, high] = self.frequency;
        let humps = duration * (high - low) / core::f64::consts::TAU;
        (3.0 + PER_HUMP * humps) as usize
    }

    /// Modes along the four edges.
    fn edges(&self, duration: f64) -> Vec<Vec<Swing>> {
        let count = self.intervals(duration) * FINER + 1;
        let over_frequency = self.damping_ratio.map(|ratio| {
            let frequencies = evenly(self.frequency, count);
            frequencies
                .map(|frequency| Swing::new(frequency, ratio))
                .collect()
        });
        let over_damping = self.frequency.map(|frequency| {
            let ratios = evenly(self.damping_ratio, OVER_DAMPING);
            ratios.map(|ratio| Swing::new(frequency, ratio)).collect()
        });
        over_frequency.into_iter().chain(over_damping).collect()
    }
}

/// The highest point of a curve through these values: the squares are interpolated by parabolas through three of them.
fn peak(values: impl Iterator<Item = f64>) -> f64 {
    let squares: Vec<f64> = values.map(|value| value * value).collect();
    let between = squares.windows(3).filter_map(|three| {
        let [before, here, after] = three else {
            return None;
        };
        let bend = 2.0 * here - before - after;
        (here >= before && here >= after && bend > 0.0)
            .then(|| here + (after - before).powi(2) / (8.0 * bend))
    });
    between
        .chain(squares.iter().copied())
        .fold(0.0, f64::max)
        .sqrt()
}

/// Evenly spaced values from one end to the other; one value where both are the same.
fn evenly([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let count = if to > from { count.max(2) } else { 1 };
    let step = (to - from) / (count - 1).max(1) as f64;
    (0..count).map(move |k| from + step * k as f64)
}
