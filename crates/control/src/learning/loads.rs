//! What may be different at the next move: another load, which nobody declares, or no mode of the map.
//!
//! A gripper takes a part, and no one tells the controller. The modes then change at once, as a payload changes them. Each load
//! has a number. The map relates the loads: with another one the modes are those of the loads before, less certain. Or a map
//! fails: the arm was changed, or its motion is not one of modes, as with backlash. Then only the belief is left.
//!
//! An event that happens happens at each move with a probability of which any value is as likely. After `k` of `n` moves it
//! happens at the next one, by Laplace's rule of succession, with the probability
//! ```text
//! (k + 1) / (n + 2)   for k > 0
//! ```
//! Of the mean square that a train leaves, each case counts by its probability. An event that has never happened may be
//! impossible, and is not reckoned with: trains that suit other loads, too, are twice as long, which an arm without them
//! would have to pay for.
//!
//! Source: A. Gelman and others, Bayesian Data Analysis, 3rd ed., 2013, ch. 2.

use super::forecast::Expected;
use super::map::Place;
use super::mode_map::ModeMap;
use super::path::NODES;

/// Whose modes a fit has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModesOf {
    /// Those of the map.
    Map,
    /// Those of the map with another load, which nobody declared.
    AnotherLoad,
    /// Others.
    Nobody,
}

/// How often something has happened that may happen at a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Chance {
    /// Moves at which it could have.
    pub moves: f64,
    /// Those at which it has.
    pub times: f64,
}

impl Chance {
    fn take(&mut self, has_happened: bool) {
        self.moves += 1.0;
        self.times += f64::from(u8::from(has_happened));
    }

    /// Probability that it happens at the next move; 0 if it never has.
    pub fn probability(&self) -> f64 {
        match self.times > 0.0 {
            true => (self.times + 1.0) / (self.moves + 2.0),
            false => 0.0,
        }
    }

    fn is_sound(&self) -> bool {
        self.times >= 0.0 && self.times <= self.moves && self.moves.is_finite()
    }
}

/// The loads so far, and the maps that failed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Loads {
    /// Number of the present load.
    pub present: usize,
    /// Changes of the load, at moves that the map explains.
    pub changes: Chance,
    /// Failures of the map.
    pub failures: Chance,
}

impl Loads {
    /// What a stored map says; `None` where its counts are none.
    pub fn remembered(counts: [[f64; 2]; 2], modes: &[ModeMap]) -> Option<Self> {
        let blocks = modes.iter().flat_map(|mode| mode.inertia.blocks());
        let present = blocks.map(|block| block.places[0].load).max().unwrap_or(0);
        let [changes, failures] = counts.map(|[moves, times]| Chance { moves, times });
        let sound = changes.is_sound() && failures.is_sound();
        sound.then_some(Self {
            present,
            changes,
            failures,
        })
    }

    /// The same as numbers.
    pub fn counts(&self) -> [[f64; 2]; 2] {
        [self.changes, self.failures].map(|chance| [chance.moves, chance.times])
    }

    /// The places with the present load.
    pub fn of_present(&self, places: [Place; NODES]) -> [Place; NODES] {
        places.map(|place| place.with_load(self.present))
    }

    /// The places with a load that the arm has not had.
    pub fn another(&self, places: &[Place; NODES]) -> [Place; NODES] {
        let next = self.present + 1;
        places.each_ref().map(|place| place.clone().with_load(next))
    }

    /// Counts a move for which there was a map.
    pub fn take(&mut self, modes_of: ModesOf) {
        self.failures.take(modes_of == ModesOf::Nobody);
        if modes_of != ModesOf::Nobody {
            self.changes.take(modes_of == ModesOf::AnotherLoad);
        }
        if modes_of == ModesOf::AnotherLoad {
            self.present += 1;
        }
    }

    /// The modes of the next move where the map holds, from those with the present load and those with another.
    pub fn mixture(&self, present: &[Expected], another: &[Expected]) -> Vec<Expected> {
        let other = self.changes.probability();
        if other == 0.0 {
            return present.to_vec();
        }
        let with = |mode: &Expected, probability: f64| Expected {
            share: mode.share * probability.sqrt(),
            ..*mode
        };
        let present = present.iter().map(|mode| with(mode, 1.0 - other));
        let another = another.iter().map(|mode| with(mode, other));
        present.chain(another).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Chance;

    /// The probability is the integral over all values that it may have, each weighed by its likelihood.
    #[test]
    fn val_probability_by_integration() {
        const STEPS: usize = 100_000;
        for (moves, times) in [(1, 1), (9, 1), (9, 3)] {
            let (mut all, mut next) = (0.0, 0.0);
            for step in 0..STEPS {
                let p = (step as f64 + 0.5) / STEPS as f64;
                let likely = p.powi(times) * (1.0 - p).powi(moves - times) / STEPS as f64;
                all += likely;
                next += likely * p;
            }
            let chance = Chance {
                moves: f64::from(moves),
                times: f64::from(times),
            };
            let (told, exact) = (chance.probability(), next / all);
            assert!(
                (told / exact - 1.0).abs() < 1e-6,
                "{moves} {times}: {told} {exact}"
            );
        }
    }
}
