//! One joint at the tick: its orders, its measurements, its commands.

use quell_shapers::{Refusal, RetuneOutcome, Setpoint};
use quell_trajectories::Limits;

use super::following::Following;
use super::gate::{Admission, Cause, Gate};
use super::hearing::{Change, Hearing, Watchdog};
use super::messages::{
    AxisReport, Event, JointReport, NotTaken, Plan, RetuneOrder, Start, Taken, Together, TrainOrder,
};
use super::pace::Stride;
use super::taking::{adopt, put_in_force, ready};
use crate::controller::{AxisStatus, Controller, ringing_time};
use crate::estimators::{Estimate, Sample};
use crate::service::between::within_limits;
use crate::service::contract::{Measured, Quantity, TickRow, WatchdogState};
use crate::service::following::FOLLOWED;
use crate::service::guard::{Bounds, CommandedMotion, Guard};
use crate::service::link::INBOX;
use crate::signal::{DeformationSensor, Measurement};

/// A joint at the tick. It has a controller of its own, so that joints begin and end independently.
pub struct JointTick {
    index: usize,
    controller: Option<Box<Controller>>,
    guard: Guard,
    limits: Limits,
    inbox: Vec<Measurement>,
    waiting: Option<Box<Plan>>,
    /// Whether the waiting plan may begin without those of other joints.
    released: bool,
    /// The order to retune that waits for its tick.
    retuning: Option<Box<RetuneOrder>>,
    /// The command at the last two control periods.
    command: [Setpoint; 2],
    sent: Setpoint,
    motion: CommandedMotion,
    adaptive: bool,
    /// Whether the frame of the tip's sensor is known; until then the sensor is ignored.
    registered: bool,
    frozen: bool,
    /// Whether only noise is measured.
    quiet: bool,
    hearing: Hearing,
    following: Following,
    move_id: u64,
    /// Number of the plan that runs or ran last.
    ticket: u64,
    runs: bool,
    /// Time since which the command stands still, s; `None` before the first move.
    settled: Option<f64>,
    /// The last estimate while there was motion.
    learned: Option<Estimate>,
}

impl JointTick {
    /// A joint that is not commanded yet. `registered` tells whether the frame of the tip's sensor is known.
    pub fn new(
        index: usize,
        bounds: Bounds,
        watchdog: Watchdog,
        adaptive: bool,
        registered: bool,
    ) -> Self {
        Self {
            index,
            controller: None,
            guard: Guard::new(bounds),
            limits: bounds.limits,
            inbox: Vec::with_capacity(INBOX),
            waiting: None,
            released: false,
            retuning: None,
            command: [Setpoint::default(); 2],
            sent: Setpoint::default(),
            motion: CommandedMotion::default(),
            adaptive,
            registered,
            frozen: false,
            quiet: false,
            hearing: Hearing::new(watchdog),
            following: Following::new(f64::INFINITY, f64::INFINITY),
            move_id: 0,
            ticket: 0,
            runs: false,
            settled: Some(f64::NEG_INFINITY),
            learned: None,
        }
    }

    /// The joint with a limit (rad) of its following error, for commands every `period` (s). Without it the
    /// error is not checked.
    pub fn following_within(mut self, limit: f64, period: f64) -> Self {
        self.following = Following::new(limit, period);
        self
    }

    /// Commands the joint from `now` (s) on; returns the controller before.
    pub fn begin(&mut self, controller: Box<Controller>, now: f64) -> Option<Box<Controller>> {
        self.hearing.begin(now);
        self.settled = Some(f64::NEG_INFINITY);
        self.sent = controller.planned();
        self.command = [self.sent; 2];
        self.runs = false;
        self.guard.restart();
        self.following.restart();
        self.controller.replace(controller)
    }

    /// Stops commanding the joint.
    pub fn cease(&mut self) -> Option<Box<Controller>> {
        self.controller.take()
    }

    /// Sets whether the train follows the estimate.
    pub fn set_adaptive(&mut self, adaptive: bool) {
        self.adaptive = adaptive;
    }

