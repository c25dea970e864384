//! One joint in the engine: its requests, its motion, its learned modes.

use quell_shapers::{Mode, Setpoint, Shaper, UncertainMode};
use quell_trajectories::SampledTrajectory;
use tokio::sync::oneshot;

use super::hold::Jog;
use super::learned::Learning;
use super::pacing::Change;
use super::registration::Registrar;
use super::running::Running;
use super::standstill::Standstill;
use crate::service::config::JointConfig;
use crate::service::contract::{Accepted, Phase, ServiceError, WatchdogState};
use crate::service::following::FOLLOWED;
use crate::service::tick::{AxisReport, JointReport, Together, Train};
use crate::signal::DeformationSensor;

/// The channel for the answer to a request, if a client waits for it.
pub type Reply = oneshot::Sender<Result<Accepted, ServiceError>>;

/// A joint.
pub struct Joint {
    /// Its configuration.
    pub config: JointConfig,
    /// Computes the deformation from its measurements; with an arc where lengths are known.
    pub sensor: DeformationSensor,
    /// The rule that designs trains, while shaping is on.
    pub shaper: &'static dyn Shaper,
    /// Whether plans are shaped.
    pub shaping: bool,
    /// Whether the train follows the estimate.
    pub adaptation: bool,
    /// The mode that is shaped for.
    pub mode: Mode,
    /// A requested mode that the tick has not taken yet.
    pub wanted_mode: Option<Mode>,
    /// Time of the last change of the mode, seconds since 1970.
    pub mode_since: f64,
    /// Whether the train in force is to be replaced.
    pub train_due: bool,
    /// Until when an unshaped move rings, s. A train that takes over before that would cancel its vibration, by a motion
    /// that nobody has asked for.
    pub rings_until: f64,
    /// Number of changes of the train by an estimate that the present controller has reported.
    pub retunes: u32,
    /// The number of the controllers before, of corrections, and of refused corrections.
    pub before: [u64; 3],
    /// The last report of the tick.
    pub report: Option<JointReport>,
    /// Last reported plan and command, of whichever controller.
    pub commanded: Option<[Setpoint; 2]>,
    /// Position of the command at rest, rad.
    pub position: f64,
    /// Whether the tick commands the joint.
    pub began: bool,
    /// Whether the tick receives its measurements.
    pub hearing: Hearing,
    /// Whether it is to stop and the tick has not taken a plan for that yet.
    pub stop_due: bool,
    /// The running move, or one whose vibration decays.
    pub running: Option<Running>,
    /// The order that has not begun yet.
    pub asked: Option<Asked>,
    /// The last hold that jogged it.
    pub jog: Option<Jog>,
    /// Plans that the tick has not answered yet. It may have begun any of them.
    pub ordered: Vec<Ordered>,
    /// A change of its move's rate that the tick has not answered.
    pub change: Option<Change>,
    /// Whether its motor side stands still, while it is not commanded.
    pub standstill: Standstill,
    /// Last measured motor position, rad.
    pub motor: Option<f64>,
    /// Knowledge from its moves.
    pub learning: Learning,
    /// Registers the tip's sensor, as long as its frame is not known.
    pub registrar: Option<Registrar>,
}

/// Whether the tick receives measurements of a joint that it commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hearing {
    /// It does, or need not.
    Heard,
    /// It does not.
    Lost,
    /// It does again, but whether the joint stands where it was left is not known yet.
    Back,
}

/// An order to a joint, until the tick has begun it.
pub struct Asked {
    /// Its kind.
    pub what: What,
    /// Number of the move.
    pub id: u64,
    /// Number of its present plan.
    pub ticket: u64,
    /// Number of ticks ahead for which it was planned, in motion.
    pub ahead: u64,
    /// The plans of other joints that it begins with.
    pub together: Option<Together>,
    /// Share of the acceleration and jerk limits that it uses, in motion.
    pub effort: f64,
    /// Time (s) after which it is given up.
    pub deadline: f64,
    /// Whether it must be planned again, because the tick did not take it.
    pub again: bool,
    /// The client that waits.
    pub reply: Option<Reply>,
}

impl Asked {
    /// Whether nobody waits any more for a move that has not begun.
    pub fn is_abandoned(&self) -> bool {
        let gone = self.reply.as_ref().is_some_and(Reply::is_closed);
        gone && matches!(self.what, What::Move { .. })
    }
}

/// A plan that the tick has not answered yet.
pub struct Ordered {
    /// Number of the plan.
    pub ticket: u64,
    /// Its purpose.
    pub what: What,
    /// Number of the move.
    pub id: u64,
    /// A copy of the plan.
    pub samples: SampledTrajectory,
    /// Speed to which it was slowed, 1 for full speed.
    pub speed: f64,
    /// The feed at which it was made, 0 to 1.
    pub feed: f64,
    /// The rule of its train.
    pub shaper: Option<&'static dyn Shaper>,
    /// The plans of other joints that it begins with.
    pub together: Option<Together>,
    /// The client of a request that was withdrawn in the meantime.
    pub withdrawn: Option<Withdrawn>,
}

