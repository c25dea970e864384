//! The known modes of a joint, and the residual that is allowed.

use quell_shapers::UncertainMode;
use quell_trajectories::AxisProfile;

use super::swing::Swing;
use super::{Moving, Tolerance};

/// Standard deviations to each side of a box: 95 % of a Gaussian.
const WITHIN: f64 = 2.0;
/// Nodes over a box for each hump of the residual over frequency; there is one hump for each Hz and second.
const PER_HUMP: f64 = 6.0;
/// Most nodes over the frequency.
const MOST: f64 = 49.0;
/// Refinement of the grid on which a motion is checked.
pub const FINER: usize = 4;
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
        let left = known.nodes(duration, FINER);
        let left = left
            .map(|swing| swing.left_by_plan(full))
            .fold(0.0, f64::max);
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

    /// Modes over the whole boxes, as many as a motion of a duration (s) needs, times `finer`.
    pub fn nodes(&self, duration: f64, finer: usize) -> impl Iterator<Item = Swing> {
        self.boxes.iter().flat_map(move |one| {
            let [low, high] = one.frequency;
            let humps = duration * (high - low) / core::f64::consts::TAU;
            let frequencies = (3.0 + PER_HUMP * humps).min(MOST) as usize * finer + 1;
            let frequencies = evenly(one.frequency, frequencies);
            frequencies.flat_map(move |frequency| {
                let ratios = evenly(one.damping_ratio, 2 * finer.min(2));
                ratios.map(move |ratio| Swing::new(frequency, ratio))
            })
        })
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
}

/// Evenly spaced values from one end to the other; one value where both are the same.
fn evenly([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    let count = if to > from { count.max(2) } else { 1 };
    let step = (to - from) / (count - 1).max(1) as f64;
    (0..count).map(move |k| from + step * k as f64)
}
