//! The requests of clients.

use quell_shapers::{Mode, Shaper, UncertainMode, shaper_by_name};

use super::Engine;
use super::axis::{longest_train, train};
use super::jog::HELD;
use super::joint::What;
use super::together::Form;
use crate::service::contract::{Accepted, Envelope, Request, ServiceError, ShapingChange, Target};
use crate::service::shapers;
use crate::service::tick::ToTick;
use crate::tolerance::Tolerance;

/// Largest payload of the embedded arm, kg: twice that of its class, 60 kg.
const HEAVIEST: f64 = 120.0;
/// Largest payload of another robot, kg: more than the gantries of shipyards lift.
const HEAVIEST_OF_ANY: f64 = 1e7;

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
                Err(ServiceError::Busy)
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

    fn change_shaping(&mut self, change: &ShapingChange) -> Result<Accepted, ServiceError> {
        if self.stopping.is_some() {
            return Err(ServiceError::Stopping);
        }
        if *change
            == (ShapingChange {
                joint: change.joint.clone(),
                ..Default::default()
            })
        {
            return Err(ServiceError::Nothing);
        }
        let chosen = match &change.joint {
            Some(name) => {
                let index = self.index_of(name)?;
                index..index + 1
            }
            None => 0..self.joints.len(),
        };
        let mode = change.mode.map(Mode::try_from).transpose();
        let mode = mode.map_err(|error| ServiceError::Train {
            reason: error.to_string(),
        })?;
        let kind = change.kind.as_deref().map(shaper_named).transpose()?;
        for index in chosen.clone() {
            self.check_train(index, kind.flatten(), mode)?;
        }
        for index in chosen {
            self.apply(index, change, kind, mode);
        }
        Ok(Accepted::Changed)
    }

    /// Checks that the train after a change can be designed and run.
    fn check_train(
        &self,
        index: usize,
        kind: Option<&'static dyn Shaper>,
        mode: Option<Mode>,
    ) -> Result<(), ServiceError> {
        let joint = &self.joints[index];
        let known = mode.map_or_else(|| joint.known(), UncertainMode::believed);
        let shaper = kind.unwrap_or(joint.shaper);
        let designed = train(Some(shaper), &known, self.config.period);
        let designed = designed.map_err(|error| ServiceError::Train {
            reason: error.to_string(),
        })?;
        let longest = longest_train(&joint.config);
        if designed.duration() > longest {
            return Err(ServiceError::Value {
                what: "the length of the train in s",
                value: designed.duration(),
                rule: "at most four periods of the mode in the configuration",
            });
        }
        Ok(())
    }

    fn apply(
        &mut self,
        index: usize,
        change: &ShapingChange,
        kind: Option<Option<&'static dyn Shaper>>,
        mode: Option<Mode>,
    ) {
        let joint = &mut self.joints[index];
        match kind {
            Some(Some(shaper)) => joint.shaper = shaper,
            Some(None) => joint.shaping = false,
            None => {}
        }
        joint.shaping = change.enabled.unwrap_or(joint.shaping);
        joint.wanted_mode = mode.or(joint.wanted_mode);
        joint.learning.solved = None;
        joint.train_due |= kind.is_some() || change.enabled.is_some() || mode.is_some();
        if let Some(adaptation) = change.adaptation {
            joint.adaptation = adaptation;
            self.rings.orders.push(ToTick::Adaptive(index, adaptation));
        }
        self.order_train(index);
    }

    fn change_payload(&mut self, mass: f64) -> Result<Accepted, ServiceError> {
        let (most, rule) = match self.arm {
            Some(_) => (HEAVIEST, "from 0 to 120"),
            None => (HEAVIEST_OF_ANY, "from 0 to 10000000"),
        };
        if !(0.0..=most).contains(&mass) {
            return Err(ServiceError::Value {
                what: "the payload in kg",
                value: mass,
                rule,
            });
        }
        if let Some(arm) = &self.arm {
            let load = arm.load(mass).map_err(|error| ServiceError::Train {
                reason: error.to_string(),
            })?;
            self.rings.orders.push(ToTick::Carry(load));
        }
        self.payload = Some(mass);
        self.recall(mass);
        tracing::info!(mass, "payload");
        Ok(Accepted::Changed)
    }

    /// Uses a mode that was learned with this payload before, which is better than that of another payload.
    fn recall(&mut self, payload: f64) {
        for index in 0..self.joints.len() {
            let joint = &mut self.joints[index];
            let learned = self.state.joints.get(&joint.config.name);
            let learned = learned.and_then(|state| state.with_payload(payload));
            if let Some(mode) = learned.and_then(|learned| Mode::try_from(learned.mode).ok())
                && joint.adaptation
            {
                joint.wanted_mode = Some(mode);
                joint.learning.solved = None;
                joint.mode_since = self.clock.unix_time();
                joint.train_due = true;
                self.order_train(index);
            }
        }
    }
}

/// The rule of that name; none for `none`.
fn shaper_named(name: &str) -> Result<Option<&'static dyn Shaper>, ServiceError> {
    if name == "none" {
        return Ok(None);
    }
    let shaper = name.to_owned();
    match shaper_by_name(name) {
        Some(found) if found.is_convex() => Ok(Some(found)),
        Some(_) => Err(ServiceError::NegativeShaper { shaper }),
        None => Err(ServiceError::UnknownShaper {
            shaper,
            known: format!("{}, none", shapers::names().join(", ")),
        }),
    }
}
