//! Where a recording is written to.

use std::io::Write;

/// A file that is open for writing, or what stands in for one. Nothing is done with it once it is flushed.
pub type Sink = Box<dyn Write + Send + Sync>;
