//! Moves of several joints that begin with the same tick and end with the same tick.
//!
//! Each joint has its own train, and the trains have different lengths `d_i`. A joint that alone takes `T_i`
//! ends `T_i + d_i` after the start. With `T = max (T_i + d_i)` its plan is stretched to `T - d_i`: with limits
//! times `s`, `s^2` and `s^3` a plan from rest to rest is the same, `1 / s` as long.
//!
//! The tick takes the plans together or not at all; if one of them ends early, all end.

use quell_shapers::Shaper;
use quell_trajectories::{AxisState, Limits, SampledTrajectory, Trajectory};

use super::Engine;
use super::answers::answer;
use super::extent::check_range;
use super::joint::{Asked, Reply, What};
use super::orders::TRIED;
use super::planning::{Planned, refused, standing_train};
use crate::service::contract::{Accepted, Begun, ServiceError};
use crate::service::tick::{NotTaken, Plan, Start, ToTick, Together, Train};
use crate::tolerance::Tolerance;

/// A move of several joints that the tick has not begun yet.
pub struct Group {
    id: u64,
    /// The joints and their targets, rad.
    pub members: Vec<(usize, f64)>,
    pub shaper: Option<Option<&'static dyn Shaper>>,
    /// The tolerance, and the motion of each joint once it is solved.
    pub within: Option<(Tolerance, Vec<SampledTrajectory>)>,
    /// The form of the answer.
    form: Form,
    /// Joints whose trains were solved for this move.
    pub prescribed: Vec<usize>,
    /// Plans that the tick has not answered.
    waiting: usize,
    begun: Vec<Begun>,
    /// Time until its commands rest, s.
    duration: f64,
    /// Why it cannot begin.
    why: Option<ServiceError>,
    /// Whether a plan was only outdated, and is planned again.
    outdated: bool,
    deadline: f64,
    pub reply: Option<Reply>,
}

/// The form in which a move of joints was requested and is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// As the move of one joint.
    Alone,
    /// As that of several.
    Together,
}

impl Group {
    /// A move that begins as soon as possible.
    pub fn new(id: u64, members: Vec<(usize, f64)>, now: f64, reply: Reply) -> Self {
        Self {
            id,
            members,
            shaper: None,
            within: None,
            form: Form::Together,
            prescribed: Vec::new(),
            waiting: 0,
            begun: Vec::new(),
            duration: 0.0,
            why: None,
            outdated: false,
            deadline: now + TRIED,
            reply: Some(reply),
        }
    }

    /// The same within a tolerance, with a motion that is not solved yet.
    pub fn within(self, tolerance: Tolerance, form: Form) -> Self {
        Self {
            within: Some((tolerance, Vec::new())),
            form,
            ..self
        }
    }

    /// The answer once all joints have begun.
    fn accepted(&self) -> Accepted {
        match (self.form, self.begun.as_slice()) {
            (Form::Alone, [begun]) => Accepted::Move {
                id: begun.id,
                duration_s: self.duration,
                speed: 1.0,
            },
            _ => Accepted::Together {
                moves: self.begun.clone(),
                duration_s: self.duration,
            },
        }
    }
}

impl Engine {
    /// Plans for joints at rest, after their trains are solved, and orders; the client is answered once the
    /// tick has begun all of it.
    pub(super) fn ask_together(
        &mut self,
        members: Vec<(usize, f64)>,
        shaper: Option<Option<&'static dyn Shaper>>,
        reply: Reply,
    ) {
        self.tickets += 1;
        let now = self.clock.now();
        let group = Group {
            shaper,
            ..Group::new(self.tickets, members, now, reply)
        };
        self.have_trains(group);
    }

    /// Orders, unless nobody waits for it any more.
    pub(super) fn begin_together(&mut self, mut group: Group) {
        if group.reply.as_ref().is_none_or(Reply::is_closed) {
            tracing::debug!("a move was given up by its client before it began");
            return;
        }
        let planned = match self.planned_together(&group) {
            Ok((planned, duration)) => {
                group.duration = duration;
                planned
            }
            Err(error) => return answer(group.reply, Err(error)),
        };
        let together = Together {
            id: group.id,
            size: group.members.len(),
        };
        group.waiting = together.size;
        (group.why, group.outdated) = (None, false);
        for (&(index, target), planned) in group.members.iter().zip(planned) {
            self.end_hold(index);
            self.state.last_move += 1;
            let asked = Asked {
                what: What::Move {
                    target,
                    shaper: group.shaper,
                    speed: f64::INFINITY,
                    within: group.within.is_some(),
                },
                id: self.state.last_move,
                ticket: 0,
                ahead: 0,
                together: Some(together),
                effort: 1.0,
                deadline: group.deadline,
                again: false,
                reply: None,
            };
            self.order(index, asked, planned);
            if group.prescribed.contains(&index) {
                let joint = &mut self.joints[index];
                joint.learning.prescribed = joint.asked.as_ref().map(|asked| asked.ticket);
            }
        }
        self.groups.push(group);
    }

    fn planned_together(&self, group: &Group) -> Result<(Vec<Planned>, f64), ServiceError> {
        self.enabling.allows_moves()?;
        if self.feed == 0.0 {
            return Err(ServiceError::NoFeed);
        }
        if let Some((_, motion)) = &group.within {
            return self.planned_within(&group.members, motion);
        }
        let each = group.members.iter();
        let alone: Vec<_> = each
            .map(|&(index, target)| self.planned_alone(index, target, group.shaper))
            .collect::<Result<_, _>>()?;
        let whole = alone.iter().map(Alone::duration).fold(0.0, f64::max);
        let stretched = group.members.iter().zip(alone).map(|(&(index, _), alone)| {
            let planned = self.stretched(alone, whole)?;
            check_range(&self.joints[index], &planned.samples).map(|()| planned)
        });
        Ok((stretched.collect::<Result<_, _>>()?, whole))
    }

