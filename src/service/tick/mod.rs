//! The tick: a thread of its own that measures, controls and commands, and never blocks.
//!
//! No allocation, lock, file or log from the first tick on. The engine allocates, passes objects over a ring,
//! and gets them back over another ring to drop them.
//!
//! A missed tick is counted, and nothing is sent for it. [`pace`] describes how the command handles the missed
//! time: the limits hold for the real time between any two setpoints.

mod following;
pub mod gate;
mod hearing;
mod joint;
mod lateness;
mod messages;
mod monitors;
mod orders;
pub mod pace;
mod pulse;
mod reach;
pub mod real_time;
mod rings;
mod taking;
mod thread;

pub use following::Following;
pub use hearing::Watchdog;
pub use joint::JointTick;
pub use lateness::Histogram;
pub use messages::{
    AxisReport, Event, JointReport, NotTaken, Plan, Record, RetuneOrder, Start, Taken, ToTick,
    Together, Train, TrainOrder, WholeReport,
};
pub use orders::Orders;
pub use pulse::Pulse;
pub use rings::EngineRings;
pub use thread::{TickThread, TickThreadSettings};

use gate::Gate;
use pace::{Pace, Stride};
use rings::{TickRings, rings};

use super::contract::{Measured, TickStatistics};
use super::link::{INBOX, RobotLink};

/// The work of a tick, without its clock.
pub struct Tick {
    joints: Vec<JointTick>,
    link: Box<dyn RobotLink>,
    inbox: Vec<Measured>,
    rings: TickRings,
    pace: Pace,
    gate: Gate,
    period: f64,
    /// Ticks run.
    ticks: u64,
    /// Number of control periods of the command; the starts of plans refer to it.
    count: u64,
    records_lost: u64,
}

impl Tick {
    /// A tick of `period` (s) over joints and a link, and the engine's ends of its rings.
    pub fn new(
        joints: Vec<JointTick>,
        link: Box<dyn RobotLink>,
        period: f64,
    ) -> (Self, EngineRings) {
        let (rings, engine) = rings(joints.len(), period);
        let limits = joints.iter().map(JointTick::limits);
        let tick = Self {
            pace: Pace::new(limits, period, link.carries_time()),
            gate: Gate::default(),
            inbox: Vec::with_capacity(INBOX * joints.len()),
            joints,
            link,
            rings,
            period,
            ticks: 0,
            count: 0,
            records_lost: 0,
        };
        (tick, engine)
    }

    /// Control period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// Runs the tick that was due at `now` (s on the service's clock), after a number of `missed` ones.
    pub fn run(&mut self, now: f64, missed: u64) {
        self.take_orders(now);
        self.measure(now);
        let moves = self.joints.iter().any(JointTick::is_moving);
        self.watch(missed, moves);
        let stride = self.pace.stride(missed, moves);
        for index in 0..self.joints.len() {
            self.look(index, now);
        }
        self.tell_trip();
        self.release();
        for index in 0..self.joints.len() {
            self.joints[index].listen(now);
            self.hand_on(index);
            self.advance(index, now, &stride);
            self.command(index, now, &stride);
        }
        self.link.flush();
        self.count += stride.periods;
        self.ticks += 1;
    }

    /// Publishes the state; if the last reports were not taken, there is no room, and nothing is lost.
    pub fn report(&mut self, now: f64, mut statistics: TickStatistics) {
        statistics.ticks = self.ticks;
        statistics.records_lost = self.records_lost;
        if self.rings.joints.slots() < self.joints.len() || self.rings.whole.is_full() {
            return;
        }
        for joint in &self.joints {
            // There is room: it was checked above.
            let _ = self.rings.joints.push(joint.report(now));
        }
        let _ = self.rings.whole.push(WholeReport {
            tick: self.count,
            time: now,
            statistics,
            link: self.link.counters(),
        });
    }

    fn take_orders(&mut self, now: f64) {
        self.gate.hold(!self.rings.orders.is_whole());
        while let Some(order) = self.rings.orders.pop() {
            if let Some(event) = self.obey(order, now) {
                self.tell(event);
            }
        }
    }

