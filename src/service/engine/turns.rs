//! New targets in motion: the move goes on with the train in force at once, and is retuned for its new way once the train for that
//! is solved.
//!
//! The tick retunes as it does for an estimate: the vibration of everything sent is replayed, for up to three modes, the end is exact,
//! the limits hold, and nothing changes where that leaves no less. A plan that has ended or has given way to another one, as to a
//! stop, is not retuned.

use quell_shapers::{CORRECTED_MODES, RetuneOutcome};

use super::Engine;
use super::joint::Ordered;
use super::learned::Turn;
use crate::learning::{ModeOnWay, Prescription};
use crate::service::learners::{Job, Wanted};
use crate::service::tick::{RetuneOrder, ToTick};

/// Shortest control period at which a plan in motion is retuned, s: the search for three modes takes up to 1.6 ms there
/// (`cargo bench --bench tick`), and must end within a tick.
const SHORTEST: f64 = 0.002;

impl Engine {
    /// Has the train for a plan solved that has begun in motion.
    pub(super) fn have_turned(&mut self, index: usize, ordered: &Ordered) {
        if self.config.period < SHORTEST {
            return;
        }
        let what = ordered.what;
        let Some(wanted) = self.wanted(index, what, &ordered.samples, ordered.shaper) else {
            return;
        };
        let in_force = self.joints[index].learning.solved.as_ref();
        let in_force = in_force.map_or(wanted.in_force, |solved| solved.train.clone());
        self.tickets += 1;
        self.joints[index].learning.turn = Some(Turn {
            asked: self.tickets,
            plan: ordered.ticket,
        });
        let wanted = Wanted {
            ticket: self.tickets,
            in_force,
            ..wanted
        };
        // It lives as long as the engine.
        let _ = self.lessons.jobs.send(Job::Prescribe(Box::new(wanted)));
    }

    /// The train for a plan in motion is solved: the tick goes over to it, if that plan runs still.
    pub(super) fn retune(&mut self, index: usize, turn: Turn, prescription: Prescription) {
        let shaped = prescription.modes.iter().filter(|mode| mode.shaped);
        let modes = shaped.map(ModeOnWay::anywhere).take(CORRECTED_MODES);
        let modes: Vec<_> = modes.collect();
        let solves = prescription.train.is_some();
        self.take_prescription(index, prescription);
        let Some(train) = self.joints[index].learning.solved.clone() else {
            return;
        };
        if solves && !modes.is_empty() {
            let order = RetuneOrder {
                joint: index,
                ticket: turn.plan,
                train,
                modes,
            };
            self.rings.orders.push(ToTick::Retune(Box::new(order)));
        }
    }

    /// The tick has retuned, or not.
    pub(super) fn retuned(&mut self, order: &RetuneOrder, outcome: &RetuneOutcome) {
        let (joint, mode) = (&mut self.joints[order.joint], order.train.known.mode);
        tracing::debug!(joint = joint.config.name, ?outcome, "a new way in motion");
        if !matches!(outcome, RetuneOutcome::Refused(_)) && joint.mode != mode {
            (joint.mode, joint.mode_since) = (mode, self.clock.unix_time());
        }
    }
}