    /// Checks that a joint accepts moves, rests, and has no pending order.
    pub(super) fn check_free(&self, index: usize) -> Result<(), ServiceError> {
        let joint = &self.joints[index];
        joint.takes_moves()?;
        match joint.is_at_rest() && joint.asked.is_none() && joint.ordered.is_empty() {
            true => Ok(()),
            false => Err(ServiceError::InMotion {
                joint: joint.config.name.clone(),
            }),
        }
    }

    /// The fastest plan of one joint.
    pub(super) fn planned_alone(
        &self,
        index: usize,
        target: f64,
        shaper: Option<Option<&'static dyn Shaper>>,
    ) -> Result<Alone, ServiceError> {
        self.check_free(index)?;
        let joint = &self.joints[index];
        let shaper = shaper.unwrap_or(joint.standing_shaper());
        let train = standing_train(joint, shaper, self.config.period)?;
        let limits = self.fed(joint.config.limits, f64::INFINITY);
        let ends = [joint.position, target].map(AxisState::at_rest);
        let plan = self.planner.plan(&ends[..1], &ends[1..], &[limits]);
        Ok(Alone {
            plan: plan.map_err(refused)?,
            ends,
            limits,
            train,
        })
    }

    /// The same plan, stretched so that it ends with all others, its train included.
    fn stretched(&self, alone: Alone, whole: f64) -> Result<Planned, ServiceError> {
        let Alone {
            plan,
            ends,
            limits,
            train,
        } = alone;
        let long = whole - train.train.duration();
        let speed = match long > 0.0 {
            true => plan.duration() / long,
            false => 1.0,
        };
        let plan = match speed > 0.0 && speed < 1.0 {
            true => {
                let slowed = [limits.slowed(speed)];
                let plan = self.planner.plan(&ends[..1], &ends[1..], &slowed);
                plan.map_err(refused)?
            }
            false => plan,
        };
        Ok(Planned {
            samples: plan.sample(self.config.period).map_err(refused)?,
            shaper: train.shaper,
            start: Start::Rest(Box::new(train)),
            speed,
        })
    }

    /// Handles the plan of one joint that has begun.
    pub(super) fn member_taken(&mut self, id: u64, index: usize, move_id: u64) {
        let joint = self.joints[index].config.name.clone();
        if let Some(group) = self.groups.iter_mut().find(|group| group.id == id) {
            group.waiting -= 1;
            group.begun.push(Begun { joint, id: move_id });
        }
        self.end_group(id);
    }

    /// Handles the plan of one joint that has not begun.
    pub(super) fn member_not_taken(&mut self, id: u64, plan: &Plan, why: NotTaken) {
        let asked = &mut self.joints[plan.joint].asked;
        asked.take_if(|asked| asked.ticket == plan.ticket);
        let joint = self.joints[plan.joint].config.name.clone();
        let outdated = why == NotTaken::Outdated;
        let error = match (why, self.enabling.allows_moves()) {
            (NotTaken::NotEnabled, Err(error)) => error,
            (why, _) => ServiceError::NotTaken {
                joint,
                reason: format!("{why:?}"),
            },
        };
        if let Some(group) = self.groups.iter_mut().find(|group| group.id == id) {
            group.waiting -= 1;
            group.outdated |= outdated && group.why.is_none();
        }
        self.disband(id, &error);
        self.end_group(id);
    }

    /// Withdraws the plans of all joints. The client is answered once the tick has answered them all.
    pub(super) fn disband(&mut self, id: u64, why: &ServiceError) {
        if let Some(group) = self.groups.iter_mut().find(|group| group.id == id) {
            group.why.get_or_insert_with(|| why.clone());
        }
        for (index, joint) in self.joints.iter_mut().enumerate() {
            let of = |asked: &mut Asked| asked.together.is_some_and(|together| together.id == id);
            if let Some(asked) = joint.asked.take_if(of) {
                let order = ToTick::Withdraw(index, asked.ticket);
                self.rings.orders.push(order);
            }
        }
    }

    /// Answers, once the tick has answered all plans.
    fn end_group(&mut self, id: u64) {
        let ended = |group: &Group| group.id == id && group.waiting == 0;
        let Some(at) = self.groups.iter().position(ended) else {
            return;
        };
        let group = self.groups.remove(at);
        match group.why {
            None => {
                let accepted = group.accepted();
                answer(group.reply, Ok(accepted));
            }
            Some(_) if group.outdated && group.begun.is_empty() => self.begin_together(group),
            Some(why) => {
                // A part of a move is not useful: joints that have begun are stopped.
                for (index, _) in &group.members {
                    self.stop(*index, why.clone());
                }
                answer(group.reply, Err(why));
            }
        }
    }

    /// Answers clients of a tick that does not answer, after the longest wait.
    pub(super) fn end_overdue(&mut self, now: f64) {
        for group in &mut self.groups {
            if now > group.deadline + TRIED
                && let Some(reply) = group.reply.take()
            {
                let what = "the tick has not answered";
                answer(Some(reply), Err(ServiceError::Overloaded { what }));
            }
        }
    }
}

/// The fastest plan of one joint, and its train.
pub struct Alone {
    pub plan: Trajectory,
    ends: [AxisState; 2],
    limits: Limits,
    pub train: Train,
}

impl Alone {
    /// Time until its command rests, s.
    fn duration(&self) -> f64 {
        self.plan.duration() + self.train.train.duration()
    }
}
