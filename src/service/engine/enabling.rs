//! Whether moves may begin: disabled after the start, enabled only by a request, faulted by the tick.
//!
//! ```text
//!            enable                fault
//! disabled ----------> enabled ----------> faulted
//!    ^  ^----disable------'                   |
//!    '-------------------reset----------------'
//! ```
//!
//! The monitors (silence, following error, sensors, missed ticks) run in the [tick](crate::service::tick),
//! which closes its [gate](crate::service::tick::gate) at once. All pending requests are then withdrawn, and
//! each joint is brought to rest.

use super::Engine;
use super::joint::Hearing;
use crate::service::contract::{
    Accepted, EnableState, EnableView, FaultKind, Quantity, ServiceError,
};
use crate::service::guard::Fault;
use crate::service::tick::ToTick;
use crate::service::tick::gate::{Cause, Trip};

/// The state in the engine.
pub struct Enabling {
    /// Its view for clients.
    pub view: EnableView,
    /// Number of the present or last permit to move.
    pub permit: u64,
}

impl Enabling {
    /// Disabled since the start of the service.
    pub fn at_start(unix_time: f64) -> Self {
        Self {
            view: EnableView {
                reason: "the service has started".into(),
                since_unix_time_s: unix_time,
                ..EnableView::default()
            },
            permit: 0,
        }
    }

    /// Whether a move may be requested.
    ///
    /// # Errors
    /// [`ServiceError::NotEnabled`] with the reason and the remedy.
    pub fn allows_moves(&self) -> Result<(), ServiceError> {
        let way = match self.view.state {
            EnableState::Enabled => return Ok(()),
            EnableState::Disabled => "enable first (POST /api/v1/enable)",
            EnableState::Faulted => {
                "see to it, then reset it (POST /api/v1/reset), then enable (POST /api/v1/enable)"
            }
        };
        let reason = self.view.reason.clone();
        Err(ServiceError::NotEnabled { reason, way })
    }

    fn turn(&mut self, state: EnableState, reason: &str, unix_time: f64) {
        self.view = EnableView {
            state,
            reason: reason.into(),
            since_unix_time_s: unix_time,
            faults: self.view.faults,
            ..EnableView::default()
        };
        tracing::info!(?state, reason, "moves");
    }
}

impl Engine {
    /// Enables moves, if every joint is commanded, measured, and at its commanded position.
    pub(super) fn enable(&mut self) -> Result<Accepted, ServiceError> {
        if self.stopping.is_some() {
            return Err(ServiceError::Stopping);
        }
        let state = self.enabling.view.state;
        if state == EnableState::Faulted {
            let reason = self.enabling.view.reason.clone();
            return Err(ServiceError::Faulted { reason });
        }
        if state == EnableState::Disabled {
            (0..self.joints.len()).try_for_each(|index| self.check_ready(index))?;
            let permit = self.enabling.permit + 1;
            let trips = self.enabling.view.faults;
            let order = ToTick::Enable { permit, trips };
            self.rings.orders.push(order);
            self.enabling.permit = permit;
            let now = self.clock.unix_time();
            let enabled = EnableState::Enabled;
            self.enabling.turn(enabled, "enabled by a request", now);
        }
        Ok(self.enabling_now())
    }

    /// Stops every joint and disables moves. A fault stays.
    pub(super) fn disable(&mut self) -> Accepted {
        if self.enabling.view.state == EnableState::Enabled {
            self.rings.orders.push(ToTick::Disable);
            self.enabling.permit += 1;
            let now = self.clock.unix_time();
            let disabled = EnableState::Disabled;
            self.enabling.turn(disabled, "disabled by a request", now);
        }
        self.stop_all(&ServiceError::Stopped);
        self.enabling_now()
    }

    /// Resets a fault, and believes the sensors again.
    pub(super) fn reset(&mut self) -> Accepted {
        match self.enabling.view.state {
            EnableState::Enabled => return self.enabling_now(),
            EnableState::Disabled => {}
            EnableState::Faulted => {
                let reason = format!("a fault was reset ({})", self.enabling.view.reason);
                let now = self.clock.unix_time();
                self.enabling.turn(EnableState::Disabled, &reason, now);
            }
        }
        self.rings.orders.push(ToTick::Forget);
        for joint in &mut self.joints {
            if let Some(report) = &mut joint.report {
                (report.guard, report.following_error) = Default::default();
            }
        }
        self.enabling_now()
    }

