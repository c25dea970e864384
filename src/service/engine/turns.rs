//! Retuning of plans in motion whose train was not solved for them. The move begins at once with the train in
//! force, and is retuned for its way once that train is solved. For a new target the modes come from the map;
//! without one, as in a first move, from the samples so far.
//!
//! The correction is searched here, in a copy of the tick's filter that runs ahead of it, since that takes
//! longer than a short control period. The tick continues with the copy when it reaches the same point.
//!
//! The retune is that of an estimate: the vibration of the whole command is replayed for up to three modes, the
//! end is exact, the limits hold, and nothing changes if that leaves no less. A plan that has ended, or was
//! replaced by another one such as a stop, is not retuned.

use quell_shapers::{CORRECTED_MODES, RetuneOutcome};

use super::Engine;
use super::joint::{Ordered, name_of};
use super::learned::Turn;
use super::orders::AHEAD;
use super::planning::standing_train;
use super::running::ROUNDING;
use crate::learning::{ModeOnWay, Prescription};
use crate::service::learners::{Along, Job, Wanted};
use crate::service::tick::{RetuneOrder, ToTick};

impl Engine {
    /// Requests the train for a plan that has begun in motion.
    pub(super) fn have_turned(&mut self, index: usize, ordered: &Ordered) {
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

    /// Has a move evaluated during its motion, at intervals of a period, if no modes of the joint are known.
    pub(super) fn look_along(&mut self, index: usize, now: f64) {
        let joint = &self.joints[index];
        let learning = &joint.learning;
        let period = joint.config.belief.damped_period();
        let is_due =
            learning.modes == 0 && learning.turn.is_none() && now > learning.looked + period;
        let Some(running) = joint.running.as_ref().filter(|running| {
            let own = running.start.shaper == name_of(joint.standing_shaper());
            let goes_on = running.settled.is_none() && !running.is_interrupted() && !running.frozen;
            own && goes_on && running.adaptive && joint.adaptation
        }) else {
            return;
        };
        if !is_due || joint.asked.is_some() {
            return;
        }
        let Ok(standing) = standing_train(joint, joint.standing_shaper(), self.config.period)
        else {
            return;
        };
        self.tickets += 1;
        let along = Along {
            joint: index,
            ticket: self.tickets,
            heard: running.heard.clone(),
            plan: running.plan.clone(),
            surroundings: self.surroundings(index, Some(&running.before)),
            in_force: standing.train,
        };
        let turn = Turn {
            asked: self.tickets,
            plan: running.ticket,
        };
        let learning = &mut self.joints[index].learning;
        (learning.turn, learning.looked) = (Some(turn), now);
        // It lives as long as the engine.
        let _ = self.lessons.jobs.send(Job::Along(Box::new(along)));
    }

    /// Handles the evaluation of a move during its motion.
    pub(super) fn looked_along(
        &mut self,
        index: usize,
        ticket: u64,
        prescription: Option<Box<Prescription>>,
    ) {
        let turn = &mut self.joints[index].learning.turn;
        if let Some(turn) = turn.take_if(|turn| turn.asked == ticket)
            && let Some(prescription) = prescription
        {
            self.retune(index, turn, *prescription);
        }
    }

    /// Retunes to the solved train of a plan in motion, if that plan still runs.
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
                lent: None,
                tick: 0,
            };
            self.rings.orders.push(ToTick::Retune(Box::new(order)));
        }
    }

    /// Takes the lent copy of the tick's filter, in its state before a tick. The correction is searched in it,
    /// far enough ahead of the tick to be in time.
    pub(super) fn foresee(&mut self, mut order: Box<RetuneOrder>) {
        let joint = &self.joints[order.joint];
        let running = joint.running.as_ref();
        let running = running.filter(|running| running.ticket == order.ticket);
        let Some(lent) = order.lent.as_deref_mut() else {
            return;
        };
        if let Some(running) = running {
            let last = running.sample_before(order.tick);
            let planned = |tick: usize| running.planned_at(last + tick);
            // If it does not match, another plan runs already, and the tick refuses the copy.
            if (planned(0).position - lent.planned().position).abs() <= ROUNDING {
                let late = self.next_tick().saturating_sub(order.tick) as usize;
                let ahead = late + (AHEAD / self.config.period).ceil() as usize;
                let remaining = running.plan.samples().saturating_sub(last + 1);
                let what = (&order.train.train, order.modes.as_slice());
                lent.retune(what, ahead, remaining, planned);
            }
        }
        self.rings.orders.push(ToTick::Retune(order));
    }

    /// Handles the tick's answer on a retune.
    pub(super) fn retuned(&mut self, order: &RetuneOrder, outcome: &RetuneOutcome) {
        let (joint, mode) = (&mut self.joints[order.joint], order.train.known.mode);
        tracing::debug!(joint = joint.config.name, ?outcome, "a new way in motion");
        if !matches!(outcome, RetuneOutcome::Refused(_)) && joint.mode != mode {
            (joint.mode, joint.mode_since) = (mode, self.clock.unix_time());
        }
    }
}
