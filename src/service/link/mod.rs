//! Links to robots: setpoints out, measurements in. One small trait, one file a link.

mod clock_offset;
pub mod datagram;
mod embedded;
mod intake;
mod sequence;
mod udp;
#[cfg(feature = "zenoh")]
mod zenoh;

pub use clock_offset::ClockOffset;
pub use embedded::EmbeddedLink;
pub use sequence::{Order, Sequence};
pub use udp::{Ear, Heard, UdpLink, UdpSettings};
#[cfg(feature = "zenoh")]
pub use zenoh::{Node, ZenohBridge, ZenohLink};

use quell_shapers::Setpoint;

use super::contract::{LinkHealth, Measured};
use crate::plant::Load;

/// Measurements of a joint that one tick can take; at 250 Hz that is 32 a millisecond.
pub const INBOX: usize = 128;

/// The link's part of the tick. Nothing of it allocates, blocks or fails.
pub trait RobotLink: Send {
    /// Takes what has come since the last tick, oldest first: `inbox` is not grown beyond its
    /// capacity, what finds no room waits or is counted. `now` is on the service's clock, s.
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>);

    /// Whether a setpoint tells the robot for which instant it is. Where it does not, a robot that simply
    /// follows would jump if a tick that was missed were made up for: the command waits instead
    /// ([`pace`](super::tick::pace)).
    fn carries_time(&self) -> bool;

    /// Sends where a joint, counted from 0, shall be at the end of this control period.
    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint);

    /// Called at each tick after the last joint's setpoint: where all joints go out in one message,
    /// it goes now.
    fn flush(&mut self) {}

    /// The counts so far.
    fn counters(&self) -> LinkHealth;

    /// Takes a payload up, where the robot is simulated.
    fn carry(&mut self, _load: Load) {}
}
