//! Moves within a tolerance: the fastest ones, solved by the learners for the modes of their ways.
//!
//! The solution is sent without a train, and is not retuned. A tolerance is never dropped: without a solution
//! in time, nothing moves.

use quell_trajectories::SampledTrajectory;

use super::Engine;
use super::answers::answer;
use super::extent::check_range;
use super::joint::Reply;
use super::planning::{Planned, standing_train};
use super::together::{Form, Group};
use super::together_trains::Waiting;
use crate::service::contract::ServiceError;
use crate::service::learners::{Job, Member, Within};
use crate::service::tick::Start;
use crate::tolerance::{Moving, Tolerance, ToleranceError};

/// Time for the solution of the motion, s: three times the longest for one joint and one mode, and less than a plan is
/// tried for.
const SOLVED: f64 = 2.0;

impl Engine {
    /// Has the motion of joints at rest solved; the client is answered once the tick has begun it.
    pub(super) fn ask_within(
        &mut self,
        members: Vec<(usize, f64)>,
        tolerance: Tolerance,
        form: Form,
        reply: Reply,
    ) {
        self.tickets += 1;
        let now = self.clock.now();
        let group = Group::new(self.tickets, members, now, reply).within(tolerance, form);
        self.have_solved(group, tolerance, now + SOLVED);
    }

    fn have_solved(&mut self, group: Group, tolerance: Tolerance, until: f64) {
        let each = group.members.iter();
        let members = each.map(|&(index, target)| self.member(index, target, &group.members));
        let members = match members.collect::<Result<Vec<_>, _>>() {
            Ok(members) => members,
            Err(error) => return answer(group.reply, Err(error)),
        };
        self.tickets += 1;
        let within = Within {
            ticket: self.tickets,
            members,
            tolerance,
            period: self.config.period,
        };
        // It lives as long as the engine.
        let _ = self.lessons.jobs.send(Job::Within(Box::new(within)));
        self.waiting.push(Waiting {
            group,
            tickets: vec![self.tickets],
            until,
        });
    }

    fn member(
        &self,
        index: usize,
        target: f64,
        members: &[(usize, f64)],
    ) -> Result<Member, ServiceError> {
        let alone = self.planned_alone(index, target, Some(None))?;
        let plan = alone.plan.sample(self.config.period);
        Ok(Member {
            joint: index,
            plan: plan.map_err(super::planning::refused)?,
            surroundings: self.surroundings_of(index, members),
            moving: self.moving(index, target),
        })
    }

    /// A joint from its rest position, at the present feed.
    fn moving(&self, index: usize, target: f64) -> Moving {
        let joint = &self.joints[index];
        Moving {
            ends: [joint.position, target],
            limits: self.fed(joint.config.limits, f64::INFINITY),
            modes: vec![joint.known()],
            lever: joint.sensor.arc().map_or(1.0, |arc| arc.radius()),
        }
    }

    /// Handles the solution. If it is for another start or feed, it is solved again.
    pub(super) fn solved_within(
        &mut self,
        ticket: u64,
        moving: &[Moving],
        found: Result<Vec<SampledTrajectory>, ToleranceError>,
    ) {
        let mut waiting = self.waiting.iter();
        let Some(at) = waiting.position(|waiting| waiting.tickets.contains(&ticket)) else {
            return;
        };
        let Waiting {
            mut group, until, ..
        } = self.waiting.remove(at);
        let Some((tolerance, motion)) = &mut group.within else {
            return;
        };
        let tolerance = *tolerance;
        let same = group.members.iter().zip(moving).all(|(member, solved)| {
            let now = self.moving(member.0, member.1);
            (now.ends, now.limits) == (solved.ends, solved.limits)
        });
        match found {
            _ if !same => self.have_solved(group, tolerance, until),
            Ok(found) => {
                *motion = found;
                self.begin_together(group);
            }
            Err(error) => {
                let reason = error.to_string();
                answer(group.reply, Err(ServiceError::Plan { reason }));
            }
        }
    }

    /// The motion of joints that still rest, and its duration, s.
    pub(super) fn planned_within(
        &self,
        members: &[(usize, f64)],
        motion: &[SampledTrajectory],
    ) -> Result<(Vec<Planned>, f64), ServiceError> {
        if motion.len() != members.len() {
            let what = "the motion within the tolerance was not found in time";
            return Err(ServiceError::Overloaded { what });
        }
        let planned = members.iter().zip(motion).map(|(&(index, _), samples)| {
            self.check_free(index)?;
            let train = standing_train(&self.joints[index], None, self.config.period)?;
            check_range(&self.joints[index], samples)?;
            Ok(Planned {
                samples: samples.clone(),
                start: Start::Rest(Box::new(train)),
                speed: 1.0,
                shaper: None,
            })
        });
        let planned = planned.collect::<Result<Vec<_>, _>>()?;
        let ticks = motion.iter().map(|plan| plan.samples().saturating_sub(1));
        let longest = ticks.max().unwrap_or_default();
        Ok((planned, longest as f64 * self.config.period))
    }
}
