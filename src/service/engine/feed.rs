//! The feed: the share of full speed at which everything moves. A change acts on running moves, too.
//!
//! A running move continues on its own plan at another rate (`quell_trajectories::RateRamp`), by the shortest
//! change of the rate that keeps the limits. The train acts on that motion in its own, unchanged time, so that
//! it still cancels the same vibration. Joints that began with the same tick change with the same tick, and
//! still end with the same tick. If the limits do not allow a change yet, for example while a move brakes at
//! its limit, it is tried again. A move that began in motion is planned again.

use quell_trajectories::{Limits, RateRamp, SampledTrajectory};

use super::Engine;
use super::in_motion::{Moment, in_motion};
use super::joint::What;
use super::orders::AHEAD;
use super::pacing::{Change, Pacing};
use super::running::Running;
use crate::service::contract::{Accepted, ServiceError};
use crate::service::tick::{NotTaken, Plan, Start, Taken, ToTick, Together};

/// The least feed other than 0. The engine makes a sample for each control period of a plan, 1 / feed times as many as at
/// full speed, and a stop waits for it meanwhile.
const LEAST: f64 = 0.01;

/// A joint whose rate is to be changed.
struct Member<'a> {
    index: usize,
    running: &'a Running,
    /// The sample of its plan before the change.
    sample: usize,
    /// Its target rate.
    rate: f64,
    /// Length of its train, s.
    train: f64,
    /// Its limits.
    limits: Limits,
}

impl Engine {
    /// Changes the share of full speed (0, or 0.01 to 1). At 0 all motion is stopped.
    pub(super) fn change_feed(&mut self, share: f64) -> Result<Accepted, ServiceError> {
        if share != 0.0 && !(LEAST..=1.0).contains(&share) {
            return Err(ServiceError::Value {
                what: "the feed as a share",
                value: share,
                rule: "0, or from 0.01 to 1",
            });
        }
        self.feed = share;
        if share == 0.0 {
            self.stop_all(&ServiceError::Stopped);
        }
        Ok(Accepted::Changed)
    }

    /// The limits of a joint's move at the present feed, from its own limits.
    ///
    /// With `v f`, `a f^2` and `j f^3` the plan from rest to rest is the same, `1 / f` as long: the path does
    /// not change.
    pub(super) fn fed(&self, limits: Limits, speed: f64) -> Limits {
        let velocity = limits.velocity.min(speed);
        Limits { velocity, ..limits }.slowed(self.feed)
    }

    /// Adapts running moves to the present feed.
    pub(super) fn follow_feed(&mut self) {
        if self.feed == 0.0 {
            return;
        }
        for index in 0..self.joints.len() {
            let Some(running) = self.runs_at_another_feed(index) else {
                continue;
            };
            let together = running.together;
            let with = |other: &usize| match together {
                Some(id) => self.joints[*other]
                    .running
                    .as_ref()
                    .is_some_and(|r| r.together == Some(id)),
                None => *other == index,
            };
            let members: Vec<usize> = (0..self.joints.len()).filter(with).collect();
            // Several joints are changed by their first one.
            if members[0] == index
                && let Some(changes) = self.changes(&members)
            {
                self.order_changes(changes);
            }
        }
    }

    /// The move of a joint, if it runs at another feed than the present one and no other request is pending.
    fn runs_at_another_feed(&self, index: usize) -> Option<&Running> {
        let joint = &self.joints[index];
        let free = joint.asked.is_none() && joint.ordered.is_empty() && joint.change.is_none();
        let running = joint.running.as_ref().filter(|_| free)?;
        let goes_on = running.settled.is_none() && !running.stopping;
        (goes_on && running.pacing.feed != self.feed).then_some(running)
    }

    /// The rest of the plans of joints at the present feed, and the tick at which it begins; `None` where the
    /// limits do not allow the change yet.
    fn changes(&self, indices: &[usize]) -> Option<(u64, Vec<(usize, Change)>)> {
        let tick = self.next_tick() + (AHEAD / self.config.period).ceil() as u64;
        if let [index] = *indices
            && self.runs_at_another_feed(index)?.turned
        {
            return Some((tick, vec![(index, self.anew(index, tick)?)]));
        }
        let goes_on = |index: &&usize| {
            let running = self.joints[**index].running.as_ref();
            running.is_some_and(|running| running.goes_on(tick))
        };
        let members = indices
            .iter()
            .filter(goes_on)
            .map(|&index| self.paced(index, tick));
        let members: Vec<_> = members.collect::<Option<_>>()?;
        let longest = members
            .iter()
            .max_by_key(|member| member.running.plan.samples())?;
        let from = longest.running.pacing.changed_at(longest.sample).from;
        let mut ramps = longest.running.pacing.base.rate_ramps(from, longest.rate);
        let found = ramps.find_map(|ramp| with_ramp(&members, ramp.duration))?;
        let changes = members.iter().zip(found).map(|(member, (ramp, rest))| {
            let before = &member.running.pacing;
            let pacing = Pacing {
                feed: self.feed,
                ramp,
                made_at: before.made_at,
                ..Pacing::new(before.base.clone(), self.feed)
            };
            let ticket = 0;
            (
                member.index,
                Change {
                    ticket,
                    pacing,
                    rest,
                },
            )
        });
        Some((tick, changes.collect()))
    }

