//! Assembly of the state for clients.

use std::sync::Arc;

use quell_shapers::Setpoint;

use super::Engine;
use super::joint::{Joint, name_of};
use crate::adaptation::{Decision, Reason};
use crate::service::contract::{EstimateView, JointSnapshot, SensorView, Snapshot, TrainView};
use crate::service::guard::Fault;
use crate::service::tick::{AxisReport, WholeReport};

impl Engine {
    /// Publishes the state.
    pub(super) fn publish(&self) {
        let Some(whole) = &self.whole else { return };
        let snapshot = Snapshot {
            version: env!("CARGO_PKG_VERSION"),
            robot: self.config.robot.name(),
            unix_time_s: self.clock.unix_time(),
            time_s: whole.time,
            stopping: self.stopping.is_some(),
            enable: self.enabling.view.clone(),
            feed_percent: 100.0 * self.feed,
            payload_kg: self.payload,
            joints: self
                .joints
                .iter()
                .map(|joint| self.view(joint, whole))
                .collect(),
            tick: whole.statistics,
            link: whole.link,
            disk: self.disk.view(),
            moves: self.moves.iter().cloned().collect(),
        };
        self.ends.snapshot.send_replace(Arc::new(snapshot));
    }

    fn view(&self, joint: &Joint, whole: &WholeReport) -> JointSnapshot {
        let axis = joint.axis();
        let standing = [Setpoint::at_rest(joint.position); 2];
        let [planned, sent] = joint.commanded.unwrap_or(standing);
        let running = joint.running.as_ref();
        let limits = joint.config.limits;
        let status = axis.map(|axis| &axis.status);
        let deformation = status.and_then(|status| status.deformation);
        let true_mode = match (&self.arm, self.payload) {
            (Some(arm), Some(payload)) => arm.load(payload).ok().and_then(|load| load.mode()),
            _ => None,
        };
        JointSnapshot {
            name: joint.config.name.clone(),
            phase: joint.phase(),
            move_id: running.map_or_else(|| self.moves.back().map_or(0, |m| m.id), |r| r.start.id),
            target_rad: joint.position,
            planned_rad: planned.position,
            command_rad: sent.position,
            command_rad_s: sent.velocity,
            motor_rad: joint.motor,
            following_error_rad: axis
                .and(joint.report.as_ref())
                .map(|report| report.following_error),
            following_limit_rad: joint.config.following_limit,
            deformation_rad: deformation.map(|sample| sample.deformation),
            tip_deformation_m: deformation
                .map(|sample| sample.tip_deformation)
                .filter(|tip| tip.is_finite()),
            range_rad: joint.config.range,
            limits: [limits.velocity, limits.acceleration, limits.jerk],
            limits_assumed: joint.config.limits_assumed,
            range_assumed: joint.config.range_assumed,
            awaits_registration: joint
                .registrar
                .as_ref()
                .is_some_and(|registrar| registrar.sees_the_tip()),
            shaping: joint.shaping,
            adaptation: joint.adaptation,
            adaptation_frozen: joint.is_unheard() || axis.is_some_and(|axis| axis.frozen),
            shaper: name_of(Some(joint.shaper)),
            mode: Some(joint.mode.into()),
            mode_since_s: joint.mode_since,
            train: axis.map(train_view).unwrap_or_default(),
            estimate: axis.and_then(|axis| estimate_view(axis, whole)),
            true_mode: true_mode.map(Into::into),
            retunes: joint.before[0] + status.map_or(0, |status| u64::from(status.retunes)),
            corrections: joint.before[1] + status.map_or(0, |s| u64::from(s.corrections)),
            corrections_refused: joint.before[2] + status.map_or(0, |s| u64::from(s.refused)),
            watchdog: joint.watchdog(),
            sensors: sensors(joint, whole.time),
            learning: joint.learning.view.clone(),
            map: Arc::clone(&joint.learning.map),
        }
    }
}

fn train_view(axis: &AxisReport) -> TrainView {
    let impulses = axis.train.impulses();
    TrainView {
        times_s: impulses.iter().map(|impulse| impulse.time).collect(),
        amplitudes: impulses.iter().map(|impulse| impulse.amplitude).collect(),
    }
}

fn estimate_view(axis: &AxisReport, whole: &WholeReport) -> Option<EstimateView> {
    let estimate = axis.status.estimate?;
    let hertz = |omega: f64| omega / core::f64::consts::TAU;
    let (accepted, refused) = match axis.status.decision {
        Some(Decision::Accept(_)) => (true, None),
        Some(Decision::Keep(reason)) => (false, Some(words(reason))),
        None => (false, None),
    };
    Some(EstimateView {
        time_s: estimate.time - whole.link.clock_offset_s.unwrap_or(0.0),
        frequency_hz: estimate.mode.hertz(),
        frequency_std_hz: hertz(estimate.natural_frequency_std),
        damping_ratio: estimate.mode.damping_ratio(),
        damping_ratio_std: estimate.damping_ratio_std,
        converged: estimate.converged,
        accepted,
        refused,
    })
}

fn words(reason: Reason) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    match reason {
        Reason::NotConverged => "it has not settled".into(),
        Reason::Implausible(mode) => format!(
            "{:.2} Hz and {:.3} are not plausible",
            mode.hertz(),
            mode.damping_ratio()
        ),
        Reason::Uncertain(left) => format!("too uncertain: it could leave {}", percent(left)),
        Reason::DeadBand(_) => "close to the mode in force: no change".into(),
        Reason::NotSignificant(left) => {
            format!("not significant: its error explains {}", percent(left))
        }
        Reason::Held(hold) => format!("the train is solved for {}", hold.reason()),
        Reason::Unexplained(left) => format!(
            "one mode that stays leaves {} of the vibration unexplained",
            percent(left)
        ),
        Reason::Unconfirmed(step) => {
            format!("a jump of {}, which has to persist first", percent(step))
        }
    }
}

fn sensors(joint: &Joint, now: f64) -> Vec<SensorView> {
    let Some(report) = &joint.report else {
        return Vec::new();
    };
    let view = |(quantity, sensor): (crate::service::contract::Quantity, _)| {
        let sensor: &crate::service::guard::SensorReport = sensor;
        let counted = Fault::ALL.iter().zip(sensor.refused);
        let refused = counted.filter(|(_, count)| *count > 0);
        SensorView {
            name: quantity.name(),
            samples: sensor.samples,
            rate_hz: sensor.rate,
            age_s: now - sensor.heard,
            refused: refused
                .map(|(fault, count)| (fault.name(), count))
                .collect(),
            fault: sensor.told_fault(now).map(Fault::name),
        }
    };
    report.guard.sensors().map(view).collect()
}
