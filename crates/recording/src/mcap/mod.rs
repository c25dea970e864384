//! MCAP files in the profile of ROS 2: recordings are written while they are made, and read without a manifest.
//!
//! A topic's definition stands in the file, so that a field of any message can be named.
//!
//! Source: MCAP format specification, version 0; ROS 2 design, "Interface definition using .msg files".

mod cdr;
mod chunk;
mod definition;
mod file;
mod message;
mod prefix;
mod record;
mod recording;
mod records;
mod repair;
mod series;
mod topic;
mod value;
mod writer;

pub use cdr::{Damage, Decoder, Encoder};
pub use file::{McapFile, Topic};
pub use recording::Found;
pub use records::Cut;
pub use repair::Mended;
pub use writer::McapWriter;
