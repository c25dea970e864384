//! The messages of the recorder to the engine.

/// The outcome of a recording. The state names a recording only after it is [`Kept`](Self::Kept), and
/// no longer once it is [`Gone`](Self::Gone).
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecordingNews {
    /// It is on the disk, whole or growing: a kill costs its end at most.
    Kept {
        /// Number of the move.
        move_id: u64,
        /// Its name on the shelf.
        name: String,
    },
    /// It could not be written, or had to go.
    Gone {
        /// Its name.
        name: String,
    },
}
