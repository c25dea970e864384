//! The knowledge of a learner as plain numbers, for storage.

use nalgebra::{SMatrix, SVector};
use serde::{Deserialize, Serialize};

use super::Learner;
use super::loads::Loads;
use super::map::{Block, Place};
use super::mode_map::ModeMap;
use super::monitor::Monitor;
use super::order::MOST;
use super::path::{NODES, Way};

/// Reference payload of older files, kg.
const OLDER: f64 = 60.0;

/// The knowledge of a learner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Memory {
    /// The modes, in the order in which they were found.
    pub modes: Vec<ModeMemory>,
    /// Sums over moves of what was left without adaptation and with it, and their weight.
    pub outcomes: [f64; 3],
    /// Variance of their difference.
    #[serde(default)]
    pub variance: f64,
    /// Part of the unshaped vibration that the modes leave unexplained, squared.
    pub unexplained: f64,
    /// Logarithm of the odds that the inertia changes along the way, and not the stiffness.
    #[serde(default)]
    pub odds: f64,
    /// Moves at which the load could have changed, and at which it has, undeclared; the same of the map's failures.
    #[serde(default)]
    pub loads: [[f64; 2]; 2],
}

/// A mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ModeMemory {
    /// Natural frequency at which the inertia is 1, rad/s.
    pub natural_frequency: f64,
    /// Its share of the deformation: precision, and precision times mean.
    pub share: [f64; 2],
    /// Whether the inertia is relative to that of a description.
    #[serde(default)]
    pub described: bool,
    /// Results of moves, the oldest first.
    pub moves: Vec<MoveMemory>,
}

/// The result of a move for one mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MoveMemory {
    /// Start and end, rad.
    pub way: [f64; 2],
    /// Those of the other joints meanwhile, rad.
    pub others: Vec<[f64; 2]>,
    /// Payload, kg.
    #[serde(default)]
    pub payload_kg: f64,
    /// The payload relative to [`OLDER`], as in older files.
    #[serde(default, rename = "payload", skip_serializing)]
    pub older_payload: f64,
    /// Number of the load that nobody declared.
    #[serde(default)]
    pub load: usize,
    /// `ln J` of a description at the nodes; 0 without one.
    #[serde(default)]
    pub described: [f64; NODES],
    /// Precision of the inertia at the nodes of the way, its upper triangle row by row.
    pub precision: Vec<f64>,
    /// Precision times inertia at the nodes.
    pub vector: [f64; NODES],
    /// Precision of the damping ratio, and precision times damping ratio.
    pub damping: [f64; 2],
}

impl Memory {
    /// Whether a learner takes it: all numbers are finite, and no precision is negative.
    pub fn is_valid(&self) -> bool {
        self.maps().is_some()
    }

    /// Removes each mode that no arm has, and says why: a frequency that is not above 0 and below `highest` (rad/s), a
    /// damping ratio that is not from 0 to below 1, or numbers that say nothing.
    pub fn refuse_impossible(&mut self, highest: f64) -> Vec<String> {
        let mut reasons = Vec::new();
        let mut number = 0;
        self.modes.retain(|mode| {
            number += 1;
            let reason = match mode.map() {
                Some(map) => map.impossible(highest),
                None => Some(mode.unsound()),
            };
            reasons.extend(
                reason
                    .iter()
                    .map(|reason| format!("mode {number}: {reason}")),
            );
            reason.is_none()
        });
        reasons
    }

    fn maps(&self) -> Option<Vec<ModeMap>> {
        let others = [&self.unexplained, &self.variance];
        let mut numbers = self.outcomes.iter().chain(others);
        let sound = numbers.all(|x| x.is_finite() && *x >= 0.0)
            && self.odds.is_finite()
            && self.modes.len() <= MOST;
        let maps = self.modes.iter().map(ModeMemory::map);
        let maps: Option<Vec<ModeMap>> = maps.collect();
        maps.filter(|maps| sound && Loads::remembered(self.loads, maps).is_some())
    }
}

impl Learner {
    /// All that the learner knows.
    pub fn memory(&self) -> Memory {
        let Monitor {
            base,
            adapted,
            weight,
            variance,
        } = self.monitor;
        Memory {
            modes: self.modes.iter().map(ModeMemory::of).collect(),
            outcomes: [base, adapted, weight],
            variance,
            unexplained: self.unexplained,
            odds: self.odds,
            loads: self.loads.counts(),
        }
    }

