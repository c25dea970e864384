//! The recorder's task: from the stream to the shelf.

use std::collections::VecDeque;
use std::sync::Arc;

use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, mpsc};

use super::demand::Demand;
use super::log::Log;
use super::running::{Running, write_down};
use super::{About, RecordError, RecordingEnd, Shelf, ShelfError, shelf};
use crate::service::contract::{
    Batch, DiskPart, Event, Handle, MoveResult, MoveStart, RecordingNews,
};

/// Rest before a move that is recorded with it, s, for the measurement of the noise.
const BEFORE: f64 = 1.0;
/// Rest after it, s, for the damping of the residual vibration. Another move ends it at once. A joint whose command would
/// have left its range still brakes when its move has ended.
const AFTER: f64 = 1.0;
/// Interval of writing, s: the loss by a kill. It equals the interval at which the file closes its chunks.
const EVERY: f64 = 0.25;
/// Interval at which the folder is looked at, and a disk that has refused a write is tried again, s.
const AGAIN: f64 = 1.0;
/// Most subjects that are kept of recordings whose end the disk has refused. Only the first can have a file: a disk that fails
/// takes no new one.
const REFUSED: usize = 256;

/// The recorder's task.
pub struct Task {
    handle: Handle,
    shelf: Arc<Shelf>,
    /// The newest samples, for the rest before a move.
    before: VecDeque<Arc<Batch>>,
    running: Vec<Running>,
    /// Time of the last write, s on the service's clock.
    written: f64,
    /// Time of the last look at the disk, s on the service's clock.
    asked: f64,
    /// Whether an unfinished recording waits for room.
    unfinished: bool,
    /// Names and subjects of those whose end the disk has refused.
    refused: Vec<(String, About)>,
}

impl Task {
    /// A task that has not read anything yet.
    pub fn new(handle: Handle, shelf: Arc<Shelf>) -> Self {
        Self {
            // The shelf could not be put in order.
            unfinished: shelf.disk().is_failing(DiskPart::Recordings),
            refused: Vec::new(),
            handle,
            shelf,
            before: VecDeque::new(),
            running: Vec::new(),
            written: f64::NEG_INFINITY,
            asked: f64::NEG_INFINITY,
        }
    }

    /// Reads the stream until it is closed, or its senders are gone.
    pub async fn run(
        mut self,
        mut stream: broadcast::Receiver<Arc<Batch>>,
        mut requests: mpsc::Receiver<Demand>,
    ) {
        loop {
            tokio::select! {
                // Arrived data belong to a request that comes after them.
                biased;
                batch = stream.recv() => match batch {
                    Ok(batch) => self.take(batch).await,
                    Err(RecvError::Lagged(lost)) => self.lost(lost),
                    Err(RecvError::Closed) => break,
                },
                Some(demand) = requests.recv() => match demand {
                    // The client may have disconnected.
                    Demand::Begin { joint, index, reply } => {
                        let _ = reply.send(self.begin(joint, index).await);
                    }
                    Demand::End { reply } => {
                        let _ = reply.send(self.end(RecordingEnd::Request).await);
                    }
                    Demand::Close { reply } => {
                        while let Ok(batch) = stream.try_recv() {
                            self.take(batch).await;
                        }
                        self.put_all().await;
                        let _ = reply.send(());
                        return;
                    }
                },
            }
        }
        self.put_all().await;
    }

    async fn take(&mut self, batch: Arc<Batch>) {
        for event in &batch.events {
            if let Event::MoveStarted(start) = event {
                self.ring_out(|one| one.about.joint == start.joint).await;
                self.started(start);
            }
        }
        let snapshot = self.handle.snapshot();
        for one in &mut self.running {
            one.log.take(&batch);
            one.know(&snapshot);
        }
        let now = batch.time;
        let brakes = |one: &&mut Running| one.about.result.is_some() && one.log.is_moving();
        for one in self.running.iter_mut().filter(brakes) {
            one.until = now + AFTER;
        }
        for event in &batch.events {
            if let Event::MoveEnded(result) = event {
                self.ended(result, now);
            }
        }
        self.ring_out(|one| one.until <= now).await;
        self.look_for_room(now).await;
        if !self.running.is_empty() && now - self.written >= EVERY {
            self.written = now;
            let running = std::mem::take(&mut self.running);
            self.running = write_down(running, &self.shelf, self.epoch(), &self.handle).await;
        }
        let full = |one: &Running| one.id.is_none() && one.log.is_full();
        if self.running.iter().any(full) {
            tracing::warn!("a recording on demand has reached its longest and ends");
            // It exists, and `put` reports errors of the disk.
            let _ = self.end(RecordingEnd::Longest).await;
        }
        self.remember(batch);
    }

