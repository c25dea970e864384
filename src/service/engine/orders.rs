//! What the tick is told, and what is done about its answers.

use quell_shapers::Setpoint;

use super::joint::{Asked, Reply, What, name_of};
use super::planning::{Moment, Planned, plan, standing_train};
use super::running::Running;
use super::{Engine, controller};
use crate::service::clock::unix_time;
use crate::service::contract::{Accepted, Event as Told, MoveStart, ServiceError};
use crate::service::tick::{NotTaken, Plan, Start, Taken, ToTick, TrainOrder};

/// How far ahead a plan in motion begins, s: planning takes a few ms, and the tick takes orders at its
/// next beginning.
const AHEAD: f64 = 0.02;
/// The furthest ahead, s.
const FURTHEST: f64 = 0.32;
/// Least share of the limits of acceleration and jerk with which a plan in motion is tried: a stop then
/// takes up to four times as long.
const LEAST_EFFORT: f64 = 0.25;
/// How long a plan is tried for, s: as long as a correction at 1 Hz lasts.
const TRIED: f64 = 3.0;

impl Engine {
    /// Plans and orders; whoever asked hears once the tick has taken it.
    pub(super) fn ask(&mut self, index: usize, what: What, reply: Option<Reply>) {
        let now = self.clock.now();
        let ahead = (AHEAD / self.config.period).ceil() as u64;
        let planned = match self.planned(index, what, ahead, 1.0) {
            Ok(planned) => planned,
            Err(error) => {
                tracing::debug!(joint = self.joints[index].config.name, "{error}");
                if let Some(reply) = reply {
                    // Whoever asked may have gone.
                    let _ = reply.send(Err(error));
                }
                return;
            }
        };
        let id = match what {
            What::Move { .. } => {
                self.state.last_move += 1;
                self.state.last_move
            }
            What::Stop => self.joints[index]
                .running
                .as_ref()
                .map_or(0, |r| r.start.id),
        };
        let asked = Asked {
            what,
            id,
            ticket: 0,
            samples: planned.samples.clone(),
            speed: planned.speed,
            shaper: planned.shaper,
            ahead,
            effort: 1.0,
            deadline: now + TRIED,
            again: false,
            reply,
        };
        if let Some(before) = self.joints[index].asked.take() {
            let joint = self.joints[index].config.name.clone();
            let reason = "another request came before it could begin".to_owned();
            Self::give_up(before, ServiceError::NotTaken { joint, reason });
        }
        self.order(index, asked, planned);
    }

    /// Brings a joint to rest; says how long the plan of the stop lasts, s.
    pub(super) fn stop(&mut self, index: usize) -> f64 {
        let joint = &mut self.joints[index];
        let waits = |asked: &mut Asked| matches!(asked.what, What::Move { .. });
        match joint.asked.take_if(waits) {
            // A plan that waits in the tick for rest is replaced by that of the stop.
            Some(asked) => Self::give_up(asked, ServiceError::Stopping),
            None if joint.asked.is_some() || joint.is_at_rest() => return 0.0,
            None => {}
        }
        if !joint.began {
            return 0.0;
        }
        self.joints[index].stop_due = true;
        self.ask(index, What::Stop, None);
        let asked = self.joints[index].asked.as_ref();
        asked.map_or(0.0, |asked| {
            (asked.samples.samples() - 1) as f64 * self.config.period
        })
    }

    fn planned(
        &self,
        index: usize,
        what: What,
        ahead: u64,
        effort: f64,
    ) -> Result<Planned, ServiceError> {
        let at = Moment {
            tick: self.next_tick() + ahead,
            effort,
        };
        plan(
            &self.joints[index],
            what,
            &self.planner,
            self.config.period,
            at,
        )
    }

    fn order(&mut self, index: usize, mut asked: Asked, planned: Planned) {
        self.tickets += 1;
        asked.ticket = self.tickets;
        asked.again = false;
        asked.speed = planned.speed;
        asked.shaper = planned.shaper;
        asked.samples = planned.samples.clone();
        let plan = Plan {
            joint: index,
            id: asked.id,
            ticket: asked.ticket,
            samples: Some(planned.samples),
            start: planned.start,
        };
        // Where the ring is full the tick is stuck; what was asked for runs out of time then.
        asked.again = self
            .rings
            .orders
            .push(ToTick::Plan(Box::new(plan)))
            .is_err();
        self.joints[index].asked = Some(asked);
    }

    /// Asks for a stop once more, as long as it is due: there is no reason to give it up.
    pub(super) fn insist_on_stop(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        joint.stop_due &= !joint.is_at_rest() || joint.asked.is_some();
        if joint.stop_due && joint.asked.is_none() {
            self.ask(index, What::Stop, None);
        }
    }

    /// Plans anew what the tick has not taken, as long as there is time.
    pub(super) fn retry(&mut self, now: f64) {
        for index in 0..self.joints.len() {
            let due = |asked: &mut Asked| asked.again || now > asked.deadline;
            let Some(asked) = self.joints[index].asked.take_if(due) else {
                continue;
            };
            let joint = self.joints[index].config.name.clone();
            if now > asked.deadline {
                let reason = "no moment was found at which it can begin".to_owned();
                Self::give_up(asked, ServiceError::NotTaken { joint, reason });
                continue;
            }
            match self.planned(index, asked.what, asked.ahead, asked.effort) {
                Ok(planned) => self.order(index, asked, planned),
                Err(error) => Self::give_up(asked, error),
            }
        }
    }

