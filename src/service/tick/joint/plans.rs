//! The plan that waits for its time, alone or with those of other joints.

use super::JointTick;
use crate::service::tick::gate::{Admission, Gate};
use crate::service::tick::messages::{Event, NotTaken, Plan, Start, Taken, Together};
use crate::service::tick::taking::ready;

impl JointTick {
    /// Takes a plan that waits for its time; returns one that it replaces.
    pub fn expect(&mut self, plan: Box<Plan>) -> Option<Event> {
        self.released = plan.together.is_none();
        let replaced = self.waiting.replace(plan)?;
        Some(Event::NotTaken(replaced, NotTaken::Replaced))
    }

    /// Returns a plan that waits for its time, if it has this number.
    pub fn withdraw(&mut self, ticket: u64) -> Option<Event> {
        let plan = self.waiting.take_if(|plan| plan.ticket == ticket)?;
        Some(Event::NotTaken(plan, NotTaken::Withdrawn))
    }

    /// The plans with which the waiting one is to begin, while it waits for them.
    pub fn together(&self) -> Option<Together> {
        let waits = self.waiting.as_ref().filter(|_| !self.released);
        waits.and_then(|plan| plan.together)
    }

    /// Whether the waiting plan is one of these, and could begin with this tick.
    pub fn is_ready_with(&mut self, together: Together, tick: u64, gate: &Gate) -> bool {
        let waits = self.waiting.as_ref();
        let Some(plan) = waits.filter(|plan| plan.together == Some(together)) else {
            return false;
        };
        let admitted = gate.admits(plan.permit) == Admission::Begins;
        let Some(controller) = self.controller.as_deref_mut().filter(|_| admitted) else {
            return false;
        };
        // A correction under way may refuse a plan in motion when it is loaded, which would be too late for the
        // others.
        let corrects = matches!(plan.start, Start::Tick(_)) && controller.is_correcting();
        !corrects && ready(plan, controller, tick) == Ok(true)
    }

    /// Lets the waiting plan begin, if it is one of these.
    pub fn release(&mut self, together: Together) {
        self.released |= self.together() == Some(together);
    }

    /// Begins the waiting plan, if its time has come and the gate is open for it.
    pub fn take_plan(&mut self, tick: u64, time: f64, gate: &Gate) -> Option<Event> {
        let mut plan = self.waiting.take()?;
        let Some(controller) = self.controller.as_deref_mut() else {
            return Some(Event::NotTaken(plan, NotTaken::Idle));
        };
        match gate.admits(plan.permit) {
            Admission::Begins => {}
            Admission::Waits => {
                self.waiting = Some(plan);
                return None;
            }
            Admission::Refused => return Some(Event::NotTaken(plan, NotTaken::NotEnabled)),
        }
        match ready(&plan, controller, tick) {
            Ok(true) if self.released => {}
            Ok(_) => {
                self.waiting = Some(plan);
                return None;
            }
            Err(why) => return Some(Event::NotTaken(plan, why)),
        }
        let samples = plan.samples.take()?;
        let moving = controller.is_moving();
        controller.keep_within(self.reach.begin(self.sent.position));
        match controller.load(samples) {
            Ok(old) => plan.samples = old,
            Err((samples, error)) => {
                plan.samples = Some(samples);
                return Some(Event::NotTaken(plan, NotTaken::Refused(error)));
            }
        }
        (self.move_id, self.ticket) = (plan.id, plan.ticket);
        (self.runs, self.settled) = (true, None);
        Some(Event::Taken(Taken {
            plan,
            tick,
            first: usize::from(moving),
            time,
        }))
    }
}