    fn obey(&mut self, order: ToTick, now: f64) -> Option<Event> {
        match order {
            ToTick::Begin(joint, controller) => {
                let before = self.joints.get_mut(joint)?.begin(controller, now);
                before.map(Event::Controller)
            }
            ToTick::Cease(joint) => {
                let before = self.joints.get_mut(joint)?.cease();
                before.map(Event::Controller)
            }
            ToTick::Plan(plan) => self.joints.get_mut(plan.joint)?.expect(plan),
            ToTick::Withdraw(joint, ticket) => self.joints.get_mut(joint)?.withdraw(ticket),
            ToTick::Resume(joint) => {
                self.joints.get_mut(joint)?.resume();
                None
            }
            ToTick::Enable { permit, trips } => {
                let opened = self.gate.open(permit, trips);
                // A fault that the engine does not know yet closes it again.
                let unready = self.joints.iter().position(|joint| !joint.is_ready());
                if let Some(joint) = unready.filter(|_| opened) {
                    self.gate.trip(self.silent(joint, now));
                }
                None
            }
            ToTick::Disable => {
                self.gate.close();
                None
            }
            ToTick::Forget => {
                self.joints.iter_mut().for_each(JointTick::forget);
                None
            }
            ToTick::Train(order) => Some(self.joints.get_mut(order.joint)?.take_train(order)),
            ToTick::Retune(order) => {
                let tick = self.count;
                self.joints.get_mut(order.joint)?.retune(order, tick)
            }
            ToTick::Adaptive(joint, adaptive) => {
                self.joints.get_mut(joint)?.set_adaptive(adaptive);
                None
            }
            ToTick::Sensor(joint, sensor) => self.joints.get_mut(joint)?.take_sensor(sensor),
            ToTick::Carry(load) => {
                self.link.carry(load);
                None
            }
        }
    }

    fn measure(&mut self, now: f64) {
        self.inbox.clear();
        self.link.receive(now, &mut self.inbox);
        for index in 0..self.inbox.len() {
            let mut measured = self.inbox[index];
            if let Some(joint) = self.joints.get_mut(measured.joint) {
                joint.measure(&mut measured);
                self.record(Record::Measured(measured));
            }
        }
    }

    /// Lets the plans of several joints begin with this tick, if each of them can.
    fn release(&mut self) {
        for index in 0..self.joints.len() {
            let Some(together) = self.joints[index].together() else {
                continue;
            };
            let (tick, gate) = (self.count, &self.gate);
            let mut ready = 0;
            for joint in &mut self.joints {
                ready += usize::from(joint.is_ready_with(together, tick, gate));
            }
            if ready == together.size {
                let members = self.joints.iter_mut();
                members.for_each(|joint| joint.release(together));
            }
        }
    }

    /// Advances a joint's command by the periods of a stride.
    fn advance(&mut self, index: usize, now: f64, stride: &Stride) {
        for period in 1..=stride.periods {
            let left = stride.periods - period;
            let time = now - left as f64 * self.period;
            let tick = self.count + period - 1;
            if let Some(event) = self.joints[index].take_plan(tick, time, &self.gate) {
                self.tell(event);
            }
            if let Some(event) = self.joints[index].take_retune() {
                self.tell(event);
            }
            self.joints[index].step();
            self.tell_left(index);
            if left > 0 && stride.behind == 0.0 {
                // Position of the command at a missed tick.
                let _ = self.joints[index].setpoint(stride, self.period, time);
                self.record_row(index, time, tick + 1);
            }
            // In a slow start the setpoint is still on its way to the command.
            if stride.behind == 0.0
                && let Some(event) = self.joints[index].take_settled(time)
            {
                self.tell(event);
            }
        }
    }

    fn command(&mut self, index: usize, now: f64, stride: &Stride) {
        let displaced = self.joints[index].is_displaced(now);
        if let Some(setpoint) = self.joints[index].setpoint(stride, self.period, now)
            && !displaced
        {
            self.link.send(now, index, &setpoint);
            self.joints[index].was_sent(now);
        }
        self.record_row(index, now, self.count + stride.periods);
    }

    /// Hands the samples of a joint on for learning.
    fn hand_on(&mut self, index: usize) {
        for k in 0..self.joints[index].heard().len() {
            let joint = &self.joints[index];
            let heard = Record::Heard(index, joint.move_id(), joint.heard()[k]);
            self.record(heard);
        }
        self.joints[index].clear_heard();
    }

    fn record_row(&mut self, index: usize, time: f64, next: u64) {
        if let Some(row) = self.joints[index].row(time) {
            self.record(Record::Tick(row, next));
        }
    }

    fn record(&mut self, record: Record) {
        if self.rings.records.push(record).is_err() {
            self.records_lost += 1;
        }
    }

    /// Sends an event to the engine. If there is no room after so long, the engine has ended, and the content
    /// is dropped here.
    fn tell(&mut self, event: Event) {
        let _ = self.rings.events.push(event);
    }
}
