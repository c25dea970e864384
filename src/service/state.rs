//! The state that outlives the process: the last good modes, and the last moves, in one JSON file.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use quell_shapers::Mode;
use serde::{Deserialize, Serialize};
use tracing::warn;

use super::contract::{DiskPart, ModeValue, MoveResult};
use super::disk::Disk;
use crate::learning::Memory;

/// Version of the file's layout; a file of another version is set aside.
const VERSION: u32 = 1;
/// Payloads within this difference are equal, kg: a gram.
const SAME_PAYLOAD: f64 = 1e-3;
/// Most payloads of a joint that are remembered; the longest unused one is dropped.
const PAYLOADS: usize = 32;

/// Everything that is saved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Layout of the file.
    pub version: u32,
    /// Number of the last move.
    pub last_move: u64,
    /// How often the service was started.
    pub starts: u64,
    /// The learned modes of the joints, by name.
    pub joints: BTreeMap<String, JointState>,
    /// The last moves.
    pub moves: Vec<MoveResult>,
}

impl State {
    /// Makes the list of moves consistent with the recordings: names of missing recordings are removed, and the
    /// number of an existing recording is not used again.
    pub fn agree_with(&mut self, is_there: impl Fn(&str) -> bool, last_move: u64) {
        self.last_move = self.last_move.max(last_move);
        for done in &mut self.moves {
            done.recording = done.recording.take().filter(|name| is_there(name));
        }
    }
}

/// The learned mode of a joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct JointState {
    /// One mode for each payload, the one learned last at the end.
    pub modes: Vec<LearnedMode>,
    /// Number of changes of the train by an estimate, since ever.
    pub retunes: u64,
    /// Knowledge from its moves; absent in files of earlier versions.
    #[serde(default)]
    pub map: Option<Memory>,
}

/// A mode that was good enough to shape for.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LearnedMode {
    /// Payload of the embedded arm, kg; 0 for a robot that does not say.
    pub payload_kg: f64,
    /// The mode.
    pub mode: ModeValue,
    /// When, seconds since 1970.
    pub unix_time_s: f64,
}

impl JointState {
    /// Removes what no arm has, and says what and why. A frequency is above 0 and below `nyquist` (Hz).
    fn refuse_impossible(&mut self, nyquist: f64) -> Vec<String> {
        let mut reasons = Vec::new();
        self.modes.retain(|learned| {
            let reason = learned.impossible(nyquist);
            let payload = learned.payload_kg;
            let told = |reason: &String| format!("mode with {payload} kg: {reason}");
            reasons.extend(reason.iter().map(told));
            reason.is_none()
        });
        if let Some(map) = &mut self.map {
            let refused = map.refuse_impossible(TAU * nyquist);
            reasons.extend(refused.iter().map(|reason| format!("map, {reason}")));
        }
        if self.map.take_if(|map| !map.is_valid()).is_some() {
            reasons.push("map: its sums are not valid, or it has too many modes".to_owned());
        }
        reasons
    }

    /// The mode last learned with a payload.
    pub fn with_payload(&self, payload: f64) -> Option<&LearnedMode> {
        let same = |learned: &&LearnedMode| (learned.payload_kg - payload).abs() <= SAME_PAYLOAD;
        self.modes.iter().find(same)
    }

    /// Remembers a mode.
    pub fn learn(&mut self, learned: LearnedMode) {
        let other = |old: &LearnedMode| (old.payload_kg - learned.payload_kg).abs() > SAME_PAYLOAD;
        self.modes.retain(other);
        self.modes.push(learned);
        if self.modes.len() > PAYLOADS {
            self.modes.remove(0);
        }
    }
}

impl LearnedMode {
    fn impossible(&self, nyquist: f64) -> Option<String> {
        let f = self.mode.frequency_hz;
        match f > 0.0 && f < nyquist {
            true => Mode::try_from(self.mode)
                .err()
                .map(|error| error.to_string()),
            false => Some(format!(
                "{f} Hz is not between 0 and {nyquist} Hz, half of the control rate"
            )),
        }
    }
}

/// The file.
#[derive(Clone, Debug)]
pub struct StateFile {
    path: PathBuf,
    disk: Disk,
}

impl StateFile {
    /// The file within a folder.
    pub fn within(folder: &Path, disk: Disk) -> Self {
        Self {
            path: folder.join("state.json"),
            disk,
        }
    }

