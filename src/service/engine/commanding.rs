//! Which joints are commanded: those that stood still at the start, while their measurements arrive.

use quell_shapers::Setpoint;

use super::joint::Hearing;
use super::{Engine, controller};
use crate::service::contract::MoveEnd;
use crate::service::following::MOVED;
use crate::service::tick::ToTick;

impl Engine {
    /// Begins to command a joint that stands still at `position` (rad).
    pub(super) fn begin(&mut self, index: usize, position: f64) {
        let joint = &mut self.joints[index];
        let mode = joint.wanted_mode.take().unwrap_or(joint.mode);
        let made = controller(
            &joint.config,
            joint.standing_shaper(),
            mode,
            joint.sensor.clone(),
            position,
            self.config.period,
        );
        match made {
            Ok(controller) => {
                let start = Setpoint::at_rest(position);
                let order = ToTick::Begin(index, Box::new(controller));
                self.rings.orders.push(order);
                joint.began = true;
                (joint.report, joint.hearing) = (None, Hearing::Heard);
                (joint.position, joint.mode, joint.retunes) = (start.position, mode, 0);
                tracing::info!(joint = joint.config.name, position, "commanded from here");
            }
            Err(error) => tracing::warn!(joint = joint.config.name, "{error}"),
        }
    }

    /// The embedded arm is commanded at once: its position is known.
    pub(super) fn begin_embedded(&mut self) {
        if let Some(arm) = &self.arm {
            let position = arm.true_motor_position();
            self.begin(0, position);
        }
    }

    /// Handles a joint that has fallen silent. If moves were enabled, that is a fault, which the tick reports.
    pub(super) fn lost(&mut self, index: usize) {
        let joint = &mut self.joints[index];
        if !joint.began {
            return;
        }
        tracing::warn!(joint = joint.config.name, "no measurement");
        joint.hearing = Hearing::Lost;
    }

    /// Handles a joint whose motor side is measured again, at this position, rad.
    pub(super) fn back(&mut self, index: usize, position: f64) {
        let joint = &mut self.joints[index];
        if joint.began {
            (joint.hearing, joint.motor) = (Hearing::Back, Some(position));
        }
    }

    /// Resumes a joint that is measured again, if it stands where it was left. A joint that was moved cannot go
    /// on.
    pub(super) fn look_again(&mut self, index: usize, now: f64) {
        let joint = &mut self.joints[index];
        if joint.hearing != Hearing::Back || !joint.has_followed(now) || joint.asked.is_some() {
            return;
        }
        let motor = joint.motor.unwrap_or(joint.position);
        if (motor - joint.position).abs() > MOVED {
            tracing::warn!(joint = joint.config.name, "it was moved by something else");
            self.cease(index);
        } else {
            joint.hearing = Hearing::Heard;
            self.rings.orders.push(ToTick::Resume(index));
        }
    }

    /// Handles a joint whose command would have left its range. The tick brakes it. It is commanded again from where
    /// it stands.
    pub(super) fn left(&mut self, index: usize) {
        if let Some(running) = &mut self.joints[index].running {
            running.interrupt(MoveEnd::Fault);
        }
        self.cease(index);
    }

    /// Stops commanding a joint until it stands still.
    pub(super) fn cease(&mut self, index: usize) {
        self.finish(index);
        let joint = &mut self.joints[index];
        if let Some(axis) = joint.report.take().and_then(|report| report.axis) {
            // The next controller counts from 0.
            let counted = [
                axis.status.retunes,
                axis.status.corrections,
                axis.status.refused,
            ];
            for (before, count) in joint.before.iter_mut().zip(counted) {
                *before += u64::from(count);
            }
        }
        self.rings.orders.push(ToTick::Cease(index));
        joint.began = false;
        joint.running = None;
        joint.standstill.restart();
    }
}
