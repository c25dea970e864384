//! Links to robots: setpoints out, measurements in. One small trait, one file a link.

mod clock_offset;
pub mod datagram;
mod embedded;
mod intake;
mod sequence;
mod signature;
mod udp;
#[cfg(feature = "zenoh")]
mod zenoh;

pub use clock_offset::ClockOffset;
pub use embedded::EmbeddedLink;
pub use sequence::{Order, Sequence};
pub use signature::{Key, Replay};
pub use udp::{UdpLink, UdpSettings};
#[cfg(feature = "zenoh")]
pub use zenoh::{Node, ZenohBridge, ZenohLink};

use std::net::SocketAddr;

use quell_shapers::Setpoint;

use super::contract::Measured;
use crate::plant::Load;

/// Measurements that one tick can take; at 250 Hz that is 32 a millisecond.
pub const INBOX: usize = 128;

/// What a link does at the tick. Nothing of it allocates, blocks or fails.
pub trait RobotLink: Send {
    /// Takes what has come since the last tick, oldest first: `inbox` is not grown beyond its
    /// capacity, what finds no room waits or is counted. `now` is on the service's clock, s.
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>);

    /// Sends where a joint, counted from 0, shall be at the end of this control period.
    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint);

    /// Called at each tick after the last joint's setpoint: where all joints go out in one message,
    /// it goes now.
    fn flush(&mut self) {}

    /// What came and went so far.
    fn counters(&self) -> LinkCounters;

    /// Takes a payload up, where the robot is simulated.
    fn carry(&mut self, _load: Load) {}
}

/// What came over a link and went out, since the start; the names as in
/// [`super::contract::LinkHealth`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkCounters {
    /// Datagrams received.
    pub received: u64,
    /// Setpoints sent.
    pub sent: u64,
    /// Setpoints that could not be sent.
    pub send_failures: u64,
    /// Stamps missing.
    pub lost: u64,
    /// Datagrams that came late.
    pub late: u64,
    /// Datagrams that came twice.
    pub doubled: u64,
    /// Datagrams that came after a younger one.
    pub reordered: u64,
    /// Datagrams from another address.
    pub foreign: u64,
    /// Datagrams that are not what they should be.
    pub malformed: u64,
    /// Datagrams for a joint that there is not.
    pub unknown_joint: u64,
    /// Datagrams whose signature is wrong or missing.
    pub unsigned: u64,
    /// Signed datagrams that had come before.
    pub replayed: u64,
    /// Measurements for which the tick had no room.
    pub overflowed: u64,
    /// The robot's address.
    pub peer: Option<SocketAddr>,
    /// The robot's clock minus the service's, s.
    pub clock_offset: Option<f64>,
}
