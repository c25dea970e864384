//! Learning between moves: the trains of the learners for the next moves.
//!
//! A move from rest waits for its train, but at most for [`PATIENCE`]; then it uses the standing one. A train
//! goes to the tick with the plan for which it was solved.

use quell_shapers::{Shaper, UncertainMode};
use quell_trajectories::SampledTrajectory;

use super::Engine;
use super::axis::train;
use super::joint::{Asked, What, name_of};
use super::planning::{Planned, standing_train};
use crate::learning::{Hold, Memory, Prescription, Surroundings, Way};
use crate::service::contract::{Accepted, KnownMode, LearningView, ServiceError};
use crate::service::learners::{Job, Said, Wanted};
use crate::service::tick::{Start, Train};

/// Most time that a move waits for its train, s: hardly noticeable.
pub(super) const PATIENCE: f64 = 0.1;

impl Engine {
    /// Orders a plan; if the joint's modes are known, after the train for it has been solved.
    pub(super) fn go(&mut self, index: usize, mut asked: Asked, planned: Planned) {
        let Some(wanted) = self.wanted_train(index, &asked, &planned) else {
            return self.order(index, asked, planned);
        };
        self.tickets += 1;
        (asked.ticket, asked.again) = (self.tickets, false);
        let wanted = Wanted {
            ticket: asked.ticket,
            ..wanted
        };
        let joint = &mut self.joints[index];
        joint.learning.waits = Some((asked.ticket, self.clock.now() + PATIENCE));
        joint.asked = Some(asked);
        // The learners live as long as the engine.
        let _ = self.lessons.jobs.send(Job::Prescribe(Box::new(wanted)));
    }

    /// The plan for the learner; `None` where its train is not to be solved.
    fn wanted_train(&self, index: usize, asked: &Asked, planned: &Planned) -> Option<Wanted> {
        let Start::Rest(in_force) = &planned.start else {
            return None;
        };
        let wanted = self.wanted(index, asked.what, &planned.samples, planned.shaper)?;
        Some(Wanted {
            in_force: in_force.train.clone(),
            ..wanted
        })
    }

    /// The plan of a joint by a rule for the learner, with the train of the belief in force; `None` without
    /// knowledge of the joint.
    pub(super) fn wanted(
        &self,
        index: usize,
        what: What,
        plan: &SampledTrajectory,
        rule: Option<&'static dyn Shaper>,
    ) -> Option<Wanted> {
        let joint = &self.joints[index];
        let What::Move { speed, .. } = what else {
            return None;
        };
        let own = name_of(rule) == name_of(joint.standing_shaper());
        if !(own && rule.is_some() && joint.adaptation && joint.learning.modes > 0) {
            return None;
        }
        let believed = UncertainMode::believed(joint.config.belief);
        let base = train(rule, &believed, self.config.period).ok()?;
        Some(Wanted {
            joint: index,
            ticket: 0,
            surroundings: self.surroundings(index, None),
            in_force: base.clone(),
            base,
            plan: plan.clone(),
            // A jog may end anywhere.
            anywhere: speed.is_finite(),
        })
    }

    /// Conditions along the way of a joint: the other joints, from their earlier (rad) to their present
    /// positions, and the payload.
    pub(super) fn surroundings(&self, index: usize, before: Option<&[f64]>) -> Surroundings {
        let others = (0..self.joints.len()).filter(|other| *other != index);
        let way = |other: usize| {
            let now = self.joints[other].position;
            let from = before.and_then(|before| before.get(other).copied());
            Way::new(from.unwrap_or(now), now)
        };
        Surroundings {
            others: others.map(way).collect(),
            payload: self.payload.unwrap_or(0.0),
        }
    }

    /// Handles messages of the learners.
    pub(super) fn hear_learners(&mut self) {
        while let Ok(said) = self.lessons.said.try_recv() {
            match said {
                Said::Prescribed {
                    joint,
                    ticket,
                    prescription,
                } => match self.waits_together(ticket) {
                    true => self.prescribed_together(joint, ticket, *prescription),
                    false => self.prescribed(joint, ticket, *prescription),
                },
                Said::Along {
                    joint,
                    ticket,
                    prescription,
                } => self.looked_along(joint, ticket, prescription),
                Said::Within {
                    ticket,
                    moving,
                    found,
                } => self.solved_within(ticket, &moving, found),
                Said::Judged(judged) => self.judged(*judged),
                Said::Known {
                    joint,
                    modes,
                    memory,
                    map,
                } => {
                    let joint = &mut self.joints[joint];
                    (joint.learning.modes, joint.learning.map) = (modes, map);
                    if modes == 0 {
                        joint.learning.view = LearningView::default();
                    }
                    let name = joint.config.name.clone();
                    self.remember(name, memory);
                }
            }
        }
    }

