//! The thread that takes datagrams apart.

use std::net::{SocketAddr, UdpSocket};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::UdpSettings;
use crate::service::clock::ServiceClock;
use crate::service::link::Replay;
use crate::service::link::datagram::{FromRobot, LONGEST};
use crate::service::link::intake::{Intake, count};

/// How long it waits at a time, so that it sees that it shall end.
const WAIT: Timespec = Timespec {
    tv_sec: 0,
    tv_nsec: 50_000_000,
};

pub(super) struct Receiver {
    socket: UdpSocket,
    settings: UdpSettings,
    intake: Intake,
    clock: ServiceClock,
    peer: Option<SocketAddr>,
    last_heard: f64,
    replay: Replay,
}

impl Receiver {
    pub fn new(
        socket: UdpSocket,
        settings: UdpSettings,
        intake: Intake,
        clock: ServiceClock,
    ) -> Self {
        Self {
            socket,
            peer: settings.robot,
            settings,
            intake,
            clock,
            last_heard: 0.0,
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
                self.intake.counts().finished();
            }
        }
    }

    fn take(&mut self, bytes: &[u8], from: SocketAddr) {
        let now = self.clock.now();
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
            .take(joint, datagram.t, datagram.quantities(), now);
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
        if self.peer != Some(from) && self.intake.adopt(from) {
            self.peer = Some(from);
        }
    }
}
