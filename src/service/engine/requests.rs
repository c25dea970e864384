//! The requests of clients.

use quell_shapers::Shaper;

use super::Engine;
use super::jog::HELD;
use super::joint::What;
use super::shaping::shaper_named;
use super::together::Form;
use crate::service::contract::{Accepted, Envelope, Request, ServiceError, Target};
use crate::tolerance::Tolerance;

/// Joints and targets in rad, and the rule for this move alone.
type CheckedTogether =
    Result<(Vec<(usize, f64)>, Option<Option<&'static dyn Shaper>>), ServiceError>;

impl Engine {
    /// Answers a request, at once or after the tick's answer.
    pub(super) fn answer(&mut self, envelope: Envelope) {
        let Envelope {
            request,
            number,
            reply,
        } = envelope;
        if request.moves() && reply.is_closed() {
            // Nobody waits for it any more.
            return;
        }
        // First the present reports of the tick are handled.
        self.hear_all();
        let answer = match request {
            // A stuck tick gets no further orders.
            request if self.rings.orders.is_behind() && !request.is_heard_always() => {
                let what = "the tick takes no orders";
                Err(ServiceError::Overloaded { what })
            }
            // A stop has priority over waiting requests, and cancels earlier moves.
            Request::Move { .. } if self.last_stop.is_some_and(|stop| number < stop) => {
                Err(ServiceError::Stopped)
            }
            Request::Move {
                joint,
                target,
                shaper,
            } => match self.check_move(&joint, target, shaper.as_deref()) {
                Ok((index, what)) => {
                    self.end_hold(index);
                    return self.ask(index, what, Some(reply));
                }
                Err(error) => Err(error),
            },
            Request::MoveWithin { .. } if self.last_stop.is_some_and(|stop| number < stop) => {
                Err(ServiceError::Stopped)
            }
            Request::MoveWithin {
                joint,
                target,
                tolerance,
            } => {
                let target = Target { joint, target };
                match self.check_within(&[target], tolerance) {
                    Ok(members) => {
                        return self.ask_within(members, tolerance, Form::Alone, reply);
                    }
                    Err(error) => Err(error),
                }
            }
            Request::MoveTogether { .. } if self.last_stop.is_some_and(|stop| number < stop) => {
                Err(ServiceError::Stopped)
            }
            Request::MoveTogether {
                targets,
                tolerance: Some(tolerance),
                ..
            } => match self.check_within(&targets, tolerance) {
                Ok(members) => return self.ask_within(members, tolerance, Form::Together, reply),
                Err(error) => Err(error),
            },
            Request::MoveTogether {
                targets, shaper, ..
            } => match self.check_together(&targets, shaper.as_deref()) {
                Ok((members, shaper)) => return self.ask_together(members, shaper, reply),
                Err(error) => Err(error),
            },
            Request::Stop => {
                self.last_stop = self.last_stop.max(Some(number));
                let joints = self.stop_all(&ServiceError::Stopped);
                let durations = joints.iter().filter_map(|joint| joint.duration_s);
                Ok(Accepted::Stop {
                    duration_s: durations.fold(0.0, f64::max),
                    joints,
                })
            }
            Request::Jog { .. } if self.last_stop.is_some_and(|stop| number < stop) => {
                Err(ServiceError::Stopped)
            }
            Request::Jog {
                joint,
                velocity,
                hold,
            } => match self.jog(&joint, velocity, hold) {
                Ok(Some((index, what))) => return self.ask(index, what, Some(reply)),
                Ok(None) => Ok(Accepted::Jog { held_s: HELD }),
                Err(error) => Err(error),
            },
            Request::Feed { share } => self.change_feed(share),
            Request::Enable if self.last_stop.is_some_and(|stop| number < stop) => {
                Err(ServiceError::Stopped)
            }
            Request::Enable => self.enable(),
            Request::Disable => {
                self.last_stop = self.last_stop.max(Some(number));
                Ok(self.disable())
            }
            Request::Reset => Ok(self.reset()),
            Request::Forget { joint } => self.forget(&joint),
            Request::Shaping(change) => self.change_shaping(&change),
            Request::Payload { mass } => self.change_payload(mass),
        };
        if answer.is_ok() {
            // A client that has its answer finds in the state what it asked for.
            self.publish();
        }
        // The client may have disconnected.
        let _ = reply.send(answer);
    }

    pub(super) fn check_move(
        &self,
        joint: &str,
        target: f64,
        shaper: Option<&str>,
    ) -> Result<(usize, What), ServiceError> {
        if self.stopping.is_some() {
            return Err(ServiceError::Stopping);
        }
        let index = self.index_of(joint)?;
        let joint = &self.joints[index];
        let [low, high] = joint.config.range;
        if !(low..=high).contains(&target) {
            return Err(ServiceError::Value {
                what: "the target in deg",
                value: target.to_degrees(),
                rule: "within the joint's range",
            });
        }
        self.enabling.allows_moves()?;
        joint.takes_moves()?;
        self.check_recording()?;
        let shaper = shaper.map(shaper_named).transpose()?;
        if let Some(shaper) = shaper
            && !joint.is_at_rest()
            && joint
                .running
                .as_ref()
                .is_some_and(|running| running.start.shaper != super::joint::name_of(shaper))
        {
            let joint = joint.config.name.clone();
            return Err(ServiceError::ShaperInMotion { joint });
        }
        let speed = f64::INFINITY;
        Ok((
            index,
            What::Move {
                target,
                shaper,
                speed,
                within: false,
            },
        ))
    }

    /// The joints of a move within a tolerance. For millimetres each tip's distance from its axis must be
    /// known.
    fn check_within(
        &self,
        targets: &[Target],
        tolerance: Tolerance,
    ) -> Result<Vec<(usize, f64)>, ServiceError> {
        let (members, _) = self.check_together(targets, None)?;
        for &(index, _) in &members {
            self.check_free(index)?;
            let joint = &self.joints[index];
            if tolerance.deviation.is_some() && joint.sensor.arc().is_none() {
                let name = &joint.config.name;
                let reason = format!("where the tip of {name} is, is not known: give no deviation");
                return Err(ServiceError::Plan { reason });
            }
        }
        Ok(members)
    }

    /// The joints of a move of several, and its own rule, if it has one.
    fn check_together(&self, targets: &[Target], shaper: Option<&str>) -> CheckedTogether {
        let mut members = Vec::new();
        for Target { joint, target } in targets {
            let (index, _) = self.check_move(joint, *target, shaper)?;
            if members.iter().any(|&(other, _)| other == index) {
                let joint = joint.clone();
                return Err(ServiceError::Twice { joint });
            }
            members.push((index, *target));
        }
        match members.is_empty() {
            true => Err(ServiceError::NoJoints),
            false => Ok((members, shaper.map(shaper_named).transpose()?)),
        }
    }

    pub(super) fn index_of(&self, name: &str) -> Result<usize, ServiceError> {
        let names = self.joints.iter().map(|joint| joint.config.name.as_str());
        let found = names.clone().position(|known| known == name);
        found.ok_or_else(|| ServiceError::unknown_joint(name, names))
    }
}
