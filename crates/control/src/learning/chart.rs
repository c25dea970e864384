//! The maps of a learner over the pose, for display.

use super::Learner;
use super::Surroundings;
use super::map::{Block, Place};
use super::mode_map::ModeMap;
use super::path::{NODES, Way};

/// A mode over the pose of its joint.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeChart {
    /// Values at the requested positions.
    pub curve: Vec<Charted>,
    /// Damping ratio, and its standard deviation, in the middle.
    pub damping: [f64; 2],
    /// The estimate of each move, averaged over its way.
    pub moves: Vec<Spoken>,
}

/// A mode at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Charted {
    /// Position of the joint, rad.
    pub position: f64,
    /// Natural frequency, rad/s.
    pub natural_frequency: f64,
    /// One standard deviation of it, rad/s.
    pub std: f64,
}

/// The estimate of one move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spoken {
    /// Start and end, rad.
    pub way: [f64; 2],
    /// Payload, kg.
    pub payload: f64,
    /// The average, at the position to which it belongs.
    pub average: Charted,
}

impl Learner {
    /// Each mode at these positions (rad), with the other joints at the end of their present ways.
    pub fn chart(&self, positions: &[f64], surroundings: &Surroundings) -> Vec<ModeChart> {
        let others: Vec<f64> = surroundings
            .others
            .iter()
            .map(|way| way.nodes()[NODES - 1])
            .collect();
        let inertia = self.settings.inertia.as_ref();
        let (payload, load) = (surroundings.payload, self.loads.present);
        let place =
            |position| Place::new(position, others.clone(), payload, inertia).with_load(load);
        self.modes
            .iter()
            .map(|mode| chart(mode, positions, place))
            .collect()
    }
}

fn chart(mode: &ModeMap, positions: &[f64], place: impl Fn(f64) -> Place) -> ModeChart {
    let mut curve = Vec::with_capacity(positions.len());
    // The map is evaluated at as many places as a way has nodes.
    for few in positions.chunks(NODES) {
        let at = |n: usize| few[n.min(few.len() - 1)];
        let known = mode.prior(&core::array::from_fn(|n| place(at(n)))).log_w;
        curve.extend(few.iter().enumerate().map(|(n, &position)| {
            let natural_frequency = known.mean[n].exp();
            let std = natural_frequency * known.covariance[(n, n)].max(0.0).sqrt();
            Charted {
                position,
                natural_frequency,
                std,
            }
        }));
    }
    let middle = positions
        .get(positions.len() / 2)
        .copied()
        .unwrap_or_default();
    let (xi, variance) = mode.prior(&core::array::from_fn(|_| place(middle))).xi;
    let moves = mode
        .inertia
        .blocks()
        .iter()
        .filter_map(|block| spoken(mode, block));
    ModeChart {
        curve,
        damping: [xi, variance.sqrt()],
        moves: moves.collect(),
    }
}

/// The average inertia of a block: `c = 1'e / 1'L1`, which belongs to the position `x'L1 / 1'L1`; none where
/// its precision is zero.
fn spoken(mode: &ModeMap, block: &Block) -> Option<Spoken> {
    let weights = block.precision.column_sum();
    let all = weights.sum();
    let c = block.vector.sum() / all;
    let [first, .., last] = &block.places;
    let way = Way::new(first.position, last.position);
    let nodes = way.nodes();
    let position = weights
        .iter()
        .zip(nodes)
        .map(|(weight, x)| weight * x)
        .sum::<f64>()
        / all;
    let described = weights.dot(&mode.described_at(&block.places)) / all;
    let natural_frequency = (mode.reference - 0.5 * (c.ln() + described)).exp();
    let average = Charted {
        position: position.clamp(
            nodes[0].min(nodes[NODES - 1]),
            nodes[0].max(nodes[NODES - 1]),
        ),
        natural_frequency,
        std: 0.5 * natural_frequency / (c * all.sqrt()),
    };
    (all > 0.0 && c > 0.0 && average.std.is_finite()).then_some(Spoken {
        way: [first.position, last.position],
        payload: first.payload,
        average,
    })
}
