//! The recorder: listens to the stream and puts each move, or what is asked for, onto the shelf.

mod journal;
mod log;
mod shelf;

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use thiserror::Error;
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, mpsc, oneshot};

use super::contract::{Batch, Event, Handle, MoveResult, MoveStart};
use journal::Journal;
use log::Log;
pub use shelf::{About, Bounds, Entry, Shelf, ShelfError};

/// Rest before a move that is recorded with it, s: the noise is measured there.
const BEFORE: f64 = 1.0;
/// Rest after it, s: what still rings tells the damping. Another move ends it at once.
const AFTER: f64 = 1.0;
/// The whole as one file in the profile of ROS 2, beside manifest and CSV.
const MCAP: &str = "recording.mcap";
/// Requests that may wait.
const REQUESTS: usize = 8;
/// How often what is too old is looked for.
const TIDY: Duration = Duration::from_secs(3600);

/// Why nothing is recorded on demand.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RecordError {
    /// One runs already.
    #[error("{joint} is being recorded already")]
    Running {
        /// The joint.
        joint: String,
    },
    /// None runs.
    #[error("nothing is being recorded on demand")]
    NotRunning,
    /// The recorder has ended.
    #[error("the recorder has ended")]
    Gone,
}

/// What the outside holds of the recorder; cheap to clone.
#[derive(Clone, Debug)]
pub struct Recorder {
    shelf: Arc<Shelf>,
    requests: mpsc::Sender<Demand>,
}

/// Begins (with a joint and its number) or ends a recording on demand.
#[derive(Debug)]
struct Demand {
    joint: Option<(String, usize)>,
    reply: oneshot::Sender<Result<String, RecordError>>,
}

impl Recorder {
    /// Starts to listen, as long as the runtime lives.
    pub fn start(handle: &Handle, shelf: Shelf) -> Self {
        let shelf = Arc::new(shelf);
        let (requests, requested) = mpsc::channel(REQUESTS);
        let task = Task {
            handle: handle.clone(),
            shelf: Arc::clone(&shelf),
            before: VecDeque::new(),
            running: Vec::new(),
            written: f64::NEG_INFINITY,
        };
        // From here on nothing is missed, whenever the task begins.
        tokio::spawn(task.run(handle.stream(), requested));
        Self { shelf, requests }
    }

    /// What has been recorded.
    pub fn shelf(&self) -> &Arc<Shelf> {
        &self.shelf
    }

    /// Records a joint from now on until [`Recorder::end`], five minutes at most; returns the name.
    ///
    /// # Errors
    /// [`RecordError`] where one is recorded already.
    pub async fn begin(&self, joint: &str, index: usize) -> Result<String, RecordError> {
        self.ask(Some((joint.into(), index))).await
    }

    /// Ends what [`Recorder::begin`] began; returns the name.
    ///
    /// # Errors
    /// [`RecordError`] where nothing is recorded on demand.
    pub async fn end(&self) -> Result<String, RecordError> {
        self.ask(None).await
    }

    async fn ask(&self, joint: Option<(String, usize)>) -> Result<String, RecordError> {
        let (reply, answer) = oneshot::channel();
        let sent = self.requests.send(Demand { joint, reply }).await;
        sent.map_err(|_| RecordError::Gone)?;
        answer.await.unwrap_or(Err(RecordError::Gone))
    }
}

/// One recording that is being made.
struct Running {
    /// Number of the move; none where it was asked for.
    id: Option<u64>,
    name: String,
    about: About,
    log: Log,
    /// What is on disk of it so far.
    journal: Option<Journal>,
    /// Whether the disk refused that.
    unwritten: bool,
    /// Time at which it is complete, s on the service's clock.
    until: f64,
}

struct Task {
    handle: Handle,
    shelf: Arc<Shelf>,
    /// What came last, for the rest before a move.
    before: VecDeque<Arc<Batch>>,
    running: Vec<Running>,
    /// When what has come was last written down, s on the service's clock.
    written: f64,
}

impl Task {
    async fn run(
        mut self,
        mut stream: broadcast::Receiver<Arc<Batch>>,
        mut requests: mpsc::Receiver<Demand>,
    ) {
        let mut tidy = tokio::time::interval(TIDY);
        loop {
            tokio::select! {
                batch = stream.recv() => match batch {
                    Ok(batch) => self.take(batch).await,
                    Err(RecvError::Lagged(lost)) => self.lost(lost),
                    Err(RecvError::Closed) => break,
                },
                Some(demand) = requests.recv() => {
                    let answer = match demand.joint {
                        Some((joint, index)) => self.begin(joint, index),
                        None => self.end().await,
                    };
                    // Whoever asked may have gone.
                    let _ = demand.reply.send(answer);
                }
                _ = tidy.tick() => self.tidy().await,
            }
        }
    }

