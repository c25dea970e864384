//! The joint as the stream and the state tell it.

use super::JointTick;
use crate::controller::{AxisStatus, Controller};
use crate::service::contract::{TickRow, WatchdogState};
use crate::service::tick::messages::{AxisReport, JointReport};

impl JointTick {
    /// The joint at this tick, for the stream, if it is commanded or brakes. A brake is its own plan.
    pub fn row(&self, time: f64) -> Option<TickRow> {
        let controller = self.controller.as_deref();
        (controller.is_some() || self.reach.is_braking()).then_some(())?;
        let deformation = controller.and_then(|one| one.axis().status().deformation);
        let estimate = self.learned.filter(|_| controller.is_some());
        Some(TickRow {
            time,
            joint: self.index,
            planned: controller.map_or(self.sent, Controller::planned).position,
            position: self.sent.position,
            velocity: self.sent.velocity,
            acceleration: self.sent.acceleration,
            deformation: deformation.map_or(f64::NAN, |sample| sample.deformation),
            deformation_time: deformation.map_or(f64::NAN, |sample| sample.time),
            tip_deformation: deformation.map_or(f64::NAN, |sample| sample.tip_deformation),
            natural_frequency: estimate.map_or(f64::NAN, |e| e.mode.natural_frequency()),
            natural_frequency_std: estimate.map_or(f64::NAN, |e| e.natural_frequency_std),
            damping_ratio: estimate.map_or(f64::NAN, |e| e.mode.damping_ratio()),
            damping_ratio_std: estimate.map_or(f64::NAN, |e| e.damping_ratio_std),
            converged: estimate.is_some_and(|e| e.converged),
            move_id: self.move_id,
        })
    }

    /// Report of the joint for the state.
    pub fn report(&self, now: f64) -> JointReport {
        let axis = |controller: &Controller| AxisReport {
            status: AxisStatus {
                estimate: self.learned,
                ..*controller.axis().status()
            },
            train: controller.axis().train(),
            planned: controller.planned(),
            sent: self.sent,
            settled: controller.is_settled(),
            frozen: self.frozen,
        };
        JointReport {
            joint: self.index,
            axis: self.controller.as_deref().map(axis),
            watchdog: match self.hearing.is_silent(now) {
                true => WatchdogState::Silent,
                false => WatchdogState::Fine,
            },
            guard: *self.guard.report(),
            following_error: self.following.error(),
        }
    }
}
