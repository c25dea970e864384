//! Whether the data folder takes what is to be kept.

use schemars::JsonSchema;
use serde::Serialize;

/// How it goes with the data folder.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct DiskView {
    /// Whether all that is to be kept is kept.
    pub state: DiskState,
    /// The files that cannot be written now, and why; empty where all is fine.
    pub faults: Vec<DiskFault>,
    /// Attempts to write that failed since the start.
    pub failures: u64,
    /// Recordings since the start that are not whole on the shelf because of that.
    pub recordings_lost: u64,
}

/// Whether all that is to be kept is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DiskState {
    /// The last write reached the disk.
    #[default]
    Fine,
    /// Something cannot be written.
    Failing,
}

/// The things that the service keeps on the disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DiskPart {
    /// Moves and what is recorded on demand.
    Recordings,
    /// The learned modes, and the list of moves.
    State,
}

impl DiskPart {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Recordings, Self::State];

    /// Name in the state, in metrics and in the log.
    pub fn name(self) -> &'static str {
        match self {
            Self::Recordings => "recordings",
            Self::State => "state",
        }
    }
}

/// Something that cannot be written.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DiskFault {
    /// Its kind.
    pub what: DiskPart,
    /// The file or folder, and what is the matter with it; as of the last failure.
    pub reason: String,
    /// Since when, seconds since 1970.
    pub since_unix_time_s: f64,
}
