//! Orders to the tick, and the handling of its answers.
//!
//! The tick answers each plan once: taken, or not. Until then the plan stays in a joint's `ordered`, whatever
//! was requested since: the tick may have begun it already, and then the joint follows it.

use super::Engine;
use super::cruise::Cruise;
use super::extent::check_range;
use super::in_motion::Moment;
use super::joint::{Asked, Ordered, Reply, What, Withdrawn, name_of};
use super::learned::WITHIN;
use super::pacing::Pacing;
use super::planning::{Planned, plan};
use super::running::Running;
use crate::controller::LoadError;
use crate::recording::to_resolution;
use crate::service::contract::{Accepted, Event as Told, MoveStart, ServiceError, Stopping};
use crate::service::tick::{NotTaken, Plan, Start, Taken, ToTick};

/// How far ahead a plan in motion begins, s: planning takes a few ms, and the tick takes orders at its next
/// start.
pub(super) const AHEAD: f64 = 0.02;
/// The furthest ahead, s.
const FURTHEST: f64 = 0.32;
/// Least share of the acceleration and jerk limits for a plan in motion: a stop then takes up to four times as
/// long.
const LEAST_EFFORT: f64 = 0.25;
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

    fn duration(&self, ordered: &Ordered) -> f64 {
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
        let planned = plan(joint, what, &self.planner, self.config.period, at)?;
        match what {
            // It goes no further than the move that it stops.
            What::Stop => Ok(planned),
            What::Move { .. } => check_range(joint, &planned.samples).map(|()| planned),
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
                self.disband(together.id, &ServiceError::Busy);
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

    /// Answers clients of a tick that does not answer, after the longest wait.
    fn answer_overdue(&mut self, index: usize, now: f64) {
        for ordered in &mut self.joints[index].ordered {
            if let Some(withdrawn) = ordered.withdrawn.take_if(|w| now > w.until) {
                answer(Some(withdrawn.reply), Err(withdrawn.why));
            }
        }
    }

    /// Removes the plan of this ticket from those that wait for the tick's answer.
    fn answered(&mut self, index: usize, ticket: u64) -> Option<Ordered> {
        let ordered = &mut self.joints[index].ordered;
        let at = ordered.iter().position(|one| one.ticket == ticket)?;
        Some(ordered.remove(at))
    }

    /// Handles a plan that was not taken: it is planned again, or given up.
    pub(super) fn not_taken(&mut self, plan: &Plan, why: NotTaken) {
        if self.change_not_taken(plan, &why) {
            return;
        }
        let Some(ordered) = self.answered(plan.joint, plan.ticket) else {
            return;
        };
        if let Some(together) = ordered.together {
            return self.member_not_taken(together.id, plan, why);
        }
        if let Some(withdrawn) = ordered.withdrawn {
            answer(Some(withdrawn.reply), Err(withdrawn.why));
        }
        let furthest = (FURTHEST / self.config.period) as u64;
        let joint = &mut self.joints[plan.joint];
        let Some(asked) = joint
            .asked
            .as_mut()
            .filter(|asked| asked.ticket == plan.ticket)
        else {
            return;
        };
        tracing::debug!(joint = joint.config.name, ?why, "a plan was not taken");
        asked.again = true;
        match why {
            NotTaken::Late => asked.ahead = (2 * asked.ahead).min(furthest),
            // The next report gives the present state for the plan's start.
            NotTaken::Outdated => {}
            // A correction under way leaves a smaller share of the limits to a new plan.
            NotTaken::Refused(LoadError::Correction(_)) => {
                asked.effort = (0.8 * asked.effort).max(LEAST_EFFORT)
            }
            // It was planned for a motion that has changed since.
            NotTaken::Refused(_) => {}
            NotTaken::NotEnabled => {
                // If the gate has just been closed, its event arrives together with this one.
                let why = self.enabling.allows_moves().err();
                self.withdraw_for(plan.joint, why.unwrap_or(ServiceError::Stopped));
            }
            NotTaken::Idle | NotTaken::Train(_) | NotTaken::Replaced | NotTaken::Withdrawn => {
                self.withdraw(plan.joint, &format!("{why:?}"));
            }
        }
    }

    /// Handles a plan that runs.
    pub(super) fn taken(&mut self, taken: &Taken) {
        if self.change_taken(taken) {
            return;
        }
        let index = taken.plan.joint;
        let Some(ordered) = self.answered(index, taken.plan.ticket) else {
            return;
        };
        let joint = &mut self.joints[index];
        if let Start::Rest(train) = &taken.plan.start {
            joint.mode = train.known.mode;
        }
        let positions = ordered.samples.positions(0);
        let from = positions.first().copied().unwrap_or(joint.position);
        joint.position = positions.last().copied().unwrap_or(joint.position);
        joint.stop_due &= !matches!(ordered.what, What::Stop);
        match (ordered.what, &mut joint.running) {
            (What::Stop, Some(running)) => {
                (running.plan, running.ticket) = (ordered.samples.clone(), ordered.ticket);
                (running.tick, running.first) = (taken.tick, taken.first);
                running.stopping = running.settled.is_none();
                running.interrupted |= running.stopping;
            }
            (What::Stop, None) => {}
            (What::Move { .. }, _) => self.begin_move(index, &ordered, taken, from),
        }
        self.joints[index].learning.turn = None;
        if let Start::Tick(_) = &taken.plan.start {
            self.have_turned(index, &ordered);
        }
        // A client that has its answer finds the move in the state.
        self.publish();
        if let Some(together) = ordered.together {
            self.begun(index, ordered.ticket);
            return self.member_taken(together.id, index, ordered.id);
        }
        let accepted = Accepted::Move {
            id: ordered.id,
            duration_s: self.duration(&ordered),
            speed: ordered.speed,
        };
        let reply = self.begun(index, ordered.ticket);
        let withdrawn = ordered.withdrawn.map(|withdrawn| withdrawn.reply);
        answer(reply.or(withdrawn), Ok(accepted));
    }

    /// Ends the order whose plan with this ticket has begun. Another pending order was planned for a different
    /// motion of the joint.
    fn begun(&mut self, index: usize, ticket: u64) -> Option<Reply> {
        let asked = &mut self.joints[index].asked;
        if let Some(asked) = asked.take_if(|asked| asked.ticket == ticket) {
            return asked.reply;
        }
        if let Some(asked) = asked {
            asked.again = true;
        }
        None
    }

    fn begin_move(&mut self, index: usize, asked: &Ordered, taken: &Taken, from: f64) {
        self.finish(index);
        self.tell_endings(|ending| ending.is_of(index));
        let before = self.joints.iter().map(|joint| joint.position).collect();
        let recording = self.recording_name(asked.id);
        let joint = &mut self.joints[index];
        let start = MoveStart {
            id: asked.id,
            joint: joint.config.name.clone(),
            joint_index: index,
            time_s: taken.time,
            unix_time_s: self.clock.unix_time(),
            from_rad: to_resolution(from),
            target_rad: joint.position,
            shaper: match asked.what {
                What::Move { within: true, .. } => WITHIN.to_owned(),
                _ => name_of(asked.shaper).to_owned(),
            },
            recording,
        };
        self.batch.events.push(Told::MoveStarted(start.clone()));
        let longest = match &taken.plan.start {
            Start::Rest(train) => train.train.duration(),
            // In motion the train in force is not known exactly, but no shaper is longer than two periods.
            Start::Tick(_) => 2.0 * joint.mode.damped_period(),
        };
        joint.running = Some(Running {
            start,
            recording: None,
            plan: asked.samples.clone(),
            ticket: asked.ticket,
            tick: taken.tick,
            first: taken.first,
            pacing: Pacing::new(asked.samples.clone(), asked.feed),
            speed: match asked.what {
                What::Move { speed, .. } => speed,
                What::Stop => f64::INFINITY,
            },
            turned: matches!(taken.plan.start, Start::Tick(_)),
            together: asked.together.map(|together| together.id),
            shaped: asked.shaper.is_some(),
            adaptive: joint.adaptation && asked.shaper.is_some(),
            payload: self.payload,
            stopping: false,
            interrupted: false,
            settled: None,
            planned: Vec::new(),
            after: Vec::new(),
            cruise: Cruise::new(longest),
            heard: Vec::new(),
            before,
            frozen: false,
            prescribed: joint.learning.prescribed == Some(asked.ticket),
        });
        // Saved now, so that the number is not used again even if the service is killed.
        self.save();
    }
}

/// Sends an answer, if a client waits; it may have disconnected.
pub(super) fn answer(reply: Option<Reply>, answer: Result<Accepted, ServiceError>) {
    if let Some(reply) = reply {
        let _ = reply.send(answer);
    }
}
