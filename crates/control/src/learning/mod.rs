//! What moves teach of a joint: its modes, how many they are, and how they follow pose and payload; and the train for
//! the next move. Off the tick: it allocates, and takes milliseconds.
//!
//! After each move [`Learner::learn`] fits a sum of modes to it ([`fit`]), as many as there is evidence for ([`order`]), and keeps
//! what it says in a map of each mode ([`mode_map`]). Before a move [`Learner::prescribe`] forecasts what trains leave of it
//! ([`forecast`]): that in force, that of the belief, and the one solved for the way. The train in force is kept unless another
//! is expected to leave less; [`monitor`] holds the expectation against what moves have left. In the midst of a move for which none
//! was solved, as the first, [`Learner::along`] does both with the samples up to then.

mod account;
mod along;
mod chart;
mod choice;
mod described;
mod fit;
mod forecast;
mod listening;
mod map;
mod memory;
mod mode_map;
mod monitor;
mod order;
mod path;
mod point;
mod prescribing;
mod prescription;
mod response;
mod simplex;

use self::map::Place;
use self::mode_map::ModeMap;
use self::monitor::Monitor;
use self::path::NODES;
use quell_shapers::{GridTrain, Mode};

pub use self::account::{Account, Explained, Seen};
pub use self::chart::{Charted, ModeChart, Spoken};
pub use self::described::Inertia;
pub use self::memory::{Memory, ModeMemory, MoveMemory};
pub use self::order::MOST;
pub use self::path::Way;
pub use self::prescription::{Hold, ModeOnWay, Prescription};

/// Settings of a learner.
#[derive(Clone, Debug)]
pub struct LearnerSettings {
    /// The mode that the engineer believes in.
    pub belief: Mode,
    /// Natural frequencies that are looked for, rad/s.
    pub natural_frequency: [f64; 2],
    /// Share of the unshaped vibration that is not worth a change.
    pub dead_band: f64,
    /// Longest train, s.
    pub longest_train: f64,
    /// The train that is in force without any adaptation.
    pub base: GridTrain,
    /// What a robot's description says of the joint's inertia; without one, nothing is known of it.
    pub inertia: Option<Inertia>,
}

/// The rest of what there is along a way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Ways of the other joints meanwhile; of one that stands from and to where it is.
    pub others: Vec<Way>,
    /// Payload as it was declared, kg.
    pub payload: f64,
}

impl Surroundings {
    /// Of the only joint.
    pub fn carrying(payload: f64) -> Self {
        let others = Vec::new();
        Self { others, payload }
    }

    fn places(&self, way: &Way, inertia: Option<&Inertia>) -> [Place; NODES] {
        let nodes = way.nodes();
        core::array::from_fn(|n| {
            let others = self.others.iter().map(|other| other.nodes()[n]);
            Place::new(nodes[n], others.collect(), self.payload, inertia)
        })
    }
}

/// What was prescribed for the move under way.
#[derive(Clone, Debug)]
struct Pending {
    /// The train that adaptation would have, in force or not.
    adapted: GridTrain,
    is_base: bool,
}

/// Learns the modes of a joint from move to move.
#[derive(Clone, Debug)]
pub struct Learner {
    settings: LearnerSettings,
    modes: Vec<ModeMap>,
    monitor: Monitor,
    /// Part of the unshaped vibration that the modes leave unexplained, squared, over the last moves.
    unexplained: f64,
    pending: Option<Pending>,
}

impl Learner {
    /// A learner that knows nothing yet.
    pub fn new(settings: LearnerSettings) -> Self {
        Self {
            settings,
            modes: Vec::new(),
            monitor: Monitor::default(),
            unexplained: 0.0,
            pending: None,
        }
    }

    /// Modes that it knows.
    pub fn modes(&self) -> usize {
        self.modes.len()
    }

    /// From now on this is the train without any adaptation.
    pub fn set_base(&mut self, base: GridTrain) {
        self.settings.base = base;
    }

    /// Forgets all that it has learned.
    pub fn forget(&mut self) {
        self.modes.clear();
        self.monitor = Monitor::default();
        self.unexplained = 0.0;
        self.pending = None;
    }
}
