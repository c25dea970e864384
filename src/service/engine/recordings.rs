//! Existing recordings: the state names no other.

use super::Engine;
use crate::service::contract::{DiskPart, RecordingNews, ServiceError};

impl Engine {
    /// The name of a move's recording, if it is to be recorded.
    pub(super) fn recording_name(&self, id: u64) -> Option<String> {
        let enabled = self.config.recording.enabled;
        enabled.then(|| crate::service::recorder::name_of_move(id))
    }

    /// Whether a move may begin although recording fails.
    pub(super) fn check_recording(&self) -> Result<(), ServiceError> {
        let fault = match self.config.recording.required {
            true => self.disk.fault(DiskPart::Recordings),
            false => None,
        };
        fault.map_or(Ok(()), |reason| Err(ServiceError::NotRecorded { reason }))
    }

    /// Handles messages of the recorder.
    pub(super) fn hear_of_recordings(&mut self) {
        let mut changed = false;
        while let Ok(news) = self.ends.recordings.try_recv() {
            changed |= match news {
                RecordingNews::Kept { move_id, name } => self.names(move_id, &name),
                RecordingNews::Gone { name } => self.forgets(&name),
            };
        }
        if changed {
            self.save();
        }
    }

    /// Adds the name of its recording to a move.
    fn names(&mut self, id: u64, name: &str) -> bool {
        let moves = self
            .joints
            .iter_mut()
            .filter_map(|joint| joint.running.as_mut());
        for running in moves.filter(|running| running.start.id == id) {
            running.recording = Some(name.to_owned());
        }
        let done = self.moves.iter_mut().find(|done| done.id == id);
        let Some(done) = done.filter(|done| done.recording.as_deref() != Some(name)) else {
            return false;
        };
        done.recording = Some(name.to_owned());
        true
    }

    /// Removes the name of a recording that is gone.
    fn forgets(&mut self, name: &str) -> bool {
        let is_it = |recording: &mut String| recording == name;
        for running in self
            .joints
            .iter_mut()
            .filter_map(|joint| joint.running.as_mut())
        {
            running.recording.take_if(is_it);
        }
        let moves = self.moves.iter_mut();
        let named = moves.filter_map(|done| done.recording.take_if(is_it));
        named.count() > 0
    }
}