    /// Replaces the knowledge by a stored one. Returns false and changes nothing if it is not valid.
    pub fn remember(&mut self, memory: &Memory) -> bool {
        let Some(modes) = memory.maps() else {
            return false;
        };
        let Some(loads) = Loads::remembered(memory.loads, &modes) else {
            return false;
        };
        self.forget();
        let inertia = self.settings.inertia.as_ref();
        // Knowledge from before a description does not follow it yet.
        let new = inertia.is_some() && !modes.iter().any(|mode| mode.is_described);
        let lowest = modes.iter().map(|mode| mode.reference);
        let lowest = lowest.fold(f64::INFINITY, f64::min);
        let each = modes.into_iter().map(|mode| {
            let follows = mode.is_described || (new && mode.reference == lowest);
            if follows { mode.under(inertia) } else { mode }
        });
        self.modes = each.collect();
        let [base, adapted, weight] = memory.outcomes;
        self.monitor = Monitor {
            base,
            adapted,
            weight,
            variance: memory.variance,
        };
        self.unexplained = memory.unexplained;
        self.odds = memory.odds;
        self.loads = loads;
        true
    }
}

impl ModeMemory {
    fn of(mode: &ModeMap) -> Self {
        let pairs = mode.inertia.blocks().iter().zip(mode.damping.blocks());
        Self {
            natural_frequency: mode.reference.exp(),
            share: mode.share,
            described: mode.is_described,
            moves: pairs
                .map(|(inertia, damping)| MoveMemory::of(inertia, damping))
                .collect(),
        }
    }

    /// Why it is no map.
    fn unsound(&self) -> String {
        let w = self.natural_frequency;
        match w.is_finite() && w > 0.0 {
            true => "a number is not finite, or a precision or payload is negative".to_owned(),
            false => format!("a natural frequency of {w} rad/s is not above 0"),
        }
    }

    fn map(&self) -> Option<ModeMap> {
        let w = self.natural_frequency;
        let sound = w.is_finite() && w > 0.0 && self.share.iter().all(|x| x.is_finite());
        let mut map = sound.then(|| ModeMap::new(w.ln()))?;
        if self.described {
            map = ModeMap::of_described(map.reference);
        }
        map.share = self.share;
        for said in &self.moves {
            let (inertia, damping) = said.blocks()?;
            map.inertia.add(inertia);
            map.damping.add(damping);
        }
        Some(map)
    }
}

impl MoveMemory {
    fn of(inertia: &Block, damping: &Block) -> Self {
        let [first, .., last] = &inertia.places;
        let others = first.others.iter().zip(&last.others);
        let upper = (0..NODES).flat_map(|i| (i..NODES).map(move |j| (i, j)));
        Self {
            way: [first.position, last.position],
            others: others.map(|(from, to)| [*from, *to]).collect(),
            payload_kg: first.payload,
            older_payload: 0.0,
            load: first.load,
            described: inertia.places.each_ref().map(|place| place.described),
            precision: upper.map(|at| inertia.precision[at]).collect(),
            vector: inertia.vector.into(),
            damping: [damping.precision[(1, 1)], damping.vector[1]],
        }
    }

    /// Blocks of inertia and damping; none where a number is not finite, or a precision is negative.
    fn blocks(&self) -> Option<(Block, Block)> {
        let numbers = self
            .precision
            .iter()
            .chain(&self.vector)
            .chain(&self.damping);
        let positions = self.others.iter().flatten().chain(&self.way);
        let finite = numbers
            .chain(positions)
            .chain(&self.described)
            .chain([&self.payload_kg, &self.older_payload])
            .all(|x| x.is_finite());
        let carries = self.payload_kg.min(self.older_payload) >= 0.0;
        if !finite || !carries || self.precision.len() != NODES * (NODES + 1) / 2 {
            return None;
        }
        let at = |i: usize, j: usize| i * NODES - i * (i + 1) / 2 + j;
        let precision: SMatrix<f64, NODES, NODES> =
            SMatrix::from_fn(|i, j| self.precision[at(i.min(j), i.max(j))]);
        let rounding = 1e-9 * precision.norm();
        let least = precision.symmetric_eigenvalues().min();
        if least < -rounding || self.damping[0] < 0.0 {
            return None;
        }
        let nodes = |way: [f64; 2]| Way::new(way[0], way[1]).nodes();
        let places = core::array::from_fn(|n| Place {
            described: self.described[n],
            position: nodes(self.way)[n],
            others: self.others.iter().map(|way| nodes(*way)[n]).collect(),
            payload: self.payload_kg + OLDER * self.older_payload,
            load: self.load,
        });
        let only =
            |value: f64| SVector::<f64, NODES>::from_fn(|n, _| if n == 1 { value } else { 0.0 });
        let [damping, pulled] = self.damping;
        Some((
            Block {
                places: places.clone(),
                precision,
                vector: self.vector.into(),
            },
            Block {
                places,
                precision: SMatrix::from_diagonal(&only(damping)),
                vector: only(pulled),
            },
        ))
    }
}
