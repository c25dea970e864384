//! Moves by hand: a joint moves while somebody holds it moving, and at most at the speed that feed and limits allow.
//!
//! A hold is one press of a button. Its client says so again and again; once it has not for [`HELD`] the joint is
//! stopped as by a stop, jerk-limited. A hold that has ended, for whatever reason, moves nothing any more: who
//! pressed before a stop has to let go and press again.

use super::Engine;
use super::hold::Jog;
use super::joint::{Reply, What};
use super::orders::answer;
use crate::service::contract::{Accepted, ServiceError};

/// Time after which a hold that is not renewed is over, s: of renewals ten times a second one may be late by more
/// than its time, as on a wireless network. At the end the joint stops.
pub const HELD: f64 = 0.25;

impl Engine {
    /// Begins or renews a hold; at no velocity it ends.
    pub(super) fn jog(&mut self, joint: &str, velocity: f64, hold: u64, reply: Reply) {
        match self.held(joint, velocity, hold) {
            Ok(Some((index, what))) => self.ask(index, what, Some(reply)),
            Ok(None) => answer(Some(reply), Ok(Accepted::Jog { held_s: HELD })),
            Err(error) => answer(Some(reply), Err(error)),
        }
    }

    /// What is to be asked for, where the hold is not only renewed.
    fn held(
        &mut self,
        name: &str,
        velocity: f64,
        hold: u64,
    ) -> Result<Option<(usize, What)>, ServiceError> {
        let index = self.index_of(name)?;
        let joint = &self.joints[index];
        let most = joint.config.limits.velocity;
        if !(-most..=most).contains(&velocity) {
            return Err(ServiceError::Value {
                what: "the velocity in rad/s",
                value: velocity,
                rule: "within the joint's limit",
            });
        }
        let name = joint.config.name.clone();
        let last = joint.jog;
        let own = last.filter(|jog| jog.hold == hold);
        if velocity == 0.0 {
            if own.is_some_and(|jog| jog.holds()) {
                self.stop(index, ServiceError::Stopped);
            } else if !last.is_some_and(|jog| jog.holds()) {
                // Let go before its first word was here, which may come still.
                self.joints[index].jog = Some(Jog {
                    hold,
                    velocity,
                    until: f64::NEG_INFINITY,
                    over: true,
                });
            }
            return Ok(None);
        }
        if last.is_some_and(|jog| jog.hold != hold && jog.holds()) {
            return Err(ServiceError::Held { joint: name });
        }
        let idle = joint.is_at_rest() && joint.asked.is_none() && joint.ordered.is_empty();
        if own.is_some_and(|jog| !jog.holds() || idle) {
            return Err(ServiceError::HoldOver { joint: name });
        }
        let end = joint.config.range[usize::from(velocity > 0.0)];
        let (index, what) = self.check_move(&name, end, None)?;
        let until = self.clock.now() + HELD;
        let jog = Jog {
            hold,
            velocity,
            until,
            over: false,
        };
        self.joints[index].jog = Some(jog);
        if own.is_some_and(|jog| jog.velocity == velocity) {
            return Ok(None);
        }
        let What::Move { target, shaper, .. } = what else {
            return Ok(None);
        };
        let speed = velocity.abs();
        let what = What::Move {
            target,
            shaper,
            speed,
            within: false,
        };
        Ok(Some((index, what)))
    }

    /// Something else is asked of a joint.
    pub(super) fn end_hold(&mut self, index: usize) {
        if let Some(jog) = &mut self.joints[index].jog {
            jog.end();
        }
    }

    /// Stops what is not held any more at `now` (s).
    pub(super) fn end_holds(&mut self, now: f64) {
        for index in 0..self.joints.len() {
            let late = |jog: Jog| jog.holds() && now > jog.until;
            if self.joints[index].jog.is_some_and(late) {
                self.stop(index, ServiceError::Stopped);
            }
        }
    }
}
