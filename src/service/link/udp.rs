//! UDP: a thread decodes datagrams, the tick takes their values from a ring and sends by itself.

mod receiver;

use std::io;
use std::net::{SocketAddr, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

use quell_shapers::Setpoint;

use super::RobotLink;
use super::datagram::write_setpoint;
use crate::service::clock::ServiceClock;
use crate::service::contract::{LinkHealth, Measured};
use crate::service::signature::Key;
pub use receiver::{Ear, Heard};

/// The settings of the UDP link.
#[derive(Clone, Debug)]
pub struct UdpSettings {
    /// The address of the service.
    pub address: SocketAddr,
    /// The robot's address; where absent, and on loopback only, that of its first datagram.
    pub robot: Option<SocketAddr>,
    /// Names of the joints.
    pub joints: Vec<String>,
    /// Silence after which the address of a robot may change, and delay above which a datagram counts as late.
    pub watchdog: Duration,
    /// Key that signs outgoing datagrams, and with which incoming ones must be signed.
    pub key: Option<Key>,
}

/// The tick's end of the UDP link.
pub struct UdpLink {
    socket: UdpSocket,
    joints: Vec<String>,
    key: Option<Key>,
    heard: Heard,
    sequence: u64,
    sent: u64,
    failures: u64,
    buffer: [u8; 512],
    ending: Arc<AtomicBool>,
    receiver: Option<JoinHandle<()>>,
}

impl UdpLink {
    /// Binds the socket and starts the receiving thread.
    ///
    /// # Errors
    /// The system's error.
    pub fn start(settings: UdpSettings, clock: ServiceClock) -> io::Result<Self> {
        let socket = UdpSocket::bind(settings.address)?;
        socket.set_nonblocking(true)?;
        let ending = Arc::new(AtomicBool::new(false));
        let (joints, key) = (settings.joints.clone(), settings.key.clone());
        // A sequence number is used only once with a key, also after a restart. There are fewer setpoints than
        // microseconds, and JSON readers keep these to the last digit.
        let sequence = match &key {
            Some(_) => (1e6 * clock.unix_time()) as u64,
            None => 0,
        };
        let (ear, heard) = Ear::new(settings);
        let (own, stop) = (socket.try_clone()?, Arc::clone(&ending));
        let receiver = std::thread::Builder::new()
            .name("quell-udp".into())
            .spawn(move || ear.listen(&own, &clock, &stop))?;
        Ok(Self {
            socket,
            joints,
            key,
            heard,
            sequence,
            sent: 0,
            failures: 0,
            buffer: [0; 512],
            ending,
            receiver: Some(receiver),
        })
    }

    /// Its address.
    ///
    /// # Errors
    /// The system's error.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }
}

impl RobotLink for UdpLink {
    fn receive(&mut self, _now: f64, inbox: &mut Vec<Measured>) {
        self.heard.receive(inbox);
    }

    fn carries_time(&self) -> bool {
        true
    }

    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint) {
        let (Some(peer), Some(name)) = (self.heard.peer(), self.joints.get(joint)) else {
            return;
        };
        self.sequence += 1;
        let written = write_setpoint(&mut self.buffer, self.sequence, now, name, setpoint);
        let length = match (&self.key, written.map(<[u8]>::len)) {
            (Some(key), Some(length)) => key.sign(&mut self.buffer, length),
            (_, length) => length,
        };
        let bytes = length.and_then(|length| self.buffer.get(..length));
        // If the system's buffer is full, this setpoint is lost, as in the network; the next one follows a
        // period later.
        match bytes.map(|bytes| self.socket.send_to(bytes, peer)) {
            Some(Ok(_)) => self.sent += 1,
            _ => self.failures += 1,
        }
    }

    fn counters(&self) -> LinkHealth {
        LinkHealth {
            sent: self.sent,
            send_failures: self.failures,
            ..self.heard.counters()
        }
    }
}

impl Drop for UdpLink {
    fn drop(&mut self) {
        self.ending.store(true, Relaxed);
        if let Some(receiver) = self.receiver.take() {
            // It returns nothing; a panic was reported when it occurred.
            let _ = receiver.join();
        }
    }
}