    /// Installs a registered sensor; returns the one before.
    pub fn take_sensor(&mut self, mut sensor: Box<DeformationSensor>) -> Option<Event> {
        self.registered = true;
        if let Some(controller) = self.controller.as_deref_mut() {
            // Plain numbers: a copy does not allocate.
            *sensor = controller.replace_sensor((*sensor).clone());
        }
        // The next controller uses it; it must not be dropped here.
        Some(Event::Sensor(sensor))
    }

    /// Takes a plan that waits for its time; returns one that it replaces.
    pub fn expect(&mut self, plan: Box<Plan>) -> Option<Event> {
        self.released = plan.together.is_none();
        let replaced = self.waiting.replace(plan)?;
        Some(Event::NotTaken(replaced, NotTaken::Replaced))
    }

    /// Takes a train, once the joint rests.
    pub fn take_train(&mut self, order: Box<TrainOrder>) -> Event {
        let taken = match self.controller.as_deref_mut() {
            Some(controller) => put_in_force(&order.train, controller),
            None => Err(NotTaken::Idle),
        };
        Event::Train(order, taken)
    }

    /// Lends a copy of the filter for a retune of the running plan; `tick` is the next one. An order that has
    /// its copy waits for its tick.
    pub fn retune(&mut self, mut order: Box<RetuneOrder>, tick: u64) -> Option<Event> {
        if order.lent.is_some() {
            let replaced = self.retuning.replace(order)?;
            return Some(Event::Retuned(
                replaced,
                RetuneOutcome::Refused(Refusal::Busy),
            ));
        }
        let follows = self.follows(&order);
        let controller = self.controller.as_deref_mut().filter(|controller| {
            follows && controller.axis().status().retunes == order.train.retunes
        });
        (order.lent, order.tick) = (controller.and_then(Controller::lend), tick);
        Some(Event::Lent(order))
    }

    /// Whether the plan of a retune order is running, with a train that may change.
    fn follows(&self, order: &RetuneOrder) -> bool {
        self.adaptive && !self.frozen && self.runs && self.ticket == order.ticket
    }

    /// Retunes once the command has reached the end of the order's copy of the filter.
    pub fn take_retune(&mut self) -> Option<Event> {
        let controller = self.controller.as_deref_mut()?;
        let due = |order: &mut Box<RetuneOrder>| {
            let lent = order.lent.as_deref();
            lent.is_none_or(|lent| controller.due_in(lent) <= 0)
        };
        let mut order = self.retuning.take_if(due)?;
        let follows = self.follows(&order);
        let controller = self.controller.as_deref_mut()?;
        let outcome = match follows {
            true => adopt(&mut order, controller),
            false => {
                controller.give_back(&mut order.lent);
                RetuneOutcome::Refused(Refusal::Busy)
            }
        };
        Some(Event::Retuned(order, outcome))
    }

    /// Takes a measurement; marks it if it is refused.
    pub fn measure(&mut self, measured: &mut Measured) {
        measured.refused = !self.guard.admits(measured, self.motion);
        self.hearing.take(measured);
        if measured.quantity == Quantity::MotorPosition && !measured.refused {
            self.following.take(measured);
        }
        let measurement = match measurement(measured) {
            Some(measurement) if !measured.refused => measurement,
            _ => return,
        };
        if measured.quantity == Quantity::TipPosition && !self.registered {
            return;
        }
        if self.inbox.len() < self.inbox.capacity() {
            self.inbox.push(measurement);
        }
    }

    /// Returns a plan that waits for its time, if it has this number.
    pub fn withdraw(&mut self, ticket: u64) -> Option<Event> {
        let plan = self.waiting.take_if(|plan| plan.ticket == ticket)?;
        Some(Event::NotTaken(plan, NotTaken::Withdrawn))
    }

    /// Checks for a change of the joint's reception; reports it once.
    pub fn look(&mut self, now: f64) -> Option<Event> {
        self.controller.as_ref()?;
        Some(match self.hearing.look(now)? {
            Change::Lost => Event::Lost(self.index),
            Change::Back(position) => Event::Back(self.index, position),
        })
    }