    /// After a restart, shows the modes on the way of each joint's last move again, as far as they are still known.
    pub(super) fn show_remembered(&mut self) {
        for joint in &mut self.joints {
            let name = &joint.config.name;
            let known = self
                .state
                .joints
                .get(name)
                .and_then(|state| state.map.as_ref());
            let known = known.map_or(0, |map| map.modes.len());
            let last = self.moves.iter().rev().find(|done| done.joint == *name);
            if let Some(last) = last.filter(|last| last.modes.len() <= known) {
                joint.learning.view.modes.clone_from(&last.modes);
            }
        }
    }

    fn remember(&mut self, joint: String, memory: Memory) {
        let kept = self.state.joints.get(&joint);
        let kept = kept.and_then(|state| state.map.clone());
        if kept.unwrap_or_default() != memory {
            self.state.joints.entry(joint).or_default().map = Some(memory);
            self.save();
        }
    }

    /// Handles a solved train. If nothing waits for it any more, it is of another way and is dropped.
    fn prescribed(&mut self, index: usize, ticket: u64, prescription: Prescription) {
        let joint = &mut self.joints[index];
        let turn = joint.learning.turn.take_if(|turn| turn.asked == ticket);
        if let Some(turn) = turn {
            return self.retune(index, turn, prescription);
        }
        let waits = joint.learning.waits.take_if(|waits| waits.0 == ticket);
        let asked = joint.asked.take_if(|asked| asked.ticket == ticket);
        let (Some(_), Some(asked)) = (waits, asked) else {
            return;
        };
        self.take_prescription(index, prescription);
        self.order_waiting(index, asked);
        let asked = self.joints[index].asked.as_ref();
        self.joints[index].learning.prescribed = asked.map(|asked| asked.ticket);
    }

    /// Makes the solved train the standing one.
    pub(super) fn take_prescription(&mut self, index: usize, prescription: Prescription) {
        let joint = &mut self.joints[index];
        joint.learning.view = view(&prescription);
        match standing_train(joint, joint.standing_shaper(), self.config.period) {
            Ok(standing) => {
                let solved = prescription.train.zip(prescription.known);
                let (train, known) = solved.unwrap_or((standing.train, standing.known));
                joint.learning.solved = Some(Train {
                    train,
                    known,
                    hold: prescription.hold,
                    ..standing
                });
            }
            Err(error) => tracing::warn!(joint = joint.config.name, "{error}"),
        }
    }

    /// Orders a plan that has waited for its train.
    fn order_waiting(&mut self, index: usize, asked: Asked) {
        match self.planned(index, asked.what, asked.ahead, asked.effort) {
            Ok(planned) => self.order(index, asked, planned),
            Err(error) => super::answers::answer(asked.reply, Err(error)),
        }
    }

    /// Orders plans that have waited too long, with the standing train.
    pub(super) fn wait_no_longer(&mut self, now: f64) {
        self.tell_endings(|ending| ending.is_overdue(now));
        self.begin_waiting(|waiting| now > waiting.until);
        for index in 0..self.joints.len() {
            let joint = &mut self.joints[index];
            let Some((ticket, _)) = joint.learning.waits.take_if(|waits| now > waits.1) else {
                continue;
            };
            let Some(asked) = joint.asked.take_if(|asked| asked.ticket == ticket) else {
                continue;
            };
            self.order_waiting(index, asked);
        }
    }

    /// Discards the knowledge of a joint. The mode of the configuration is used again.
    pub(super) fn forget(&mut self, name: &str) -> Result<Accepted, ServiceError> {
        let index = self.index_of(name)?;
        let joint = &mut self.joints[index];
        joint.learning.solved = None;
        joint.learning.view = LearningView::default();
        joint.wanted_mode = Some(joint.config.belief);
        joint.train_due = true;
        if let Some(state) = self.state.joints.get_mut(name) {
            (state.map, state.modes) = (None, Vec::new());
        }
        // It lives as long as the engine.
        let _ = self.lessons.jobs.send(Job::Forget(index));
        self.save();
        self.order_train(index);
        Ok(Accepted::Changed)
    }
}

fn view(prescription: &Prescription) -> LearningView {
    let hold: Option<Hold> = prescription.hold;
    LearningView {
        modes: prescription.modes.iter().map(KnownMode::from).collect(),
        expected_percent: prescription.expected.map(|share| 100.0 * share),
        held: hold.map(|hold| hold.name().to_owned()),
        held_reason: hold.map(|hold| format!("the train is solved for {}", hold.reason())),
    }
}