    async fn take(&mut self, batch: Arc<Batch>) {
        for event in &batch.events {
            if let Event::MoveStarted(start) = event {
                self.ring_out(|one| one.about.joint == start.joint).await;
                self.started(start);
            }
        }
        self.running.iter_mut().for_each(|one| one.log.take(&batch));
        let now = last_time(&batch);
        for event in &batch.events {
            if let Event::MoveEnded(result) = event {
                self.ended(result, now);
            }
        }
        self.ring_out(|one| one.until <= now).await;
        self.write_down(now).await;
        let full = |one: &Running| one.id.is_none() && one.log.is_full();
        if self.running.iter().any(full) {
            tracing::warn!("a recording on demand has reached its longest and ends");
            // It is there, and what goes wrong on the disk is told by `put`.
            let _ = self.end().await;
        }
        self.remember(batch);
    }

    /// Keeps the batch as long as a move could begin that wants it.
    fn remember(&mut self, batch: Arc<Batch>) {
        let now = last_time(&batch);
        self.before.push_back(batch);
        let old = |first: &Arc<Batch>| last_time(first) < now - BEFORE;
        while self.before.front().is_some_and(old) {
            self.before.pop_front();
        }
    }

    /// Keeps the recordings of moves that have ended and are no longer waited for.
    async fn ring_out(&mut self, over: impl Fn(&Running) -> bool) {
        let ended = |one: &Running| one.about.result.is_some() && over(one);
        while let Some(index) = self.running.iter().position(ended) {
            let running = self.running.remove(index);
            self.put(running).await;
        }
    }

    fn started(&mut self, start: &MoveStart) {
        if let Some(name) = &start.recording {
            let from = start.time_s - BEFORE;
            let about = About {
                joint: start.joint.clone(),
                unix_time_s: start.unix_time_s,
                ..About::default()
            };
            self.start(Some(start.id), name.clone(), start.joint_index, from, about);
        }
    }

    fn start(&mut self, id: Option<u64>, name: String, joint: usize, from: f64, about: About) {
        let mut log = Log::new(joint, from);
        self.before.iter().for_each(|batch| log.take(batch));
        let name = shelf::name_of(&name);
        self.running.push(Running {
            id,
            name,
            about,
            log,
            journal: None,
            unwritten: false,
            until: f64::INFINITY,
        });
    }

    fn ended(&mut self, result: &MoveResult, now: f64) {
        let ended = |one: &&mut Running| one.id == Some(result.id);
        if let Some(running) = self.running.iter_mut().find(ended) {
            running.about.result = Some(result.clone());
            // What interrupted it has a recording of its own.
            running.until = if result.interrupted { now } else { now + AFTER };
        }
    }

    fn begin(&mut self, joint: String, index: usize) -> Result<String, RecordError> {
        if let Some(one) = self.running.iter().find(|one| one.id.is_none()) {
            let joint = one.about.joint.clone();
            return Err(RecordError::Running { joint });
        }
        let snapshot = self.handle.snapshot();
        let name = shelf::name_of(&format!("{}-{joint}", snapshot.unix_time_s.round()));
        let about = About {
            joint,
            unix_time_s: snapshot.unix_time_s,
            ..About::default()
        };
        self.start(None, name.clone(), index, snapshot.time_s - BEFORE, about);
        Ok(name)
    }

    async fn end(&mut self) -> Result<String, RecordError> {
        let index = self.running.iter().position(|one| one.id.is_none());
        let running = self.running.remove(index.ok_or(RecordError::NotRunning)?);
        let name = running.name.clone();
        self.put(running).await;
        Ok(name)
    }

    fn lost(&mut self, batches: u64) {
        tracing::warn!(batches, "the recorder was too slow: batches are lost");
        let running = self.running.iter_mut();
        running.for_each(|one| one.about.batches_lost += batches);
    }

    async fn put(&self, mut running: Running) {
        let snapshot = self.handle.snapshot();
        let joint = snapshot
            .joints
            .iter()
            .find(|joint| joint.name == running.about.joint);
        running.about.mode = joint.and_then(|joint| joint.mode);
        running.about.payload_kg = snapshot.payload_kg;
        running.about.duration_s = running.log.duration();
        let epoch = self.epoch();
        // Before the file is made anew.
        running.journal = None;
        let Running {
            name, about, log, ..
        } = running;
        self.on_disk(move |shelf| {
            shelf.put(&name, &about, |folder| {
                log.recording(&name, about.payload_kg).write(folder, true)?;
                log.write_mcap(&folder.join(MCAP), &about.joint, epoch)
            })
        })
        .await;
    }

    /// The wall time at which the service's clock was 0, seconds since 1970.
    fn epoch(&self) -> f64 {
        let snapshot = self.handle.snapshot();
        snapshot.unix_time_s - snapshot.time_s
    }

    async fn tidy(&self) {
        self.on_disk(|shelf| shelf.tidy()).await;
    }

    /// Does what waits for the disk on a thread that may wait. What goes wrong is no reason to stop.
    async fn on_disk(&self, work: impl FnOnce(&Shelf) -> Result<(), ShelfError> + Send + 'static) {
        let shelf = Arc::clone(&self.shelf);
        match tokio::task::spawn_blocking(move || work(&shelf)).await {
            Ok(Ok(())) => {}
            Ok(Err(error)) => tracing::error!(%error, "a recording is not kept"),
            Err(error) => tracing::error!(%error, "the recorder's work on the disk failed"),
        }
    }
}

fn last_time(batch: &Batch) -> f64 {
    let last = batch.ticks.last();
    last.map_or(f64::NEG_INFINITY, |row| row.time)
}
