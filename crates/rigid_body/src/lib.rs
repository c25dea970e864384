#![doc = include_str!("../README.md")]

mod beside;
mod contradiction;
mod coupling;
mod dynamics;
mod payload;
mod robot;
mod rotor;

pub use beside::{Beside, beside};
pub use coupling::{Cause, Coupling, couplings};
pub use dynamics::Dynamics;
pub use payload::{Payload, payload};
pub use robot::{Joint, Robot, RobotError};
pub use rotor::{Unseen, rotor};