    /// Keeps the batch as long as a move that includes it could begin.
    fn remember(&mut self, batch: Arc<Batch>) {
        let now = batch.time;
        self.before.push_back(batch);
        let old = |first: &Arc<Batch>| first.time < now - BEFORE;
        while self.before.front().is_some_and(old) {
            self.before.pop_front();
        }
    }

    /// Stores the recordings of finished moves whose time is over.
    async fn ring_out(&mut self, over: impl Fn(&Running) -> bool) {
        let ended = |one: &Running| one.about.result.is_some() && over(one);
        while let Some(index) = self.running.iter().position(ended) {
            let running = self.running.remove(index);
            // `put` reports errors.
            let _ = self.put(running, RecordingEnd::Move).await;
        }
    }

    async fn put_all(&mut self) {
        while let Some(running) = self.running.pop() {
            let end = match running.about.result {
                Some(_) => RecordingEnd::Move,
                None => RecordingEnd::Service,
            };
            // `put` reports errors.
            let _ = self.put(running, end).await;
        }
    }

    fn started(&mut self, start: &MoveStart) {
        if let Some(name) = &start.recording {
            let about = About {
                number: self.shelf.number(),
                joint: start.joint.clone(),
                unix_time_s: start.unix_time_s,
                ..About::default()
            };
            let from = start.time_s - BEFORE;
            let name = shelf::name_of(name);
            self.start(Some(start.id), name, start.joint_index, from, about);
        }
    }

    fn start(&mut self, id: Option<u64>, name: String, joint: usize, from: f64, about: About) {
        let mut log = Log::new(joint, from);
        self.before.iter().for_each(|batch| log.take(batch));
        self.running.push(Running::new(id, name, about, log));
    }

    fn ended(&mut self, result: &MoveResult, now: f64) {
        let joint = &result.joint;
        // The move that took over has a recording of its own.
        let newer = |one: &Running| one.about.joint == *joint && one.id > Some(result.id);
        let taken_over = self.running.iter().any(newer);
        let ended = |one: &&mut Running| one.id == Some(result.id) && one.about.result.is_none();
        if let Some(running) = self.running.iter_mut().find(ended) {
            running.about.result = Some(result.clone());
            // The result is written before the recording is complete.
            running.described = false;
            running.until = if taken_over { now } else { now + AFTER };
        }
    }

    async fn begin(&mut self, joint: String, index: usize) -> Result<String, RecordError> {
        if let Some(one) = self.running.iter().find(|one| one.id.is_none()) {
            let joint = one.about.joint.clone();
            return Err(RecordError::Running { joint });
        }
        let snapshot = self.handle.snapshot();
        let wanted = format!("{}-{joint}", snapshot.unix_time_s.round());
        let about = About {
            number: self.shelf.number(),
            joint,
            unix_time_s: snapshot.unix_time_s,
            ..About::default()
        };
        let described = about.clone();
        // The client is told at once if the disk refuses.
        let begun = self.on_disk(move |shelf| {
            let name = shelf.free_name(&wanted);
            match shelf.begin(&name, &described) {
                Ok(_) => Ok(name),
                refused => shelf.told(refused.map(|_| name)),
            }
        });
        let name = begun.await.map_err(|reason| RecordError::NotKept {
            name: "on demand".into(),
            reason,
        })?;
        self.start(None, name.clone(), index, snapshot.time_s - BEFORE, about);
        Ok(name)
    }

    async fn end(&mut self, why: RecordingEnd) -> Result<String, RecordError> {
        let index = self.running.iter().position(|one| one.id.is_none());
        let running = self.running.remove(index.ok_or(RecordError::NotRunning)?);
        let name = running.name.clone();
        let kept = self.put(running, why).await;
        kept.map_err(|reason| RecordError::NotKept { name, reason })
    }

    fn lost(&mut self, batches: u64) {
        tracing::warn!(batches, "the recorder was too slow: batches are lost");
        let running = self.running.iter_mut();
        running.for_each(|one| one.about.batches_lost += batches);
        // The end of a move may have been among the lost batches.
        let snapshot = self.handle.snapshot();
        for result in &snapshot.moves {
            self.ended(result, snapshot.time_s);
        }
    }

