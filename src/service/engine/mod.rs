//! The engine: all work beside the tick that has no hard deadline. One thread.
//!
//! It answers requests, plans, hands plans to the tick, handles the tick's answers, measures the residual of
//! each move, publishes state and stream, and has the state saved.

mod answers;
mod axis;
mod commanding;
mod cruise;
mod enabling;
mod extent;
mod feed;
mod hold;
mod in_motion;
mod jog;
mod joint;
mod judging;
mod learned;
mod learning;
mod on_line;
mod orders;
mod pacing;
mod planning;
mod publish;
mod pump;
mod recordings;
mod registration;
mod requests;
mod running;
mod shaping;
mod standstill;
mod together;
mod together_trains;
mod trains;
mod turns;
mod within;

use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::Sender;
use std::time::Duration;

use quell_trajectories::Planner;

pub use axis::{controller, longest_train};
pub use joint::{Hearing, Joint};
pub use learned::Learning;
pub use registration::Registrar;

use enabling::Enabling;
use judging::Ending;
use together::Group;
use together_trains::Waiting;

use super::bridged::bridged;
use super::clock::ServiceClock;
use super::config::Config;
use super::contract::{Batch, EngineEnds, MoveResult, ServiceError, Stopping};
use super::disk::Disk;
use super::learners::Lessons;
use super::state::State;
use super::tick::{EngineRings, WholeReport};
use crate::plant::ArmSimulation;

/// Interval at which the rings are emptied.
const PUMPED: Duration = Duration::from_millis(5);
/// Length of a batch of the stream, s.
const BATCH: f64 = 0.02;
/// Number of moves in the state.
const MOVES: usize = 64;
/// Longest wait for the joints to come to rest at the end of the service, s: the longest move with a
/// correction, and its stop.
const ENDING: f64 = 30.0;
/// Time for which setpoints are still sent at rest, s, so that a lost one is replaced.
const REST: f64 = 0.1;

/// The engine.
pub struct Engine {
    config: Config,
    clock: ServiceClock,
    ends: EngineEnds,
    rings: EngineRings,
    planner: Planner,
    joints: Vec<Joint>,
    /// The embedded arm in its initial state, to compute the effect of a payload.
    arm: Option<ArmSimulation>,
    payload: Option<f64>,
    state: State,
    saver: Sender<State>,
    disk: Disk,
    whole: Option<WholeReport>,
    /// Number of the next tick after the last one that was heard of, and the time of that one, s.
    counted: (u64, f64),
    moves: VecDeque<MoveResult>,
    batch: Batch,
    batch_since: f64,
    tickets: u64,
    /// Number of the last request to stop.
    last_stop: Option<u64>,
    stopping: Option<f64>,
    enabling: Enabling,
    /// Moves of several joints that the tick has not begun yet.
    groups: Vec<Group>,
    /// Moves of several joints that wait for their trains.
    waiting: Vec<Waiting>,
    /// Share of full speed at which everything moves, 0 to 1.
    feed: f64,
    lessons: Lessons,
    /// Moves that have ended and are being judged.
    endings: Vec<Ending>,
}

/// The parts of an engine.
pub struct EngineParts {
    /// The configuration.
    pub config: Config,
    /// The clock of all threads.
    pub clock: ServiceClock,
    /// Its end of the channels to the outside.
    pub ends: EngineEnds,
    /// Its ends of the rings to the tick.
    pub rings: EngineRings,
    /// The joints.
    pub joints: Vec<Joint>,
    /// The embedded arm in its initial state.
    pub arm: Option<ArmSimulation>,
    /// The saved state.
    pub state: State,
    /// Channel to the keeper of states.
    pub saver: Sender<State>,
    /// The disk, whose health is published.
    pub disk: Disk,
    /// The planner, of one axis.
    pub planner: Planner,
    /// Its end of the channels to the learners.
    pub lessons: Lessons,
}