/// The client of a withdrawn request. The answer depends on the tick, which may have begun it already.
pub struct Withdrawn {
    /// Where the answer goes.
    pub reply: Reply,
    /// The answer if its plan was not begun.
    pub why: ServiceError,
    /// Latest time of the answer, s.
    pub until: f64,
}

/// The purpose of a plan.
#[derive(Clone, Copy)]
pub enum What {
    /// A target, rad, and the rule for this move alone.
    Move {
        target: f64,
        shaper: Option<Option<&'static dyn Shaper>>,
        /// Largest speed of the plan, rad/s; infinite where only the limits bound it.
        speed: f64,
        /// Whether it is as fast as a tolerance allows.
        within: bool,
    },
    /// A stop.
    Stop,
}

impl Joint {
    /// The rule of the next train.
    pub fn standing_shaper(&self) -> Option<&'static dyn Shaper> {
        self.shaping.then_some(self.shaper)
    }

    /// The mode of the next train, with its uncertainty: that of when it was learned, if it was.
    pub fn known(&self) -> UncertainMode {
        let mode = self.wanted_mode.unwrap_or(self.mode);
        let shaped_for = self.axis().map(|axis| axis.status.shaped_for);
        let learned = shaped_for.filter(|known| known.mode == mode);
        learned.unwrap_or_else(|| UncertainMode::believed(mode))
    }

    /// The train that was last solved from its moves, if this rule still uses it.
    pub fn solved_train(&self, shaper: Option<&'static dyn Shaper>) -> Option<&Train> {
        let solved = self.learning.solved.as_ref()?;
        let same = name_of(solved.shaper) == name_of(shaper) && solved.retunes == self.retunes;
        (same && self.adaptation && self.wanted_mode.is_none()).then_some(solved)
    }

    /// Its controller, as last reported.
    pub fn axis(&self) -> Option<&AxisReport> {
        self.report.as_ref()?.axis.as_ref()
    }

    /// Whether the command stands still.
    pub fn is_at_rest(&self) -> bool {
        self.running
            .as_ref()
            .is_none_or(|move_| move_.settled.is_some())
    }

    /// Whether the command has stood still at `now` (s) for as long as the motor side takes to follow.
    pub fn has_followed(&self, now: f64) -> bool {
        let settled = self.running.as_ref().map(|running| running.settled);
        settled.is_none_or(|since| since.is_some_and(|since| now - since > FOLLOWED))
    }

    /// Whether it accepts a move.
    ///
    /// # Errors
    /// [`ServiceError::NoMeasurement`] before it is commanded, [`ServiceError::NotHeard`] while measurements
    /// are missing, [`ServiceError::Stopped`] until the tick has begun a stop.
    pub fn takes_moves(&self) -> Result<(), ServiceError> {
        let joint = || self.config.name.clone();
        match self.hearing {
            _ if !self.began => Err(ServiceError::NoMeasurement { joint: joint() }),
            Hearing::Lost | Hearing::Back => Err(ServiceError::NotHeard { joint: joint() }),
            Hearing::Heard if self.stop_due => Err(ServiceError::Stopped),
            Hearing::Heard => Ok(()),
        }
    }

    /// The plan under way for this order.
    pub fn ordered_for(&self, asked: &Asked) -> Option<&Ordered> {
        let mut ordered = self.ordered.iter();
        ordered.find(|ordered| ordered.ticket == asked.ticket)
    }

    /// The joint's phase.
    pub fn phase(&self) -> Phase {
        match &self.running {
            _ if !self.began => Phase::Waiting,
            _ if self.stop_due => Phase::Stopping,
            Some(running) if running.settled.is_none() && running.stopping => Phase::Stopping,
            Some(running) if running.settled.is_none() => Phase::Moving,
            _ => Phase::Rest,
        }
    }

    /// Whether it is commanded but not measured.
    pub fn is_unheard(&self) -> bool {
        self.began && self.hearing != Hearing::Heard
    }

    /// The state of the watchdog.
    pub fn watchdog(&self) -> WatchdogState {
        match &self.report {
            _ if self.is_unheard() => WatchdogState::Stopped,
            Some(report) => report.watchdog,
            None => WatchdogState::Silent,
        }
    }
}

/// Name of a rule, `none` for no shaping.
pub fn name_of(shaper: Option<&'static dyn Shaper>) -> &'static str {
    shaper.map_or("none", |shaper| shaper.name())
}