    /// Notes that it stands where it was left before the silence.
    pub fn resume(&mut self) {
        self.hearing.resume();
    }

    /// The fault that forbids moves, except silence, which [`look`](Self::look) reports.
    pub fn fault(&self) -> Option<Cause> {
        self.controller.as_ref()?;
        let sensor = self.guard.report().fault_of(Quantity::MotorPosition);
        let following = || self.following.excess().map(Cause::Following);
        sensor.map(Cause::Sensor).or_else(following)
    }

    /// Discards the readings of its sensors.
    pub fn forget(&mut self) {
        self.guard.restart();
        self.following.forgive();
    }

    /// Whether it is commanded, measured, and stands where it was left.
    pub fn is_ready(&self) -> bool {
        self.controller.is_some() && self.hearing.is_heard()
    }

    /// Time since the last measurement, s, and its largest allowed value.
    pub fn silence(&self, now: f64) -> [f64; 2] {
        [self.hearing.silence(now), self.hearing.timeout()]
    }

    /// The plans with which the waiting one is to begin, while it waits for them.
    pub fn together(&self) -> Option<Together> {
        let waits = self.waiting.as_ref().filter(|_| !self.released);
        waits.and_then(|plan| plan.together)
    }

    /// Whether the waiting plan is one of these, and could begin with this tick.
    pub fn is_ready_with(&mut self, together: Together, tick: u64, gate: &Gate) -> bool {
        let waits = self.waiting.as_ref();
        let Some(plan) = waits.filter(|plan| plan.together == Some(together)) else {
            return false;
        };
        let admitted = gate.admits(plan.permit) == Admission::Begins;
        let Some(controller) = self.controller.as_deref_mut().filter(|_| admitted) else {
            return false;
        };
        // A correction under way may refuse a plan in motion when it is loaded, which would be too late for the
        // others.
        let corrects = matches!(plan.start, Start::Tick(_)) && controller.is_correcting();
        !corrects && ready(plan, controller, tick) == Ok(true)
    }

    /// Lets the waiting plan begin, if it is one of these.
    pub fn release(&mut self, together: Together) {
        self.released |= self.together() == Some(together);
    }

    /// Begins the waiting plan, if its time has come and the gate is open for it.
    pub fn take_plan(&mut self, tick: u64, time: f64, gate: &Gate) -> Option<Event> {
        let mut plan = self.waiting.take()?;
        let Some(controller) = self.controller.as_deref_mut() else {
            return Some(Event::NotTaken(plan, NotTaken::Idle));
        };
        match gate.admits(plan.permit) {
            Admission::Begins => {}
            Admission::Waits => {
                self.waiting = Some(plan);
                return None;
            }
            Admission::Refused => return Some(Event::NotTaken(plan, NotTaken::NotEnabled)),
        }
        match ready(&plan, controller, tick) {
            Ok(true) if self.released => {}
            Ok(_) => {
                self.waiting = Some(plan);
                return None;
            }
            Err(why) => return Some(Event::NotTaken(plan, why)),
        }
        let samples = plan.samples.take()?;
        let moving = controller.is_moving();
        match controller.load(samples) {
            Ok(old) => plan.samples = old,
            Err((samples, error)) => {
                plan.samples = Some(samples);
                return Some(Event::NotTaken(plan, NotTaken::Refused(error)));
            }
        }
        (self.move_id, self.ticket) = (plan.id, plan.ticket);
        (self.runs, self.settled) = (true, None);
        Some(Event::Taken(Taken {
            plan,
            tick,
            first: usize::from(moving),
            time,
        }))
    }

    /// Limits of the joint.
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// Whether the command does not stand still.
    pub fn is_moving(&self) -> bool {
        self.controller.as_ref().is_some_and(|c| !c.is_settled())
    }

    /// Hands the new measurements to the controller.
    pub fn listen(&mut self, now: f64) {
        let silent = self.hearing.is_silent(now);
        let Some(controller) = self.controller.as_deref_mut() else {
            return;
        };
        let frozen = silent || self.guard.report().is_at_fault();
        if frozen && !self.frozen {
            // Earlier samples belong to a fault, or to another stretch of time.
            controller.restart_estimation();
        }
        self.frozen = frozen;
        self.quiet = is_quiet(controller, self.settled, now);
        controller.set_adaptive(self.adaptive && !frozen && !self.quiet);
        controller.observe(&self.inbox);
        self.inbox.clear();
    }

