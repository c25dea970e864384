//! Learning from moves: the modes of a joint, their number, and their change with pose and payload; and the
//! train for the next move. It runs off the tick: it allocates, and takes milliseconds.
//!
//! After each move [`Learner::learn`] fits a sum of modes to it ([`fit`]), as many as there is evidence for
//! ([`order`]), and adds the result to a map of each mode ([`mode_map`]). Before a move [`Learner::prescribe`]
//! forecasts the residual of three trains ([`forecast`]): the one in force, that of the belief, and the one
//! solved for the way. The train in force is kept unless another is expected to leave less; [`monitor`]
//! compares the expectation with measured residuals. During a move without a solved train, such as the first
//! one, [`Learner::along`] does both with the samples so far.

mod account;
mod along;
mod cause;
mod chart;
mod choice;
mod described;
mod fit;
mod forecast;
mod listening;
mod loads;
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

use self::loads::Loads;
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
    /// Natural frequencies in which modes are searched, rad/s.
    pub natural_frequency: [f64; 2],
    /// Share of the unshaped vibration below which a change is not worth it.
    pub dead_band: f64,
    /// Longest train, s.
    pub longest_train: f64,
    /// The train that is in force without any adaptation.
    pub base: GridTrain,
    /// The inertia of the joint from a robot's description; `None` if it is unknown.
    pub inertia: Option<Inertia>,
}

/// Conditions of a move besides the joint's own way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Ways of the other joints during the move; a joint at rest has the same start and end.
    pub others: Vec<Way>,
    /// Payload as it was declared, kg.
    pub payload: f64,
}

impl Surroundings {
    /// The surroundings of a single joint.
    pub fn carrying(payload: f64) -> Self {
        let others = Vec::new();
        Self { others, payload }
    }

    fn places(&self, way: &Way, inertia: Option<&Inertia>, load: usize) -> [Place; NODES] {
        let nodes = way.nodes();
        core::array::from_fn(|n| {
            let others = self.others.iter().map(|other| other.nodes()[n]);
            Place::new(nodes[n], others.collect(), self.payload, inertia).with_load(load)
        })
    }
}

/// The prescription for the move under way.
#[derive(Clone, Debug)]
struct Pending {
    /// The train with adaptation, in force or not.
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
    /// Logarithm of the odds that the inertia changes along the way, and not the stiffness, by the moves so far.
    odds: f64,
    loads: Loads,
    pending: Option<Pending>,
}

impl Learner {
    /// A learner without knowledge.
    pub fn new(settings: LearnerSettings) -> Self {
        Self {
            settings,
            modes: Vec::new(),
            monitor: Monitor::default(),
            unexplained: 0.0,
            odds: 0.0,
            loads: Loads::default(),
            pending: None,
        }
    }

    /// Number of known modes.
    pub fn modes(&self) -> usize {
        self.modes.len()
    }

    /// Sets the train without adaptation.
    pub fn set_base(&mut self, base: GridTrain) {
        self.settings.base = base;
    }

    /// Discards all knowledge.
    pub fn forget(&mut self) {
        self.modes.clear();
        self.monitor = Monitor::default();
        self.unexplained = 0.0;
        self.odds = 0.0;
        self.loads = Loads::default();
        self.pending = None;
    }

    fn places(&self, way: &Way, surroundings: &Surroundings) -> [Place; NODES] {
        surroundings.places(way, self.settings.inertia.as_ref(), self.loads.present)
    }
}
