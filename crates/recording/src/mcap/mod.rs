//! MCAP files in the profile of ROS 2: recordings are written during the run, and read without a manifest.
//!
//! The file contains the definitions of its topics, so that a manifest can name a field of any message.
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
