//! Finished moves: judged and learned from by the learners, then published, once.

use super::learned::WITHIN;
use super::running::Running;
use super::{Engine, MOVES};
use crate::learning::Account;
use crate::service::contract::{Event as Told, KnownMode, MoveResult};
use crate::service::learners::{Ended, Job, Judged};

/// Most time that the result of a move waits to be judged, s. A fit takes up to 0.48 s on a busy machine, and
/// those of several joints queue.
const JUDGED: f64 = 2.0;

/// A move that has ended and is being judged.
pub struct Ending {
    result: MoveResult,
    joint: usize,
    /// End of the wait, s.
    until: f64,
}

impl Ending {
    /// Whether it is one of this joint.
    pub fn is_of(&self, joint: usize) -> bool {
        self.joint == joint
    }

    /// Whether it has waited too long at `now` (s).
    pub fn is_overdue(&self, now: f64) -> bool {
        now > self.until
    }
}

impl Engine {
    /// Has a finished move judged and learned from before its result is published. A move without samples is
    /// published at once.
    pub(super) fn have_judged(&mut self, index: usize, running: Running, result: MoveResult) {
        if running.is_interrupted() || running.frozen || running.heard.is_empty() {
            return self.tell(result);
        }
        let joint = &self.joints[index];
        let ended = Ended {
            joint: index,
            id: result.id,
            surroundings: self.surroundings(index, Some(&running.before)),
            planned: running.planned_motion().to_vec(),
            after: running
                .after
                .iter()
                .map(|&(time, value, _)| (time, value))
                .collect(),
            teaches: joint.adaptation && running.payload == self.payload,
            prescribed: running.prescribed,
            cruise: running.cruise.into_stretches(),
            heard: running.heard,
            plan: running.plan,
        };
        self.endings.push(Ending {
            joint: index,
            until: self.clock.now() + JUDGED,
            result,
        });
        if self.lessons.jobs.send(Job::Ended(Box::new(ended))).is_err() {
            self.tell_endings(|ending| ending.is_of(index));
        }
    }

    /// Whether the result of a move was published, or will be.
    pub(super) fn is_judged(&self, id: u64) -> bool {
        let told = self.moves.iter().any(|result| result.id == id);
        told || self.endings.iter().any(|ending| ending.result.id == id)
    }

    /// Publishes results that cannot wait to be judged; their unshaped vibration is then unknown.
    pub(super) fn tell_endings(&mut self, which: impl Fn(&Ending) -> bool) {
        while let Some(at) = self.endings.iter().position(&which) {
            let mut result = self.endings.remove(at).result;
            put_account(&mut result, None, None);
            self.tell(result);
        }
    }

    /// Whether every finished move was published.
    pub(super) fn has_told_all(&self) -> bool {
        self.endings.is_empty()
    }

    pub(super) fn judged(&mut self, judged: Judged) {
        let modes: Vec<KnownMode> = judged.modes.iter().map(KnownMode::from).collect();
        let joint = &mut self.joints[judged.joint];
        joint.learning.view.modes.clone_from(&modes);
        let radius = joint.sensor.arc().map(|arc| arc.radius());
        let put = |result: &mut MoveResult| {
            put_account(result, judged.account, radius);
            result.modes.clone_from(&modes);
        };
        let mut endings = self.endings.iter();
        if let Some(at) = endings.position(|ending| ending.result.id == judged.id) {
            let mut result = self.endings.remove(at).result;
            put(&mut result);
            return self.tell(result);
        }
        // It was already published without the judgement, after the longest wait.
        let mut told = self.moves.iter_mut();
        if let Some(result) = told.find(|result| result.id == judged.id) {
            put(result);
            self.save();
        }
    }

    pub(super) fn tell(&mut self, result: MoveResult) {
        self.moves.push_back(result.clone());
        while self.moves.len() > MOVES {
            self.moves.pop_front();
        }
        self.batch.events.push(Told::MoveEnded(Box::new(result)));
        self.save();
    }
}

/// Adds an account to the result of a move; without one, the unshaped vibration of a shaped move is unknown.
fn put_account(result: &mut MoveResult, account: Option<Account>, radius: Option<f64>) {
    let along_arc = |angle: Option<f64>| Some(angle? * radius?);
    if let Some(Account {
        left, vibration, ..
    }) = account
    {
        (result.residual_rad, result.vibration_rad) = (left, vibration);
        (result.residual_m, result.vibration_m) = (along_arc(left), along_arc(vibration));
    }
    let [unshaped, all] = match result.shaped {
        // The corresponding unshaped move is not known.
        _ if result.shaper == WITHIN => [None, None],
        true => [
            account.map(|a| a.unshaped),
            account.map(|a| a.unshaped_vibration),
        ],
        false => [result.residual_rad, result.vibration_rad],
    };
    (result.unshaped_rad, result.unshaped_vibration_rad) = (unshaped, all);
    (result.unshaped_m, result.unshaped_vibration_m) = (along_arc(unshaped), along_arc(all));
    let shaped = account.filter(|_| result.shaped);
    result.unshaped_std_rad = shaped.map(|account| account.unshaped_std);
}
