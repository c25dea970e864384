//! Intake of a robot's measurements: sorted by their stamps, counted, and handed to the tick.

use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Acquire, Ordering::Relaxed, Ordering::Release};
use std::time::Duration;

use rtrb::Producer;

use super::sensor_clock::{SensorClock, Set};
use super::{Order, Sequence};
use crate::service::contract::{LinkHealth, Measured, Quantity};

/// Number of quantities of a joint.
const QUANTITIES: usize = 5;

/// The items that a receiving thread hands to the tick.
pub(super) enum Received {
    /// A measurement.
    Measured(Measured),
    /// The robot's address.
    Peer(SocketAddr),
}

/// The counters of a receiving thread; the names as in [`LinkHealth`].
#[derive(Debug)]
pub(super) struct Counts {
    received: AtomicU64,
    lost: AtomicU64,
    late: AtomicU64,
    doubled: AtomicU64,
    reordered: AtomicU64,
    pub foreign: AtomicU64,
    pub malformed: AtomicU64,
    pub unknown_joint: AtomicU64,
    pub unsigned: AtomicU64,
    pub replayed: AtomicU64,
    overflowed: AtomicU64,
    /// The clock's offset as bits of a floating-point number; NaN before it is known.
    clock_offset: AtomicU64,
}

impl Default for Counts {
    fn default() -> Self {
        let zero = AtomicU64::default;
        Self {
            received: zero(),
            lost: zero(),
            late: zero(),
            doubled: zero(),
            reordered: zero(),
            foreign: zero(),
            malformed: zero(),
            unknown_joint: zero(),
            unsigned: zero(),
            replayed: zero(),
            overflowed: zero(),
            clock_offset: AtomicU64::new(f64::NAN.to_bits()),
        }
    }
}

impl Counts {
    /// Counts a message as received. This is last, so that a reader that sees it counted also sees its outcome.
    pub fn finished(&self) {
        self.received.fetch_add(1, Release);
    }

    /// The counts so far; the link itself counts what it sent.
    pub fn counters(&self) -> LinkHealth {
        // First: the outcome of these messages has been counted already.
        let received = self.received.load(Acquire);
        let count = |counter: &AtomicU64| counter.load(Relaxed);
        let offset = f64::from_bits(count(&self.clock_offset));
        LinkHealth {
            received,
            lost: count(&self.lost),
            late: count(&self.late),
            doubled: count(&self.doubled),
            reordered: count(&self.reordered),
            foreign: count(&self.foreign),
            malformed: count(&self.malformed),
            unknown_joint: count(&self.unknown_joint),
            unsigned: count(&self.unsigned),
            replayed: count(&self.replayed),
            overflowed: count(&self.overflowed),
            clock_offset_s: (!offset.is_nan()).then_some(offset),
            ..LinkHealth::default()
        }
    }
}

/// The receiver's end of the ring to the tick.
pub(super) struct Intake {
    ring: Producer<Received>,
    counts: Arc<Counts>,
    /// Delay from which on a measurement counts as late, s.
    late: f64,
    /// Stamps and clock of each joint and quantity.
    sensors: Vec<[(Sequence, SensorClock); QUANTITIES]>,
    /// How a clock was last set.
    set: Option<Set>,
}

impl Intake {
    /// For a number of joints; a delay above `watchdog` counts as late.
    pub fn new(
        joints: usize,
        watchdog: Duration,
        ring: Producer<Received>,
        counts: Arc<Counts>,
    ) -> Self {
        Self {
            ring,
            counts,
            late: watchdog.as_secs_f64(),
            sensors: vec![Default::default(); joints],
            set: None,
        }
    }

    /// The counters.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Passes the robot's address to the tick; returns whether there was room.
    pub fn adopt(&mut self, peer: SocketAddr) -> bool {
        self.ring.push(Received::Peer(peer)).is_ok()
    }

    /// Takes the measurements of a joint with one stamp (s on the robot's clock): counts those in and out of
    /// order, and hands on the former, with stamps as by the clock that the sensor had first. `now` is on the service's
    /// clock, s.
    ///
    /// Without a stamp it counts as measured now. Losses cannot be detected then, since a burst was not
    /// measured as one.
    pub fn take(
        &mut self,
        joint: usize,
        stamp: Option<f64>,
        quantities: impl Iterator<Item = (Quantity, [f64; 3])>,
        now: f64,
    ) {
        let Some(sensors) = self.sensors.get_mut(joint) else {
            return;
        };
        let (stamp, stamped) = (stamp.unwrap_or(now), stamp.is_some());
        let (mut lost, mut doubled, mut older, mut late) = (0, false, false, false);
        for (quantity, value) in quantities {
            let (sequence, clock) = &mut sensors[index(quantity)];
            match sequence.take(stamp) {
                Order::Next { lost: more } if stamped => lost = lost.max(more),
                Order::Next { .. } => {}
                Order::Restarted => {
                    clock.doubt(stamp, now);
                    clock.believe(&mut self.set, now, self.late);
                }
                Order::Doubled => {
                    doubled = true;
                    continue;
                }
                Order::Older => {
                    older = true;
                    continue;
                }
                Order::Doubted => {
                    clock.doubt(stamp, now);
                    older = true;
                    continue;
                }
            }
            late |= clock.take(stamp, now) > self.late;
            if let (Quantity::MotorPosition, Some(offset)) = (quantity, clock.offset()) {
                self.counts.clock_offset.store(offset.to_bits(), Relaxed);
            }
            let measured = Received::Measured(Measured {
                received: now,
                stamp: clock.as_before(stamp),
                joint,
                quantity,
                value,
                refused: false,
            });
            if self.ring.push(measured).is_err() {
                count(&self.counts.overflowed, 1);
            }
        }
        count(&self.counts.lost, lost);
        count(&self.counts.doubled, u64::from(doubled));
        count(&self.counts.reordered, u64::from(older));
        count(&self.counts.late, u64::from(late));
    }
}

/// Increases a counter.
pub(super) fn count(counter: &AtomicU64, by: u64) {
    counter.fetch_add(by, Relaxed);
}

fn index(quantity: Quantity) -> usize {
    match quantity {
        Quantity::MotorPosition => 0,
        Quantity::LinkPosition => 1,
        Quantity::Deformation => 2,
        Quantity::TipPosition => 3,
        Quantity::TipAcceleration => 4,
    }
}
