//! MCAP files in the profile of ROS 2: recordings are written while they are made, and read without a manifest.
//!
//! A topic's definition stands in the file, so that a field of any message can be named.
//!
//! Source: MCAP format specification, version 0; ROS 2 design, "Interface definition using .msg files".

mod cdr;
mod message;
mod topic;
mod writer;

pub use writer::McapWriter;
