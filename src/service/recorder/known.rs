//! Knowledge about a joint during a recording: its learned modes, and the train in force.

use crate::recording::{McapWriter, RecordingError};
use crate::service::contract::{JointSnapshot, LearningView, TrainView};

/// Most changes that are kept: a train changes a few times in a move, and a recording on demand may be long.
const MOST: usize = 4_000;

/// Modes and trains, each valid from an instant on.
#[derive(Clone, Debug, Default)]
pub struct Known {
    changes: Vec<(f64, Change)>,
    modes: LearningView,
    train: TrainView,
}

/// A change.
#[derive(Clone, Debug)]
enum Change {
    Modes(LearningView),
    Train(TrainView),
}

impl Known {
    /// Adds the knowledge at `time`, s on the service's clock, if it has changed.
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

    /// Writes changes up to `time`, from number `next` on; times are relative to `origin`.
    pub fn write_on(
        &self,
        next: &mut usize,
        (time, origin): (f64, f64),
        file: &mut McapWriter,
        joint: &str,
    ) -> Result<(), RecordingError> {
        while let Some((at, change)) = self.changes.get(*next).filter(|(at, _)| *at <= time) {
            // Knowledge from before the file is written at its beginning.
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