    /// The saved state, for a control period (s). A file that cannot be read or understood is set aside with a warning, so
    /// that the next state does not overwrite it. The service then starts without its memory.
    pub fn load(&self, period: f64) -> State {
        let text = match fs::read(&self.path) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return State::default(),
            Err(error) => return self.set_aside(&error.to_string()),
        };
        match serde_json::from_slice::<State>(&text) {
            Ok(state) if state.version == VERSION => self.without_impossible(state, &text, period),
            Ok(state) => self.set_aside(&format!("its version is {}", state.version)),
            Err(error) => self.set_aside(&error.to_string()),
        }
    }

    /// A state without the modes that no arm has. The file is kept beside the next states then.
    fn without_impossible(&self, mut state: State, text: &[u8], period: f64) -> State {
        let nyquist = 0.5 / period;
        let joints = state.joints.iter_mut();
        let reasons: Vec<String> = joints
            .flat_map(|(name, joint)| {
                let reasons = joint.refuse_impossible(nyquist).into_iter();
                reasons.map(move |reason| format!("{name}, {reason}"))
            })
            .collect();
        if !reasons.is_empty() {
            let aside = self.aside(text);
            let kept = match self.disk.write_whole(&aside, text) {
                Ok(()) => format!("the file is kept as {}", aside.display()),
                Err(error) => format!("the file cannot be kept: {error}"),
            };
            let (path, reasons) = (self.path.display(), reasons.join("; "));
            warn!("{path}: {reasons}; this is forgotten; {kept}");
        }
        state
    }

    /// A name for a damaged file that no other one has, or the one that holds the same bytes.
    fn aside(&self, text: &[u8]) -> PathBuf {
        let named = |n: u64| match n {
            1 => self.path.with_extension("json.damaged"),
            n => self.path.with_extension(format!("json.damaged.{n}")),
        };
        // Where a folder cannot be read, any name is as good: what follows says why.
        let free = |path: &PathBuf| match path.try_exists() {
            Ok(true) => fs::read(path).is_ok_and(|held| held == text),
            Ok(false) | Err(_) => true,
        };
        let mut names = (1..).map(named);
        names.find(free).unwrap_or_else(|| named(1))
    }

    fn set_aside(&self, reason: &str) -> State {
        let text = fs::read(&self.path).unwrap_or_default();
        let aside = self.aside(&text);
        let moved = self.disk.storage().rename(&self.path, &aside);
        let kept = match moved {
            Ok(()) => format!("set aside as {}", aside.display()),
            Err(error) => format!("it cannot be set aside: {error}"),
        };
        warn!(
            "{}: {reason}; {kept}; nothing is remembered",
            self.path.display()
        );
        State::default()
    }

    /// Saves a state atomically: a reader always finds the old or the new state, complete.
    ///
    /// # Errors
    /// The system's error. The disk reports it until a state is saved again.
    pub fn save(&self, state: &State) -> io::Result<()> {
        let state = State {
            version: VERSION,
            ..state.clone()
        };
        let text = serde_json::to_vec_pretty(&state)?;
        let written = self.write(&text);
        let named = written.map_err(|error| {
            let path = self.path.display();
            io::Error::new(error.kind(), format!("{path}: {error}"))
        });
        self.disk.told(DiskPart::State, named)
    }

    /// Writes the file; on a full disk into the room that was kept for it.
    fn write(&self, text: &[u8]) -> io::Result<()> {
        let room = self.path.with_extension("json.room");
        let storage = self.disk.storage();
        let full = |error: &io::Error| error.kind() == io::ErrorKind::StorageFull;
        let written = match self.disk.write_whole(&self.path, text) {
            Err(error) if full(&error) && storage.remove(&room).is_ok() => {
                self.disk.write_whole(&self.path, text)
            }
            written => written,
        };
        let kept = fs::metadata(&room).map_or(0, |room| room.len());
        if written.is_ok() && kept < text.len() as u64 {
            self.keep_room(&room, text);
        }
        written
    }

    /// Keeps room for a state twice as large as this one. These are its bytes: where the system compresses, they take
    /// what a state takes.
    fn keep_room(&self, room: &Path, text: &[u8]) {
        let storage = self.disk.storage();
        let kept = storage.create(room).and_then(|mut file| {
            file.write_all(text)?;
            file.write_all(text)?;
            file.flush()
        });
        if kept.is_err() {
            // There is none now; the next state tries again.
            let _ = storage.remove(room);
        }
    }
}