    /// The samples of its deformation since they were last handed on.
    pub fn heard(&self) -> &[Sample] {
        let controller = self.controller.as_deref();
        controller.map_or(&[], |controller| controller.axis().heard())
    }

    /// Clears the samples after they were handed on.
    pub fn clear_heard(&mut self) {
        if let Some(controller) = self.controller.as_deref_mut() {
            controller.clear_samples();
        }
    }

    /// Number of the move that runs or ran last.
    pub fn move_id(&self) -> u64 {
        self.move_id
    }

    /// Advances the command by one control period.
    pub fn step(&mut self) {
        let Some(controller) = self.controller.as_deref_mut() else {
            return;
        };
        let next = controller.tick(&[]);
        if !self.quiet {
            self.learned = controller.axis().status().estimate;
        }
        self.command = [self.command[1], next];
    }

    /// Whether the joint is not where it was left before the silence. Nothing is sent to it then: a setpoint
    /// would be a jump.
    pub fn is_displaced(&self, now: f64) -> bool {
        let rests = self.settled.is_some_and(|since| now - since > FOLLOWED);
        rests && self.hearing.is_displaced(self.sent.position)
    }

    /// The setpoint after a stride, if the joint is commanded.
    pub fn setpoint(&mut self, stride: &Stride, period: f64, time: f64) -> Option<Setpoint> {
        self.controller.as_ref()?;
        let at = within_limits(self.command, 1.0 - stride.behind, period);
        let setpoint = Setpoint {
            position: at.position,
            velocity: at.velocity * stride.rate,
            acceleration: at.acceleration * stride.rate.powi(2) + at.velocity * stride.slope,
        };
        self.motion = CommandedMotion {
            velocity: setpoint.velocity,
            jerk: (setpoint.acceleration - self.sent.acceleration) / period,
        };
        self.sent = setpoint;
        self.following.command(time, setpoint.position);
        Some(setpoint)
    }

    /// Reports, once, that the command stands still after a plan.
    pub fn take_settled(&mut self, time: f64) -> Option<Event> {
        let settled = self.controller.as_ref().is_some_and(|c| c.is_settled());
        if !(self.runs && settled) {
            return None;
        }
        (self.runs, self.settled) = (false, Some(time));
        Some(Event::Settled(self.index, self.move_id, time))
    }

    /// The joint at this tick, for the stream.
    pub fn row(&self, time: f64) -> Option<TickRow> {
        let controller = self.controller.as_deref()?;
        let status = controller.axis().status();
        let deformation = status.deformation;
        let estimate = self.learned;
        Some(TickRow {
            time,
            joint: self.index,
            planned: controller.planned().position,
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

/// Whether nothing moves or vibrates any more, so that only noise is measured.
fn is_quiet(controller: &Controller, settled: Option<f64>, now: f64) -> bool {
    let Some(settled) = settled else {
        return false;
    };
    let mode = controller.axis().status().shaped_for.mode;
    // An undamped mode is assumed to vibrate for as long as the estimator's window, forty periods.
    let rings = ringing_time(mode).min(40.0 * mode.damped_period());
    now - settled > rings
}

/// The measurement for the controller, which does not use accelerations.
fn measurement(measured: &Measured) -> Option<Measurement> {
    let (time, value) = (measured.stamp, measured.value);
    Some(match measured.quantity {
        Quantity::MotorPosition => Measurement::MotorPosition {
            time,
            position: value[0],
        },
        Quantity::LinkPosition => Measurement::LinkPosition {
            time,
            position: value[0],
        },
        Quantity::Deformation => Measurement::Deformation {
            time,
            deformation: value[0],
        },
        Quantity::TipPosition => Measurement::TipPosition {
            time,
            position: value,
        },
        Quantity::TipAcceleration => return None,
    })
}
