//! What was known of a joint while it was recorded: the modes that its moves had taught, and the train in force.

use crate::recording::{McapWriter, RecordingError};
use crate::service::contract::{JointSnapshot, LearningView, TrainView};

/// Changes that are kept: a train changes a few times a move, and a recording on demand may be long.
const MOST: usize = 4_000;

/// Modes and trains, each from an instant on.
#[derive(Clone, Debug, Default)]
pub struct Known {
    changes: Vec<(f64, Change)>,
    modes: LearningView,
    train: TrainView,
}

/// What is new.
#[derive(Clone, Debug)]
enum Change {
    Modes(LearningView),
    Train(TrainView),
}

impl Known {
    /// Takes what is known at `time`, s on the service's clock, where it is something else than before.
    pub fn take(&mut self, time: f64, joint: &JointSnapshot) {
        if self.changes.len() >= MOST {
            return;
        }
        if self.modes.modes != joint.learning.modes {
            self.modes.clone_from(&joint.learning);
            self.changes.push((time, Change::Modes(self.modes.clone())));
        }
        if self.train != joint.train {
            self.train.clone_from(&joint.train);
            self.changes.push((time, Change::Train(self.train.clone())));
        }
    }

    /// Writes what was new up to `time`, from the change of number `next` on; times count from `origin`.
    pub fn write_on(
        &self,
        next: &mut usize,
        (time, origin): (f64, f64),
        file: &mut McapWriter,
        joint: &str,
    ) -> Result<(), RecordingError> {
        while let Some((at, change)) = self.changes.get(*next).filter(|(at, _)| *at <= time) {
            // What was known before the file begins stands at its beginning.
            let at = (at - origin).max(0.0);
            match change {
                Change::Modes(modes) => {
                    let (sizes, numbers) = (modes.dimensions(), modes.numbers());
                    file.write_numbers(at, joint, "modes", &sizes, &numbers)?;
                }
                Change::Train(train) => {
                    let (sizes, numbers) = (train.dimensions(), train.numbers());
                    file.write_numbers(at, joint, "impulses", &sizes, &numbers)?;
                }
            }
            *next += 1;
        }
        Ok(())
    }
}
