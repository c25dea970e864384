//! Orders to the tick.
//!
//! Until the tick has answered a plan (`answers.rs`), the plan stays in a joint's `ordered`, whatever
//! was requested since: the tick may have begun it already, and then the joint follows it.

use super::Engine;
use super::answers::answer;
use super::extent::check_range;
use super::in_motion::Moment;
use super::joint::{Asked, Ordered, Reply, What, Withdrawn};
use super::planning::{Planned, plan};
use crate::service::contract::{ServiceError, Stopping};
use crate::service::tick::{Plan, ToTick};

/// How far ahead a plan in motion begins, s: planning takes a few ms, and the tick takes orders at its next
/// start.
pub(super) const AHEAD: f64 = 0.02;
/// How long a plan is tried, s: as long as a correction at 1 Hz lasts.
pub(super) const TRIED: f64 = 3.0;

impl Engine {
    /// Plans and orders; the client gets the answer once the tick has taken the plan.
    pub(super) fn ask(&mut self, index: usize, what: What, reply: Option<Reply>) {
        let ahead = (AHEAD / self.config.period).ceil() as u64;
        let planned = match self.planned(index, what, ahead, 1.0) {
            Ok(planned) => planned,
            Err(error) => {
                tracing::debug!(joint = self.joints[index].config.name, "{error}");
                answer(reply, Err(error));
                return;
            }
        };
        let id = match what {
            What::Move { .. } => {
                self.state.last_move += 1;
                self.state.last_move
            }
            What::Stop => self.last_move(index),
        };
        self.withdraw(index, "another request came before it could begin");
        let asked = Asked {
            what,
            id,
            ticket: 0,
            ahead,
            together: None,
            effort: 1.0,
            deadline: self.clock.now() + TRIED,
            again: false,
            reply,
        };
        self.go(index, asked, planned);
    }

    /// Number of the move that runs or ran last; 0 before the first.
    pub(super) fn last_move(&self, index: usize) -> u64 {
        let joint = &self.joints[index];
        let name = &joint.config.name;
        let before = || self.moves.iter().rfind(|result| result.joint == *name);
        match &joint.running {
            Some(running) => running.start.id,
            None => before().map_or(0, |result| result.id),
        }
    }

    /// Withdraws the order of a joint. Its client is answered with `why` once the tick has reported that it has
    /// not begun.
    pub(super) fn withdraw(&mut self, index: usize, why: &str) {
        let joint = &mut self.joints[index];
        let why = ServiceError::NotTaken {
            joint: joint.config.name.clone(),
            reason: why.to_owned(),
        };
        self.withdraw_for(index, why);
    }

    pub(super) fn withdraw_for(&mut self, index: usize, why: ServiceError) {
        let asked = self.joints[index].asked.as_ref();
        if let Some(together) = asked.and_then(|asked| asked.together) {
            return self.disband(together.id, &why);
        }
        let joint = &mut self.joints[index];
        let Some(asked) = joint.asked.take() else {
            return;
        };
        let mut ordered = joint.ordered.iter_mut();
        let Some(ordered) = ordered.find(|ordered| ordered.ticket == asked.ticket) else {
            return answer(asked.reply, Err(why));
        };
        ordered.withdrawn = asked.reply.map(|reply| Withdrawn {
            reply,
            why,
            until: self.clock.now() + TRIED,
        });
        let order = ToTick::Withdraw(index, ordered.ticket);
        self.rings.orders.push(order);
    }

    /// Brings a joint to rest, if it moves or is about to. A waiting move is answered with `why`.
    pub(super) fn stop(&mut self, index: usize, why: ServiceError) -> Option<Stopping> {
        self.end_hold(index);
        let joint = &self.joints[index];
        let stops = |asked: &Asked| matches!(asked.what, What::Stop);
        if !joint.asked.as_ref().is_some_and(stops) {
            self.withdraw_for(index, why);
            let joint = &mut self.joints[index];
            if !joint.began || (joint.is_at_rest() && joint.ordered.is_empty()) {
                return None;
            }
            joint.stop_due = true;
            self.ask(index, What::Stop, None);
        }
        Some(self.stopping(index))
    }

