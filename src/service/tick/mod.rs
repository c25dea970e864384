//! The tick: a thread of its own that measures, controls and commands, and never waits for anyone.
//!
//! No allocation, lock, file or log from the first tick on. What allocates is made by the engine,
//! comes over a ring, and goes back over another to be dropped.
//!
//! **A tick that is missed is left out and counted; it is not made up for.** The command then goes on
//! where it stopped: from one setpoint sent to the next it advances by exactly one control period, so
//! that the limits hold between any two setpoints that the robot receives. Ticks made up for in a
//! burst would arrive together, and the last of them would be a jump.

mod joint;
mod lateness;
mod messages;
pub mod real_time;
mod thread;

pub use joint::JointTick;
pub use lateness::Histogram;
pub use messages::{
    AxisReport, Event, JointReport, NotTaken, Plan, Record, Start, Taken, ToTick, Train,
    TrainOrder, WholeReport,
};
pub use thread::{TickThread, TickThreadSettings};

use rtrb::{Consumer, Producer, RingBuffer};

use super::contract::{Measured, TickStatistics};
use super::link::{INBOX, RobotLink};

/// Orders and events that may wait; a joint has at most a few of either.
const ORDERS: usize = 64;
/// Seconds of records that may wait for the engine.
const RECORDED: f64 = 2.0;
/// Records a tick and joint that the ring of records is made for: a row, and three sensors.
const RECORDS: f64 = 4.0;
/// Rounds of reports that may wait.
const ROUNDS: usize = 8;

/// What the engine holds of the tick.
pub struct EngineRings {
    /// Orders to the tick.
    pub orders: Producer<ToTick>,
    /// What happened.
    pub events: Consumer<Event>,
    /// What was commanded and measured.
    pub records: Consumer<Record>,
    /// The joints, now and then.
    pub joints: Consumer<JointReport>,
    /// Tick and link, after the joints of the same round.
    pub whole: Consumer<WholeReport>,
}

struct TickRings {
    orders: Consumer<ToTick>,
    events: Producer<Event>,
    records: Producer<Record>,
    joints: Producer<JointReport>,
    whole: Producer<WholeReport>,
}

/// Everything that a tick does, without its clock.
pub struct Tick {
    joints: Vec<JointTick>,
    link: Box<dyn RobotLink>,
    inbox: Vec<Measured>,
    rings: TickRings,
    period: f64,
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
        let records = RECORDED / period * RECORDS * joints.len() as f64;
        let (orders, tick_orders) = RingBuffer::new(ORDERS);
        let (tick_events, events) = RingBuffer::new(2 * ORDERS);
        let (tick_records, records) = RingBuffer::new(records as usize);
        let (tick_reports, reports) = RingBuffer::new(ROUNDS * joints.len());
        let (tick_whole, whole) = RingBuffer::new(ROUNDS);
        let tick = Self {
            joints,
            link,
            inbox: Vec::with_capacity(INBOX),
            rings: TickRings {
                orders: tick_orders,
                events: tick_events,
                records: tick_records,
                joints: tick_reports,
                whole: tick_whole,
            },
            period,
            count: 0,
            records_lost: 0,
        };
        let engine = EngineRings {
            orders,
            events,
            records,
            joints: reports,
            whole,
        };
        (tick, engine)
    }

    /// Control period, s.
    pub fn period(&self) -> f64 {
        self.period
    }

    /// One tick at `now` (s on the service's clock).
    pub fn run(&mut self, now: f64) {
        self.take_orders(now);
        self.measure(now);
        for index in 0..self.joints.len() {
            self.command(index, now);
        }
        self.link.flush();
        self.count += 1;
    }

    /// Publishes the state; where nobody has taken the last ones there is no room, and no loss.
    pub fn report(&mut self, now: f64, mut statistics: TickStatistics) {
        statistics.ticks = self.count;
        statistics.records_lost = self.records_lost;
        if self.rings.joints.slots() < self.joints.len() || self.rings.whole.is_full() {
            return;
        }
        for joint in &self.joints {
            // There is room: it was looked at above.
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
        while let Ok(order) = self.rings.orders.pop() {
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
            ToTick::Train(order) => Some(self.joints.get_mut(order.joint)?.take_train(order)),
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

    fn command(&mut self, index: usize, now: f64) {
        let (tick, period) = (self.count, self.period);
        if let Some(event) = self.joints[index].take_plan(tick, now) {
            self.tell(event);
        }
        let joint = &mut self.joints[index];
        if let Some(setpoint) = joint.step(now, period) {
            self.link.send(now, index, &setpoint);
        }
        if let Some(row) = self.joints[index].row(now) {
            self.record(Record::Tick(row));
        }
        if let Some(event) = self.joints[index].take_settled(now) {
            self.tell(event);
        }
    }

    fn record(&mut self, record: Record) {
        if self.rings.records.push(record).is_err() {
            self.records_lost += 1;
        }
    }

    /// Tells the engine. Where it has not listened for so long that there is no room it is gone, and
    /// what the event carries is dropped here.
    fn tell(&mut self, event: Event) {
        let _ = self.rings.events.push(event);
    }
}