    /// A plan was not taken: it is made anew, or given up.
    pub(super) fn not_taken(&mut self, plan: &Plan, why: NotTaken) {
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
            // What was believed of the plan's start is renewed with the next report.
            NotTaken::Outdated => {}
            // A correction under way leaves less of the limits to a new plan.
            NotTaken::Refused(_) => asked.effort = (0.8 * asked.effort).max(LEAST_EFFORT),
            NotTaken::Idle | NotTaken::Train(_) | NotTaken::Replaced => {
                if let Some(asked) = joint.asked.take() {
                    let joint = joint.config.name.clone();
                    let reason = format!("{why:?}");
                    Self::give_up(asked, ServiceError::NotTaken { joint, reason });
                }
            }
        }
    }

    /// A plan runs.
    pub(super) fn taken(&mut self, taken: &Taken) {
        let index = taken.plan.joint;
        let joint = &mut self.joints[index];
        let ticket = taken.plan.ticket;
        let Some(asked) = joint.asked.take_if(|asked| asked.ticket == ticket) else {
            return;
        };
        if let Start::Rest(train) = &taken.plan.start {
            joint.mode = train.known.mode;
        }
        let target = asked.samples.positions(0).last().copied();
        let from = asked
            .samples
            .positions(0)
            .first()
            .copied()
            .unwrap_or(joint.position);
        joint.position = target.unwrap_or(joint.position);
        joint.stop_due &= !matches!(asked.what, What::Stop);
        let duration = (asked.samples.samples() - 1) as f64 * self.config.period;
        match (asked.what, &mut joint.running) {
            (What::Stop, Some(running)) => {
                running.plan = asked.samples;
                (running.tick, running.first) = (taken.tick, taken.first);
                running.stopping = running.settled.is_none();
                running.interrupted |= running.stopping;
            }
            (What::Stop, None) => {}
            (What::Move { .. }, _) => self.begin_move(index, &asked, taken, from),
        }
        if let Some(reply) = asked.reply {
            // Whoever asked may have gone.
            let _ = reply.send(Ok(Accepted::Move {
                id: asked.id,
                duration_s: duration,
                speed: asked.speed,
            }));
        }
    }

    fn begin_move(&mut self, index: usize, asked: &Asked, taken: &Taken, from: f64) {
        self.finish(index);
        let recording = self.recording_name(asked.id);
        let joint = &mut self.joints[index];
        let start = MoveStart {
            id: asked.id,
            joint: joint.config.name.clone(),
            joint_index: index,
            time_s: taken.time,
            unix_time_s: unix_time(),
            from_rad: from,
            target_rad: joint.position,
            shaper: name_of(asked.shaper).to_owned(),
            recording,
        };
        self.batch.events.push(Told::MoveStarted(start.clone()));
        joint.stopped_by_watchdog = false;
        joint.running = Some(Running {
            start,
            recording: None,
            plan: asked.samples.clone(),
            tick: taken.tick,
            first: taken.first,
            shaped: asked.shaper.is_some(),
            adaptive: joint.adaptation && asked.shaper.is_some(),
            payload: self.payload,
            stopping: false,
            interrupted: false,
            settled: None,
            planned: Vec::new(),
            after: Vec::new(),
        });
    }

    /// Orders the train that should be in force, if another one is.
    pub(super) fn order_train(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        if !joint.train_due || !joint.began {
            return;
        }
        match standing_train(joint, joint.standing_shaper(), self.config.period) {
            Ok(train) => {
                let order = TrainOrder {
                    joint: index,
                    train,
                };
                let ordered = self.rings.orders.push(ToTick::Train(Box::new(order)));
                self.joints[index].train_due = ordered.is_err();
            }
            Err(error) => {
                tracing::warn!(joint = joint.config.name, "{error}");
                joint.train_due = false;
            }
        }
    }

    /// The tick has taken a train, or not.
    pub(super) fn train_answered(&mut self, order: &TrainOrder, answer: &Result<(), NotTaken>) {
        let joint = &mut self.joints[order.joint];
        match answer {
            Ok(()) => {
                let mode = order.train.known.mode;
                if joint.mode != mode {
                    joint.mode_since = unix_time();
                }
                joint.mode = mode;
                joint.wanted_mode = joint.wanted_mode.filter(|wanted| *wanted != mode);
            }
            Err(NotTaken::Outdated) => joint.train_due = true,
            Err(why) => tracing::warn!(joint = joint.config.name, ?why, "a train was not taken"),
        }
    }

    /// Begins to command a joint that stands still at `position` (rad).
    pub(super) fn begin(&mut self, index: usize, position: f64) {
        let joint = &mut self.joints[index];
        let mode = joint.wanted_mode.take().unwrap_or(joint.mode);
        let made = controller(
            &joint.config,
            joint.standing_shaper(),
            mode,
            joint.sensor.clone(),
            position,
            self.config.period,
        );
        match made {
            Ok(controller) => {
                let start = Setpoint::at_rest(position);
                let order = ToTick::Begin(index, Box::new(controller));
                joint.began = self.rings.orders.push(order).is_ok();
                joint.report = None;
                (joint.position, joint.mode, joint.retunes) = (start.position, mode, 0);
                tracing::info!(joint = joint.config.name, position, "commanded from here");
            }
            Err(error) => tracing::warn!(joint = joint.config.name, "{error}"),
        }
    }

    /// The embedded arm needs no waiting: it stands where it stands.
    pub(super) fn begin_embedded(&mut self) {
        if let Some(arm) = &self.arm {
            let position = arm.true_motor_position();
            self.begin(0, position);
        }
    }
}
