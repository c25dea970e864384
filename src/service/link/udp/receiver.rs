//! The thread that takes datagrams apart.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed, Ordering::Release};

use rtrb::Producer;
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::{Counts, Received, UdpSettings};
use crate::service::clock::ServiceClock;
use crate::service::contract::{Measured, Quantity};
use crate::service::link::datagram::{FromRobot, LONGEST};
use crate::service::link::{ClockOffset, Order, Replay, Sequence};

/// How long it waits at a time, so that it sees that it shall end.
const WAIT: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};
/// Quantities that a joint may be measured in.
const QUANTITIES: usize = 5;

pub(super) struct Receiver {
    socket: UdpSocket,
    settings: UdpSettings,
    ring: Producer<Received>,
    counts: Arc<Counts>,
    clock: ServiceClock,
    peer: Option<SocketAddr>,
    last_heard: f64,
    /// One for each joint and quantity.
    sequences: Vec<[Sequence; QUANTITIES]>,
    offset: ClockOffset,
    replay: Replay,
}

impl Receiver {
    pub fn new(
        socket: UdpSocket,
        settings: UdpSettings,
        ring: Producer<Received>,
        counts: Arc<Counts>,
        clock: ServiceClock,
    ) -> Self {
        Self {
            socket,
            peer: settings.robot,
            sequences: vec![Default::default(); settings.joints.len()],
            settings,
            ring,
            counts,
            clock,
            last_heard: 0.0,
            offset: ClockOffset::default(),
            replay: Replay::default(),
        }
    }

    /// Takes datagrams until `ending` is set.
    pub fn run(mut self, ending: &AtomicBool) {
        // One byte more than the longest, so that one that was cut is seen.
        let mut buffer = [0; LONGEST + 1];
        while !ending.load(Relaxed) {
            let mut waiting = [PollFd::new(&self.socket, PollFlags::IN)];
            // An interrupted wait, or an error that a datagram sent earlier caused, ends below.
            let _ = poll(&mut waiting, Some(&WAIT));
            while let Ok((length, from)) = self.socket.recv_from(&mut buffer) {
                self.take(&buffer[..length], from);
                // Last, so that whoever sees it counted sees what became of it, too.
                self.counts.received.fetch_add(1, Release);
            }
        }
    }

    fn take(&mut self, bytes: &[u8], from: SocketAddr) {
        let now = self.clock.now();
        if !self.is_from_robot(from, now) {
            count(&self.counts.foreign, 1);
            return;
        }
        let key = self.settings.key.as_ref();
        if key.is_some_and(|key| !key.has_signed(bytes)) {
            count(&self.counts.unsigned, 1);
            return;
        }
        let datagram = match bytes.len() {
            length if length > LONGEST => None,
            _ => FromRobot::parse(bytes),
        };
        let Some(datagram) = datagram else {
            count(&self.counts.malformed, 1);
            return;
        };
        if self.settings.key.is_some() {
            match datagram.seq.map(|number| self.replay.admits(number)) {
                Some(true) => {}
                Some(false) => return count(&self.counts.replayed, 1),
                None => return count(&self.counts.malformed, 1),
            }
        }
        let names = &self.settings.joints;
        let Some(joint) = names.iter().position(|name| *name == datagram.joint) else {
            count(&self.counts.unknown_joint, 1);
            return;
        };
        self.adopt(from, now);
        self.sort(joint, &datagram, now);
    }

    fn is_from_robot(&self, from: SocketAddr, now: f64) -> bool {
        match self.peer {
            Some(peer) if peer == from => true,
            // A robot that was started anew may have another port.
            Some(_) => self.may_adopt(from) && now - self.last_heard > self.silence(),
            None => self.may_adopt(from),
        }
    }

    fn may_adopt(&self, from: SocketAddr) -> bool {
        self.settings.robot.is_none() && from.ip().is_loopback()
    }

    fn silence(&self) -> f64 {
        self.settings.watchdog.as_secs_f64()
    }

    fn adopt(&mut self, from: SocketAddr, now: f64) {
        self.last_heard = now;
        if self.peer != Some(from) && self.ring.push(Received::Peer(from)).is_ok() {
            self.peer = Some(from);
        }
    }

    /// Counts what is in order and what is not, and hands on what is.
    fn sort(&mut self, joint: usize, datagram: &FromRobot<'_>, now: f64) {
        let (mut lost, mut doubled, mut older) = (0, false, false);
        for (quantity, value) in datagram.quantities() {
            match self.sequences[joint][index(quantity)].take(datagram.t) {
                Order::Next { missing } => lost = lost.max(missing),
                Order::Restarted => self.offset.restart(),
                Order::Doubled => {
                    doubled = true;
                    continue;
                }
                Order::Older => {
                    older = true;
                    continue;
                }
            }
            let measured = Received::Measured(Measured {
                received: now,
                stamp: datagram.t,
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
        if !older {
            self.compare_clocks(datagram.t, now);
        }
    }

    fn compare_clocks(&mut self, stamp: f64, now: f64) {
        self.offset.take(stamp, now);
        if let Some(offset) = self.offset.offset() {
            self.counts.clock_offset.store(offset.to_bits(), Relaxed);
            let delay = now - stamp + offset;
            count(&self.counts.late, u64::from(delay > self.silence()));
        }
    }
}

fn count(counter: &AtomicU64, by: u64) {
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