impl Engine {
    /// An engine whose joints are not commanded yet.
    pub fn new(parts: EngineParts) -> Self {
        let mut engine = Self {
            enabling: Enabling::at_start(parts.clock.unix_time()),
            payload: parts.arm.as_ref().map(|_| 0.0),
            moves: parts.state.moves.iter().cloned().collect(),
            config: parts.config,
            clock: parts.clock,
            ends: parts.ends,
            rings: parts.rings,
            planner: parts.planner,
            joints: parts.joints,
            arm: parts.arm,
            state: parts.state,
            saver: parts.saver,
            disk: parts.disk,
            whole: None,
            counted: (0, f64::NEG_INFINITY),
            batch: Batch::default(),
            batch_since: 0.0,
            tickets: 0,
            last_stop: None,
            stopping: None,
            groups: Vec::new(),
            waiting: Vec::new(),
            feed: 1.0,
            lessons: parts.lessons,
            endings: Vec::new(),
        };
        engine.show_remembered();
        engine.begin_embedded();
        engine
    }

    /// Does all pending work: one round of [`Engine::run`].
    pub fn work(&mut self) {
        self.pump();
        self.answer_all();
    }

    /// Answers pending requests.
    pub fn answer_all(&mut self) {
        while let Some(envelope) = self.ends.requests.try_recv() {
            self.answer(envelope);
        }
    }

    /// Works until `ending` is set, then brings every joint to rest.
    pub async fn run(mut self, ending: &AtomicBool) {
        let mut pump = tokio::time::interval(PUMPED);
        pump.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                biased;
                _ = pump.tick() => {
                    self.pump();
                    if ending.load(Relaxed) && self.has_ended() {
                        break;
                    }
                }
                envelope = self.ends.requests.recv() => match envelope {
                    Some(envelope) => self.answer(envelope),
                    // No client is left; the joints are still commanded.
                    None => tokio::time::sleep(PUMPED).await,
                },
            }
        }
        self.flush(self.clock.now());
        self.save();
    }

    /// Brings every joint to rest; returns whether all are.
    fn has_ended(&mut self) -> bool {
        let now = self.clock.now();
        let since = match self.stopping {
            Some(since) => since,
            None => {
                tracing::info!("stopping");
                self.stop_all(&ServiceError::Stopping);
                *self.stopping.insert(now)
            }
        };
        if now - since > ENDING {
            tracing::warn!("not every joint has come to rest within {ENDING} s");
            return true;
        }
        let rests = |joint: &Joint| {
            let settled = joint
                .running
                .as_ref()
                .is_none_or(|running| running.settled.is_some_and(|settled| now - settled > REST));
            settled && joint.asked.is_none() && joint.ordered.is_empty()
        };
        self.joints.iter().all(rests) && self.has_told_all()
    }

    /// Stops every moving joint, and returns them. A waiting move is answered with `why`.
    fn stop_all(&mut self, why: &ServiceError) -> Vec<Stopping> {
        self.drop_waiting(why);
        let all = 0..self.joints.len();
        all.filter_map(|index| self.stop(index, why.clone()))
            .collect()
    }

    /// Notes the number of the next tick after one at `time` (s).
    fn counts(&mut self, next: u64, time: f64) {
        if time >= self.counted.1 {
            self.counted = (next, time);
        }
    }

    /// Best guess of the next tick's number. After a longer silence than is bridged, the time that went by does not
    /// count: the command waits for the tick.
    fn next_tick(&self) -> u64 {
        let (next, time) = self.counted;
        let passed = (self.clock.now() - time) / self.config.period;
        let most = bridged(self.config.period);
        next.saturating_add((passed.max(0.0).ceil() as u64).min(most))
    }

    fn save(&mut self) {
        self.state.moves = self.moves.iter().cloned().collect();
        // The keeper's thread lives as long as the engine.
        let _ = self.saver.send(self.state.clone());
    }
}
