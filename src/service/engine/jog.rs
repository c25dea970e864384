//! Jogging: a joint moves while a client holds it moving, at most at the speed that feed and limits allow.
//!
//! A hold is one press of a button. The client renews it repeatedly. If it has not for [`HELD`], the joint is
//! stopped as by a stop, jerk-limited. A hold that has ended for any reason stays ended: after a stop the user
//! must release the button and press again.

use super::Engine;
use super::hold::Jog;
use super::joint::What;
use crate::service::contract::ServiceError;

/// Time after which a hold that is not renewed ends, s. With ten renewals a second one may be late by more than
/// its period, as on a wireless network. At the end the joint stops.
pub const HELD: f64 = 0.25;

impl Engine {
    /// Begins or renews a hold; velocity 0 ends it. Returns the motion to request, if the hold is not only renewed.
    pub(super) fn jog(
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
                what: "the velocity in deg/s",
                value: velocity.to_degrees(),
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
                // Released before its first message arrived, which may still come.
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
        self.check_room(index, velocity.signum(), end)?;
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

    /// Checks that a joint at rest has room in a direction. In motion it may have passed the end only on a way back.
    fn check_room(&self, index: usize, direction: f64, end: f64) -> Result<(), ServiceError> {
        let joint = &self.joints[index];
        let position = match &joint.running {
            Some(running) if !joint.is_at_rest() => running.state_before(self.next_tick()).position,
            _ => joint.position,
        };
        match (end - position) * direction > 0.0 {
            true => Ok(()),
            false => Err(ServiceError::NoRoom {
                joint: joint.config.name.clone(),
                position,
                end,
            }),
        }
    }

    /// Ends a hold because of another request for the joint.
    pub(super) fn end_hold(&mut self, index: usize) {
        if let Some(jog) = &mut self.joints[index].jog {
            jog.end();
        }
    }

    /// Stops joints whose hold has run out at `now` (s).
    pub(super) fn end_holds(&mut self, now: f64) {
        for index in 0..self.joints.len() {
            let late = |jog: Jog| jog.holds() && now > jog.until;
            if self.joints[index].jog.is_some_and(late) {
                self.stop(index, ServiceError::Stopped);
            }
        }
    }
}