    /// A joint whose stop was ordered: it rests after the plan and the train.
    fn stopping(&self, index: usize) -> Stopping {
        let joint = &self.joints[index];
        let train = joint.axis().map_or(0.0, |axis| axis.train.duration());
        let rest = |asked: &Asked| {
            let plan = self.duration(joint.ordered_for(asked)?);
            Some(asked.ahead as f64 * self.config.period + plan + train)
        };
        Stopping {
            joint: joint.config.name.clone(),
            duration_s: joint.asked.as_ref().and_then(rest),
        }
    }

    pub(super) fn duration(&self, ordered: &Ordered) -> f64 {
        (ordered.samples.samples() - 1) as f64 * self.config.period
    }

    pub(super) fn planned(
        &self,
        index: usize,
        what: What,
        ahead: u64,
        effort: f64,
    ) -> Result<Planned, ServiceError> {
        let joint = &self.joints[index];
        let own = joint.config.limits;
        let mut fed = own;
        if let What::Move { speed, .. } = what {
            if self.feed == 0.0 {
                return Err(ServiceError::NoFeed);
            }
            fed = self.fed(own, speed);
            // Checked at each try: the permit may be lost between two tries.
            self.enabling.allows_moves()?;
            joint.takes_moves()?;
        }
        let at = Moment {
            tick: self.next_tick() + ahead,
            effort,
            own,
            fed,
        };
        let plan = |at| plan(joint, what, &self.planner, self.config.period, at);
        match what {
            // It goes no further than the move that it stops. Whatever becomes of the line, it is stopped.
            What::Stop => plan(Moment {
                own: self.braking(index),
                ..at
            })
            .or_else(|_| plan(at)),
            What::Move { .. } => {
                let planned = plan(at)?;
                check_range(joint, &planned.samples).map(|()| planned)
            }
        }
    }

    pub(super) fn order(&mut self, index: usize, mut asked: Asked, planned: Planned) {
        self.tickets += 1;
        asked.ticket = self.tickets;
        asked.again = false;
        let ordered = Ordered {
            ticket: asked.ticket,
            what: asked.what,
            id: asked.id,
            samples: planned.samples.clone(),
            speed: planned.speed,
            feed: self.feed,
            shaper: planned.shaper,
            together: asked.together,
            withdrawn: None,
        };
        let plan = Plan {
            joint: index,
            id: asked.id,
            ticket: asked.ticket,
            samples: Some(planned.samples),
            start: planned.start,
            together: asked.together,
            permit: matches!(asked.what, What::Move { .. }).then_some(self.enabling.permit),
        };
        self.rings.orders.push(ToTick::Plan(Box::new(plan)));
        let joint = &mut self.joints[index];
        joint.ordered.push(ordered);
        joint.asked = Some(asked);
    }

    /// Orders a stop again as long as it is due: it is never given up. A stop that the tick has not answered
    /// yet is not ordered twice.
    pub(super) fn insist_on_stop(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        joint.stop_due &= !joint.is_at_rest() || joint.asked.is_some() || !joint.ordered.is_empty();
        if joint.stop_due && joint.asked.is_none() && !self.rings.orders.is_behind() {
            self.ask(index, What::Stop, None);
        }
    }

    /// Plans again what the tick has not taken, until the deadline.
    pub(super) fn retry(&mut self, now: f64) {
        self.end_overdue(now);
        for index in 0..self.joints.len() {
            self.answer_overdue(index, now);
            let late = |asked: &Asked| now > asked.deadline;
            if self.joints[index].asked.as_ref().is_some_and(late) {
                self.withdraw(index, "no moment was found at which it can begin");
            }
            let Some(asked) = self.joints[index].asked.take_if(|asked| asked.again) else {
                continue;
            };
            if let Some(together) = asked.together {
                let what = "the joints could not begin at one tick";
                self.disband(together.id, &ServiceError::Overloaded { what });
                continue;
            }
            if asked.is_abandoned() {
                continue;
            }
            match self.planned(index, asked.what, asked.ahead, asked.effort) {
                Ok(planned) => self.go(index, asked, planned),
                Err(error) => answer(asked.reply, Err(error)),
            }
        }
    }
}
