//! The destination of a recording.

use std::io::Write;

/// An open file, or a stand-in for one. Nothing is done with it after the flush.
pub type Sink = Box<dyn Write + Send + Sync>;
