//! One joint at the tick: its orders, its measurements, its commands.

mod plans;
mod reports;
mod sensors;
mod steps;
mod trains;

use quell_shapers::Setpoint;
use quell_trajectories::Limits;

use self::steps::Steps;
use super::following::Following;
use super::hearing::{Hearing, Watchdog};
use super::messages::{Event, Plan, RetuneOrder};
use super::pace::Stride;
use super::reach::Reach;
use crate::controller::Controller;
use crate::estimators::Estimate;
use crate::service::between::within_limits;
use crate::service::guard::{Bounds, CommandedMotion, Guard};
use crate::service::link::INBOX;
use crate::signal::Measurement;

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
    steps: Steps,
    motion: CommandedMotion,
    adaptive: bool,
    /// Whether the frame of the tip's sensor is known; until then the sensor is ignored.
    registered: bool,
    frozen: bool,
    /// Whether only noise is measured.
    quiet: bool,
    hearing: Hearing,
    following: Following,
    reach: Reach,
    /// Where a command would have led that the reach has refused, rad, until it is told.
    left: Option<f64>,
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
            steps: Steps::default(),
            motion: CommandedMotion::default(),
            adaptive,
            registered,
            frozen: false,
            quiet: false,
            hearing: Hearing::new(watchdog),
            following: Following::new(f64::INFINITY, f64::INFINITY),
            reach: Reach::new([f64::NEG_INFINITY, f64::INFINITY], bounds.limits, 0.0),
            left: None,
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

    /// The joint with a range (rad) of its commands, which come every `period` (s). Without it they are not checked.
    pub fn ranging_within(mut self, range: [f64; 2], period: f64) -> Self {
        self.reach = Reach::new(range, self.limits, period);
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
        self.reach.restart(self.sent.position);
        self.steps = Steps::default();
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

    /// Whether it is commanded, measured, and stands where it was left.
    pub fn is_ready(&self) -> bool {
        self.controller.is_some() && self.hearing.is_heard()
    }

    /// Limits of the joint.
    pub fn limits(&self) -> Limits {
        self.limits
    }

    /// Whether the command does not stand still.
    pub fn is_moving(&self) -> bool {
        let moving = self.controller.as_ref().is_some_and(|c| !c.is_settled());
        moving || self.reach.is_braking()
    }

    /// Number of the move that runs or ran last.
    pub fn move_id(&self) -> u64 {
        self.move_id
    }

    /// Advances the command by one control period.
    pub fn step(&mut self) {
        let wanted = match self.controller.as_deref_mut() {
            Some(controller) => {
                let next = controller.tick(&[]);
                if !self.quiet {
                    self.learned = controller.axis().status().estimate;
                }
                next
            }
            None if self.reach.is_braking() => self.command[1],
            None => return,
        };
        let (next, refused) = self.reach.take(wanted);
        self.left = self.left.or(refused);
        self.command = [self.command[1], next];
    }

    /// The setpoint after a stride, if the joint is commanded or brakes.
    pub fn setpoint(&mut self, stride: &Stride, period: f64, time: f64) -> Option<Setpoint> {
        (self.controller.is_some() || self.reach.is_braking()).then_some(())?;
        let at = within_limits(self.command, 1.0 - stride.behind, period);
        let setpoint = Setpoint {
            position: at.position,
            velocity: at.velocity * stride.rate,
            acceleration: at.acceleration * stride.rate.powi(2) + at.velocity * stride.slope,
        };
        self.motion = CommandedMotion {
            velocity: setpoint.velocity,
            jerk: (setpoint.acceleration - self.sent.acceleration) / period,
            step: self.motion.step,
        };
        self.sent = setpoint;
        self.following.command(time, setpoint.position);
        Some(setpoint)
    }

    /// The setpoint of a tick at `now` (s) was sent to the robot.
    pub fn was_sent(&mut self, now: f64) {
        self.motion.step = self.steps.take(now, self.sent.position);
    }

    /// Tells, once, where a command beyond its range would have led, rad.
    pub fn take_left(&mut self) -> Option<f64> {
        self.left.take()
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
}
