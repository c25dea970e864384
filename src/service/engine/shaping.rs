//! Changes of shaping, adaptation and payload.

use quell_shapers::{Mode, Shaper, UncertainMode, shaper_by_name};

use super::Engine;
use super::axis::{longest_train, train};
use crate::service::contract::{Accepted, ServiceError, ShapingChange};
use crate::service::shapers;
use crate::service::tick::ToTick;

/// Largest payload of the embedded arm, kg: twice that of its class, 60 kg.
const HEAVIEST: f64 = 120.0;
/// Largest payload of another robot, kg: more than the gantries of shipyards lift.
const HEAVIEST_OF_ANY: f64 = 1e7;

impl Engine {
    pub(super) fn change_shaping(
        &mut self,
        change: &ShapingChange,
    ) -> Result<Accepted, ServiceError> {
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

    pub(super) fn change_payload(&mut self, mass: f64) -> Result<Accepted, ServiceError> {
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
pub(super) fn shaper_named(name: &str) -> Result<Option<&'static dyn Shaper>, ServiceError> {
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
