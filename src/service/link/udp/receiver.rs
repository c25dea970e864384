//! The decoder of datagrams, and its thread.

use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use rtrb::{Consumer, RingBuffer};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::UdpSettings;
use crate::service::clock::ServiceClock;
use crate::service::contract::{LinkHealth, Measured};
use crate::service::link::INBOX;
use crate::service::link::datagram::{FromRobot, LONGEST};
use crate::service::link::intake::{Counts, Intake, Received, count};
use crate::service::signature::Replay;

/// Duration of one wait, so that it notices the end.
const WAIT: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};

/// Decodes a robot's datagrams from any source.
pub struct Ear {
    settings: UdpSettings,
    intake: Intake,
    peer: Option<SocketAddr>,
    last_heard: f64,
    replay: Replay,
}

/// The tick's end of an [`Ear`].
pub struct Heard {
    ring: Consumer<Received>,
    counts: Arc<Counts>,
    peer: Option<SocketAddr>,
}

impl Heard {
    /// Takes the new measurements, oldest first; if `inbox` is full, the rest waits.
    pub fn receive(&mut self, inbox: &mut Vec<Measured>) {
        while inbox.len() < inbox.capacity() {
            match self.ring.pop() {
                Ok(Received::Measured(measured)) => inbox.push(measured),
                Ok(Received::Peer(peer)) => self.peer = Some(peer),
                Err(_) => break,
            }
        }
    }

    /// The robot's address, once it is known.
    pub fn peer(&self) -> Option<SocketAddr> {
        self.peer
    }

    /// The message counts so far.
    pub fn counters(&self) -> LinkHealth {
        LinkHealth {
            peer: self.peer,
            ..self.counts.counters()
        }
    }
}

impl Ear {
    /// A decoder for the robot of the settings, and the tick's end of it.
    pub fn new(settings: UdpSettings) -> (Self, Heard) {
        let joints = settings.joints.len();
        let (producer, ring) = RingBuffer::new(8 * INBOX * joints);
        let counts = Arc::new(Counts::default());
        let intake = Intake::new(joints, settings.watchdog, producer, Arc::clone(&counts));
        let heard = Heard {
            ring,
            counts,
            peer: settings.robot,
        };
        let ear = Self {
            peer: settings.robot,
            settings,
            intake,
            last_heard: 0.0,
            replay: Replay::default(),
        };
        (ear, heard)
    }

    /// Takes datagrams from a socket until `ending` is set.
    pub(super) fn listen(mut self, socket: &UdpSocket, clock: &ServiceClock, ending: &AtomicBool) {
        // One byte more than the longest, so that a truncated datagram is noticed.
        let mut buffer = [0; LONGEST + 1];
        while !ending.load(Relaxed) {
            let mut waiting = [PollFd::new(socket, PollFlags::IN)];
            // An interrupted wait, or an error caused by an earlier datagram, ends below.
            let _ = poll(&mut waiting, Some(&WAIT));
            while let Ok((length, from)) = socket.recv_from(&mut buffer) {
                self.hear(&buffer[..length], from, clock.now());
            }
        }
    }

    /// Processes a datagram `from` an address at `now` (s on the service's clock), and counts it.
    pub fn hear(&mut self, bytes: &[u8], from: SocketAddr, now: f64) {
        self.take(bytes, from, now);
        self.intake.counts().finished();
    }

    fn take(&mut self, bytes: &[u8], from: SocketAddr, now: f64) {
        if !self.is_from_robot(from, now) {
            count(&self.intake.counts().foreign, 1);
            return;
        }
        let key = self.settings.key.as_ref();
        if key.is_some_and(|key| !key.has_signed(bytes)) {
            count(&self.intake.counts().unsigned, 1);
            return;
        }
        let datagram = match bytes.len() {
            length if length > LONGEST => None,
            _ => FromRobot::parse(bytes),
        };
        let Some(datagram) = datagram else {
            count(&self.intake.counts().malformed, 1);
            return;
        };
        if self.settings.key.is_some() {
            match datagram.seq.map(|number| self.replay.admits(number)) {
                Some(true) => {}
                Some(false) => return count(&self.intake.counts().replayed, 1),
                None => return count(&self.intake.counts().malformed, 1),
            }
        }
        let names = &self.settings.joints;
        let Some(joint) = names.iter().position(|name| *name == datagram.joint) else {
            count(&self.intake.counts().unknown_joint, 1);
            return;
        };
        self.adopt(from, now);
        self.intake
            .take(joint, Some(datagram.t), datagram.quantities(), now);
    }

    fn is_from_robot(&self, from: SocketAddr, now: f64) -> bool {
        match self.peer {
            Some(peer) if peer == from => true,
            // A restarted robot may have another port.
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
        if self.peer != Some(from) && self.intake.adopt(from) {
            self.peer = Some(from);
        }
    }
}
