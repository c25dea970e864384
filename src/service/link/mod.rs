//! Links to robots: setpoints out, measurements in. One small trait, one file for each link.

mod clock_offset;
pub mod datagram;
mod embedded;
mod intake;
mod sensor_clock;
mod sequence;
mod udp;
#[cfg(feature = "zenoh")]
mod zenoh;

pub use clock_offset::ClockOffset;
pub use embedded::EmbeddedLink;
use sequence::LONGEST_WAY;
pub use sequence::{Order, Sequence};
pub use udp::{Ear, Heard, UdpLink, UdpSettings};
#[cfg(feature = "zenoh")]
pub use zenoh::{Node, ZenohBridge, ZenohLink};

use quell_shapers::Setpoint;

use super::contract::{LinkHealth, Measured};
use crate::plant::Load;

/// Most measurements of a joint in one tick; at 250 Hz that is 32 a millisecond.
pub const INBOX: usize = 128;

/// The link's part of the tick. It must not allocate, block or fail.
pub trait RobotLink: Send {
    /// Takes the measurements since the last tick, oldest first. `inbox` is not grown beyond its capacity;
    /// further measurements wait or are counted. `now` is on the service's clock, s.
    fn receive(&mut self, now: f64, inbox: &mut Vec<Measured>);

    /// Whether a setpoint tells the robot its instant. If not, a robot that simply follows would jump if a
    /// missed tick were made up for; the command waits instead ([`pace`](super::tick::pace)).
    fn carries_time(&self) -> bool;

    /// Sends the target of a joint, counted from 0, for the end of this control period.
    fn send(&mut self, now: f64, joint: usize, setpoint: &Setpoint);

    /// Called at each tick after the last joint's setpoint: a link that sends all joints in one message sends
    /// it now.
    fn flush(&mut self) {}

    /// The counts so far.
    fn counters(&self) -> LinkHealth;

    /// Changes the payload of a simulated robot.
    fn carry(&mut self, _load: Load) {}
}
