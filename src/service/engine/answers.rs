//! The answers of the tick to plans, and those of the engine to the clients who wait for them.
//!
//! The tick answers each plan once: taken, or not. A plan that it has not taken is made again, or given up.

use super::Engine;
use super::cruise::Cruise;
use super::joint::{Ordered, Reply, What, name_of};
use super::learned::WITHIN;
use super::pacing::Pacing;
use super::running::Running;
use crate::controller::LoadError;
use crate::recording::to_resolution;
use crate::service::contract::{Accepted, Event as Told, MoveEnd, MoveStart, ServiceError};
use crate::service::tick::{NotTaken, Plan, Start, Taken};

/// The furthest ahead that a plan in motion begins, s.
const FURTHEST: f64 = 0.32;
/// Least share of the acceleration and jerk limits for a plan in motion: a stop then takes up to four times as
/// long.
const LEAST_EFFORT: f64 = 0.25;

impl Engine {
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
                running.stop();
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

    /// Removes the plan of this ticket from those that wait for the tick's answer.
    fn answered(&mut self, index: usize, ticket: u64) -> Option<Ordered> {
        let ordered = &mut self.joints[index].ordered;
        let at = ordered.iter().position(|one| one.ticket == ticket)?;
        Some(ordered.remove(at))
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
            ends: MoveEnd::Target,
            fault: None,
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

    /// Answers clients of a tick that does not answer, after the longest wait.
    pub(super) fn answer_overdue(&mut self, index: usize, now: f64) {
        for ordered in &mut self.joints[index].ordered {
            if let Some(withdrawn) = ordered.withdrawn.take_if(|w| now > w.until) {
                answer(Some(withdrawn.reply), Err(withdrawn.why));
            }
        }
    }
}

/// Sends an answer, if a client waits; it may have disconnected.
pub(super) fn answer(reply: Option<Reply>, answer: Result<Accepted, ServiceError>) {
    if let Some(reply) = reply {
        let _ = reply.send(answer);
    }
}
