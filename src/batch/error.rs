//! Why a batch does not go on, or a recording is not taken into it.

use std::io;
use std::path::PathBuf;

use crate::recording::RecordingError;

/// Why a batch does not go on, or a recording is not taken into it.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// There is no recording where one was said to be.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The disk refuses.
    #[error("{}: {source}", path.display())]
    Disk {
        /// The file or folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// Something that is no result has the name of a result's folder.
    #[error(
        "{}: it is there already and holds no result: it is not written over; remove it, or give another \
         folder ({source})",
        path.display()
    )]
    InTheWay {
        /// The folder.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The files of a recording are more than is sent about.
    #[error(
        "{}: the recording's files have {bytes} bytes; at most {most} are taken into a batch",
        path.display()
    )]
    TooLarge {
        /// The recording.
        path: PathBuf,
        /// The size of its files, bytes.
        bytes: u64,
        /// The most that is taken, bytes.
        most: u64,
    },
    /// A manifest names a file that no other machine would find.
    #[error(
        "{}: {}: in a batch the manifest names its files relative to its own folder",
        manifest.display(), file.display()
    )]
    Absolute {
        /// The manifest.
        manifest: PathBuf,
        /// The file that it names.
        file: PathBuf,
    },
    /// An archive that is not a packed recording.
    #[error("the packed recording cannot be opened: {0}")]
    Archive(String),
    /// Not a share of a batch.
    #[error("shard {0:?}: it must be i/n, as 1/8 to 8/8")]
    Shard(String),
    /// The queue is closed: its workers have ended.
    #[error("the workers have ended, and nothing more is taken")]
    Closed,
    /// A queue elsewhere does not answer, or refuses.
    #[error("{server}: {what}: {reason}")]
    Queue {
        /// Where it is.
        server: String,
        /// The attempt, and its key.
        what: String,
        /// The server's answer.
        reason: String,
    },
    /// Something is asked for that is not part of this build.
    #[error("{feature} is not part of this build: cargo build --release --features {feature}")]
    NotBuilt {
        /// The feature that has it.
        feature: &'static str,
    },
    /// The system makes no thread.
    #[error("a thread cannot be started: {0}")]
    Thread(String),
}

impl BatchError {
    /// The disk's refusal of a path.
    pub fn disk(path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let path = path.into();
        move |source| Self::Disk { path, source }
    }
}