    /// Stores a recording on the shelf, and reports its name there, or the error.
    async fn put(&mut self, mut running: Running, why: RecordingEnd) -> Result<String, String> {
        let snapshot = self.handle.snapshot();
        let joint = snapshot
            .joints
            .iter()
            .find(|joint| joint.name == running.about.joint);
        running.about.mode = joint.and_then(|joint| joint.mode);
        running.about.payload_kg = snapshot.payload_kg;
        running.about.duration_s = running.log.duration();
        running.about.ended = why;
        let epoch = self.epoch();
        // Before the file is written again.
        running.journal = None;
        let Running {
            id,
            name,
            about,
            log,
            ..
        } = running;
        let wanted = name.clone();
        let subject = about.clone();
        let kept = self.on_disk(move |shelf| {
            shelf.told(shelf.put(&wanted, &about, |draft| {
                let (path, file) = draft.mcap()?;
                log.write_mcap(file, &path, &about.joint, epoch)?;
                draft.recording(&log.recording(&wanted, about.payload_kg))
            }))
        });
        let kept = kept.await;
        if kept.is_err() && self.refused.len() < REFUSED {
            // What is on the disk of it was cut there.
            let subject = About {
                ended: RecordingEnd::Cut,
                ..subject
            };
            self.refused.push((shelf::name_of(&name), subject));
        }
        self.tell(id, &name, &kept);
        self.tidy().await;
        kept
    }

    fn tell(&mut self, id: Option<u64>, name: &str, kept: &Result<String, String>) {
        if kept.as_ref().ok().is_none_or(|kept| kept != name) {
            let name = name.to_owned();
            self.handle.tell(RecordingNews::Gone { name });
        }
        match (kept, id) {
            (Ok(name), Some(move_id)) => {
                let name = name.clone();
                self.handle.tell(RecordingNews::Kept { move_id, name });
            }
            (Ok(_), None) => {}
            (Err(reason), _) => {
                tracing::error!(name, "a recording is not whole on the shelf: {reason}");
                self.shelf.disk().lost_recording();
                self.unfinished = true;
            }
        }
    }

    /// Looks at the folder, also while nothing is recorded, and tries a disk that has refused a write. If it
    /// takes one, unfinished recordings are stored on the shelf as far as they were written.
    async fn look_for_room(&mut self, now: f64) {
        if now - self.asked >= AGAIN {
            self.asked = now;
            let failing = self.shelf.disk().is_failing(DiskPart::Recordings);
            let tried = self.on_disk(move |shelf| {
                shelf.told(match failing {
                    true => shelf.probe(),
                    false => shelf.check(),
                })
            });
            // The disk keeps the result.
            let _ = tried.await;
        }
        if !self.unfinished || self.shelf.disk().is_failing(DiskPart::Recordings) {
            return;
        }
        let being_made: Vec<_> = self.running.iter().map(|one| one.name.clone()).collect();
        let known = self.refused.clone();
        let salvaged = self.on_disk(move |shelf| {
            let salvaged = shelf.salvage(&being_made, &known);
            match salvaged.is_ok() {
                true => salvaged,
                false => shelf.told(salvaged),
            }
        });
        let Ok(salvaged) = salvaged.await else { return };
        self.unfinished = false;
        self.refused.clear();
        for (name, about) in salvaged {
            if let Some(result) = about.result {
                let move_id = result.id;
                self.handle.tell(RecordingNews::Kept { move_id, name });
            }
        }
    }

    /// The wall time at which the service's clock was 0, seconds since 1970.
    fn epoch(&self) -> f64 {
        let snapshot = self.handle.snapshot();
        snapshot.unix_time_s - snapshot.time_s
    }

    async fn tidy(&self) {
        match self.on_disk(Shelf::tidy).await {
            Ok(gone) => {
                for name in gone {
                    self.handle.tell(RecordingNews::Gone { name });
                }
            }
            // Of a folder that takes nothing it was told already.
            Err(_) if self.shelf.disk().is_failing(DiskPart::Recordings) => {}
            Err(reason) => tracing::warn!("recordings take more than they may: {reason}"),
        }
    }

    /// Runs disk work on a thread that may block. An error is no reason to stop.
    async fn on_disk<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Shelf) -> Result<T, ShelfError> + Send + 'static,
    ) -> Result<T, String> {
        let shelf = Arc::clone(&self.shelf);
        let done = tokio::task::spawn_blocking(move || work(&shelf)).await;
        let failed = |error| format!("the recorder's work on the disk failed: {error}");
        done.map_err(failed)?.map_err(|error| error.to_string())
    }
}