    /// Lets go of a joint that something has moved from its command while no move may begin: a drive that is switched
    /// on again would follow the command at once. It is commanded again from where it stands still. Where its
    /// readings have jumped, the sensor may be what has moved: somebody has to look first, and reset.
    pub(super) fn let_go_of_displaced(&mut self, index: usize, now: f64) {
        let joint = &self.joints[index];
        let off = |motor: f64| (motor - joint.position).abs() > joint.config.following_limit;
        let idle = joint.asked.is_none() && joint.ordered.is_empty();
        let sensor = joint.report.as_ref().map(|report| &report.guard);
        if self.enabling.view.state != EnableState::Enabled
            && idle
            && sensor.is_some_and(|sensor| !sensor.has_jumped(Quantity::MotorPosition))
            && joint.hearing == Hearing::Heard
            && joint.has_followed(now)
            && joint.motor.is_some_and(off)
        {
            let joint = &joint.config.name;
            tracing::warn!(joint, "it was moved while no move may begin");
            self.cease(index);
        }
    }

    fn enabling_now(&self) -> Accepted {
        let state = self.enabling.view.state;
        Accepted::EnableState { state }
    }

    fn check_ready(&self, index: usize) -> Result<(), ServiceError> {
        let joint = &self.joints[index];
        let name = || joint.config.name.clone();
        let not_ready = |reason| ServiceError::NotReady {
            joint: name(),
            reason,
        };
        let guard = joint.report.as_ref().map(|report| &report.guard);
        let fault = guard.and_then(|guard| guard.fault_of(Quantity::MotorPosition));
        let heard = joint.began && joint.hearing == Hearing::Heard;
        // A reading that is no number is one that is missing: it is told where the motor side is not heard, and any other
        // fault where it is.
        if let Some(fault) = fault.filter(|&fault| heard != (fault == Fault::NotFinite)) {
            return Err(not_ready(at_fault("its motor side", fault)));
        }
        if !joint.began {
            return Err(ServiceError::NoMeasurement { joint: name() });
        }
        if joint.hearing != Hearing::Heard {
            return Err(ServiceError::NotHeard { joint: name() });
        }
        let Some(report) = &joint.report else {
            return Err(not_ready("the tick has not said anything of it yet".into()));
        };
        if report.following_error > joint.config.following_limit {
            return Err(not_ready(following(report.following_error, joint)));
        }
        Ok(())
    }

    /// The messages that could not be read, for the reason of a silence; empty where there are none.
    fn malformed(&self) -> String {
        let count = self.whole.as_ref().map_or(0, |whole| whole.link.malformed);
        match count {
            0 => String::new(),
            count => format!("; {count} messages since the start were malformed"),
        }
    }

    /// Handles a closed gate of the tick.
    pub(super) fn tripped(&mut self, trip: Trip) {
        let joint = trip.joint.map(|index| &self.joints[index]);
        let name = joint.map_or("", |joint| &joint.config.name);
        let timeout = self.config.watchdog.as_secs_f64();
        let (fault, reason) = match trip.cause {
            Cause::Silent => {
                let reason = format!("the motor side of {name} was not heard for {timeout} s");
                (FaultKind::Silent, reason + &self.malformed())
            }
            Cause::LinkLost => {
                let reason = format!("nothing was heard of the robot for {timeout} s");
                (FaultKind::LinkLost, reason + &self.malformed())
            }
            Cause::Following(error) => {
                let reason = joint.map_or_else(String::new, |joint| following(error, joint));
                (FaultKind::FollowingError, format!("{name}: {reason}"))
            }
            Cause::Sensor(fault) => {
                let reason = at_fault(&format!("the motor side of {name}"), fault);
                (FaultKind::Sensor, reason)
            }
            Cause::Overrun(seconds) => {
                let reason = format!("nothing was sent to a robot in motion for {seconds:.2} s");
                (FaultKind::TickOverrun, reason)
            }
            Cause::Range(position) => {
                let degrees = position.to_degrees();
                let reason = format!(
                    "a command would have led {name} to {degrees:.2} deg, beyond its range"
                );
                (FaultKind::Range, reason)
            }
        };
        self.enabling.view = EnableView {
            state: EnableState::Faulted,
            reason: reason.clone(),
            fault: Some(fault),
            joint: joint.map(|joint| joint.config.name.clone()),
            since_unix_time_s: self.clock.unix_time(),
            faults: self.enabling.view.faults + 1,
        };
        self.enabling.permit += 1;
        let runs = self
            .joints
            .iter_mut()
            .filter_map(|joint| joint.running.as_mut());
        for running in runs.filter(|running| running.settled.is_none()) {
            running.fault.get_or_insert_with(|| reason.clone());
        }
        tracing::error!("fault: {reason}; stopped, and no move begins until it is reset");
        self.stop_all(&ServiceError::Faulted { reason });
        self.publish();
    }
}

fn at_fault(place: &str, fault: Fault) -> String {
    let fault = fault.name().replace('_', " ");
    format!("the sensor of {place} is at fault ({fault})")
}

fn following(error: f64, joint: &super::Joint) -> String {
    format!(
        "it is {:.2} deg from where it is commanded to be, more than {:.2} deg",
        error.to_degrees(),
        joint.config.following_limit.to_degrees()
    )
}