    /// The rest of a move that began in motion, planned again for the present feed: its plan may brake with the whole
    /// limits, and at a higher rate it would exceed them.
    fn anew(&self, index: usize, tick: u64) -> Option<Change> {
        let running = self.runs_at_another_feed(index)?;
        let config = &self.joints[index].config;
        let at = Moment {
            tick,
            effort: 1.0,
            own: config.limits,
            fed: self.fed(config.limits, running.speed),
        };
        let what = What::Move {
            target: running.target(),
            shaper: None,
            speed: running.speed,
            within: false,
        };
        let planner = (&self.planner, self.config.period);
        let rest = running
            .goes_on(tick)
            .then(|| in_motion(running, what, planner, config.range, at));
        let rest = rest?.ok()?;
        let pacing = Pacing::new(rest.clone(), self.feed);
        let ticket = 0;
        Some(Change {
            ticket,
            pacing,
            rest,
        })
    }

    fn paced(&self, index: usize, tick: u64) -> Option<Member<'_>> {
        let running = self.runs_at_another_feed(index)?;
        let joint = &self.joints[index];
        Some(Member {
            index,
            sample: running.sample_before(tick),
            running,
            rate: self.feed / running.pacing.made_at,
            train: joint.axis().map_or(0.0, |axis| axis.train.duration()),
            limits: joint.config.limits,
        })
    }

    fn order_changes(&mut self, (tick, changes): (u64, Vec<(usize, Change)>)) {
        self.tickets += 1;
        let together = Together {
            id: self.tickets,
            size: changes.len(),
        };
        for (index, mut change) in changes {
            self.tickets += 1;
            change.ticket = self.tickets;
            let plan = Plan {
                joint: index,
                id: self.last_move(index),
                ticket: change.ticket,
                samples: Some(change.rest.clone()),
                start: Start::Tick(tick),
                together: (together.size > 1).then_some(together),
                permit: Some(self.enabling.permit),
            };
            self.rings.orders.push(ToTick::Plan(Box::new(plan)));
            self.joints[index].change = Some(change);
        }
    }

    /// Handles an accepted change of rate, if the plan is one.
    pub(super) fn change_taken(&mut self, taken: &Taken) -> bool {
        let joint = &mut self.joints[taken.plan.joint];
        let ticket = taken.plan.ticket;
        let Some(change) = joint.change.take_if(|change| change.ticket == ticket) else {
            return false;
        };
        // A pending request was planned for the previous motion.
        if let Some(asked) = &mut joint.asked {
            asked.again = true;
        }
        let Some(running) = &mut joint.running else {
            return true;
        };
        if let Some(turn) = joint
            .learning
            .turn
            .as_mut()
            .filter(|turn| turn.plan == running.ticket)
        {
            turn.plan = ticket;
        }
        running.go_on(&change.rest, (taken.tick, taken.first));
        running.ticket = ticket;
        running.pacing = Pacing {
            since: running.first - taken.first,
            ..change.pacing
        };
        true
    }

    /// Handles a refused change of rate, if the plan is one: it is tried again.
    pub(super) fn change_not_taken(&mut self, plan: &Plan, why: &NotTaken) -> bool {
        let joint = &mut self.joints[plan.joint];
        let change = joint.change.take_if(|change| change.ticket == plan.ticket);
        if change.is_some() {
            tracing::debug!(joint = joint.config.name, ?why, "the feed was not taken");
        }
        change.is_some()
    }
}

/// The rest of the plans of joints by ramps of a duration (s), so that all end with the one that ends last
/// at the feed.
fn with_ramp(members: &[Member<'_>], duration: f64) -> Option<Vec<(RateRamp, SampledTrajectory)>> {
    let along = |member: &Member<'_>, ramp: RateRamp| {
        let base = &member.running.pacing.base;
        Some((ramp, base.at_rate(&ramp, &[member.limits])?))
    };
    let each = members.iter().map(|member| {
        let ramp = member.running.pacing.changed_at(member.sample);
        along(
            member,
            RateRamp {
                to: member.rate,
                duration,
                ..ramp
            },
        )
    });
    let mut found: Vec<_> = each.collect::<Option<_>>()?;
    let ends = members.iter().zip(&found);
    let ends: Vec<f64> = ends
        .map(|(member, (_, rest))| rest.duration() + member.train)
        .collect();
    let last = ends.iter().copied().fold(0.0, f64::max);
    for ((member, found), end) in members.iter().zip(&mut found).zip(ends) {
        if end < last {
            let ramp = found
                .0
                .arriving(member.running.pacing.base.duration(), last - member.train);
            *found = along(member, ramp?)?;
        }
    }
    Some(found)
}
