//! Trains for the ways of a move of several joints: each joint's learner solves its train, and the move waits
//! for all of them.

use quell_shapers::UncertainMode;

use super::Engine;
use super::answers::answer;
use super::axis::train;
use super::joint::name_of;
use super::learning::PATIENCE;
use super::together::Group;
use crate::learning::{Prescription, Surroundings, Way};
use crate::service::contract::ServiceError;
use crate::service::learners::{Job, Wanted};

/// A move of several joints that waits for its trains.
pub struct Waiting {
    pub group: Group,
    /// Numbers of the plans whose trains are not solved yet.
    pub tickets: Vec<u64>,
    /// End of the wait, s.
    pub until: f64,
}

impl Engine {
    /// Begins a move; if modes of its joints are known, after the trains for its ways are solved.
    pub(super) fn have_trains(&mut self, group: Group) {
        let mut tickets = Vec::new();
        for &(index, target) in &group.members {
            let Some(wanted) = self.wanted_together(index, target, &group) else {
                continue;
            };
            self.tickets += 1;
            tickets.push(self.tickets);
            let wanted = Wanted {
                ticket: self.tickets,
                ..wanted
            };
            // It lives as long as the engine.
            let _ = self.lessons.jobs.send(Job::Prescribe(Box::new(wanted)));
        }
        if tickets.is_empty() {
            return self.begin_together(group);
        }
        self.waiting.push(Waiting {
            group,
            tickets,
            until: self.clock.now() + PATIENCE,
        });
    }

    /// The fastest plan of a joint for its learner; `None` where its train is not to be solved.
    fn wanted_together(&self, index: usize, target: f64, group: &Group) -> Option<Wanted> {
        let joint = &self.joints[index];
        let rule = group.shaper.unwrap_or(joint.standing_shaper());
        let own = name_of(rule) == name_of(joint.standing_shaper());
        if !(own && rule.is_some() && joint.adaptation && joint.learning.modes > 0) {
            return None;
        }
        let alone = self.planned_alone(index, target, group.shaper).ok()?;
        let believed = UncertainMode::believed(joint.config.belief);
        Some(Wanted {
            joint: index,
            ticket: 0,
            plan: alone.plan.sample(self.config.period).ok()?,
            surroundings: self.surroundings_of(index, &group.members),
            in_force: alone.train.train,
            base: train(rule, &believed, self.config.period).ok()?,
            anywhere: false,
        })
    }

    /// Conditions along the way of a joint while others move, too, each to its target (rad).
    pub(super) fn surroundings_of(&self, index: usize, members: &[(usize, f64)]) -> Surroundings {
        let mut surroundings = self.surroundings(index, None);
        let others = (0..self.joints.len()).filter(|other| *other != index);
        for (way, other) in surroundings.others.iter_mut().zip(others) {
            let mut members = members.iter();
            if let Some((_, target)) = members.find(|(member, _)| *member == other) {
                *way = Way::new(self.joints[other].position, *target);
            }
        }
        surroundings
    }

    /// Whether a move of several joints waits for the train of this plan.
    pub(super) fn waits_together(&self, ticket: u64) -> bool {
        let mut waiting = self.waiting.iter();
        waiting.any(|waiting| waiting.tickets.contains(&ticket))
    }

    /// Handles the solved train of one joint.
    pub(super) fn prescribed_together(
        &mut self,
        index: usize,
        ticket: u64,
        prescription: Prescription,
    ) {
        self.take_prescription(index, prescription);
        for waiting in &mut self.waiting {
            if waiting.tickets.contains(&ticket) {
                waiting.tickets.retain(|one| *one != ticket);
                waiting.group.prescribed.push(index);
            }
        }
        self.begin_waiting(|waiting| waiting.tickets.is_empty());
    }

    /// Begins moves that need not wait any longer.
    pub(super) fn begin_waiting(&mut self, which: impl Fn(&Waiting) -> bool) {
        while let Some(at) = self.waiting.iter().position(&which) {
            let waiting = self.waiting.remove(at);
            self.begin_together(waiting.group);
        }
    }

    /// Drops waiting moves, since all joints are being stopped.
    pub(super) fn drop_waiting(&mut self, why: &ServiceError) {
        for waiting in self.waiting.drain(..) {
            answer(waiting.group.reply, Err(why.clone()));
        }
    }
}
