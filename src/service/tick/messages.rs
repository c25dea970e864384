//! The messages on the rings between the tick and the engine. What allocated comes back to be dropped.

use quell_shapers::{
    GridTrain, ImpulseTrain, RetuneOutcome, Setpoint, Shaper, ShaperError, UncertainMode,
};
use quell_trajectories::SampledTrajectory;

use super::gate::Trip;
use crate::controller::{AxisStatus, Controller, Lent, LoadError};
use crate::estimators::Sample;
use crate::learning::Hold;
use crate::plant::Load;
use crate::service::contract::{LinkHealth, Measured, TickRow, TickStatistics, WatchdogState};
use crate::service::guard::GuardReport;
use crate::signal::DeformationSensor;

/// Engine to tick. Joints are counted from 0.
pub enum ToTick {
    /// Begin to command a joint.
    Begin(usize, Box<Controller>),
    /// Cease to command a joint.
    Cease(usize),
    /// Take a plan.
    Plan(Box<Plan>),
    /// Give the plan of this ticket back, if it still waits.
    Withdraw(usize, u64),
    /// A joint that was not heard stands where it was left.
    Resume(usize),
    /// Moves of this permit may begin; given when so many faults were known.
    Enable {
        /// The permit.
        permit: u64,
        /// Faults known.
        trips: u64,
    },
    /// No move may begin.
    Disable,
    /// What the monitors have seen so far is forgotten: somebody has seen to it.
    Forget,
    /// Take a train, once the joint rests.
    Train(Box<TrainOrder>),
    /// Go over to another train in motion: first lend a copy of the filter, then go on with it.
    Retune(Box<RetuneOrder>),
    /// Whether the train of a joint follows the estimate.
    Adaptive(usize, bool),
    /// Take a sensor that is registered.
    Sensor(usize, Box<DeformationSensor>),
    /// Take a payload up.
    Carry(Load),
}

/// A train that a joint shall take.
pub struct TrainOrder {
    /// The joint.
    pub joint: usize,
    /// The train.
    pub train: Train,
}

/// A train that a joint shall go over to while a plan runs.
pub struct RetuneOrder {
    /// The joint.
    pub joint: usize,
    /// Number of the plan for whose way it was solved.
    pub ticket: u64,
    /// The train.
    pub train: Train,
    /// The modes on that way, 1 to 3, as well as they are known.
    pub modes: Vec<UncertainMode>,
    /// The copy of the filter, in which the engine searches for the correction.
    pub lent: Option<Box<Lent>>,
    /// Number of the tick that came next when it was lent.
    pub tick: u64,
}

/// A plan and when it begins. Once it is taken it carries the one before it back.
pub struct Plan {
    /// The joint.
    pub joint: usize,
    /// Number of the move.
    pub id: u64,
    /// Number of this very plan: events say by it what they are about.
    pub ticket: u64,
    /// The plan at the control period.
    pub samples: Option<SampledTrajectory>,
    /// When it begins.
    pub start: Start,
    /// The plans that it begins with, at rest; none where it begins alone.
    pub together: Option<Together>,
    /// The permit under which it was asked for; none for one that brings the joint to rest, which needs none.
    pub permit: Option<u64>,
}

/// Plans of several joints that begin with one tick, or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Together {
    /// Number of their common move.
    pub id: u64,
    /// How many they are.
    pub size: usize,
}

/// When a plan begins.
pub enum Start {
    /// As soon as the joint rests, with this train in force.
    Rest(Box<Train>),
    /// In motion, with exactly this tick.
    Tick(u64),
}

/// A train and what it is for.
#[derive(Clone)]
pub struct Train {
    /// The rule that designed it.
    pub shaper: Option<&'static dyn Shaper>,
    /// The mode that it is for, as well as it is known.
    pub known: UncertainMode,
    /// The train.
    pub train: GridTrain,
    /// Changes of the train by an estimate when it was designed: with more by now it is out of date.
    pub retunes: u32,
    /// Why it is not to be followed in motion, if it is not.
    pub hold: Option<Hold>,
}

/// Why a plan was not taken.
#[derive(Clone, Debug, PartialEq)]
pub enum NotTaken {
    /// The joint is not commanded.
    Idle,
    /// The tick with which it should have begun was over.
    Late,
    /// An estimate has changed the train since.
    Outdated,
    /// The train does not fit.
    Train(ShaperError),
    /// The controller refused it.
    Refused(LoadError),
    /// Another plan came before this one could begin.
    Replaced,
    /// The engine took it back before it could begin.
    Withdrawn,
    /// It leads somewhere, and its permit is over.
    NotEnabled,
}

/// Tick to engine, for the stream.
#[derive(Clone, Copy)]
pub enum Record {
    /// A joint at a tick.
    Tick(TickRow),
    /// A measurement.
    Measured(Measured),
    /// A sample of a joint's deformation, in or after the move of this number.
    Heard(usize, u64, Sample),
}

/// Tick to engine: what happened.
pub enum Event {
    /// A plan was taken. What it carries now is the plan before it.
    Taken(Taken),
    /// A plan was not taken, and why; nothing has changed.
    NotTaken(Box<Plan>, NotTaken),
    /// The command of a joint stands still after the move of this number, since this time (s).
    Settled(usize, u64, f64),
    /// The tick has closed the gate: no move begins until the engine opens it again.
    Tripped(Trip),
    /// A joint that is commanded is not heard any more.
    Lost(usize),
    /// A joint that was lost says again where its motor side stands, rad.
    Back(usize, f64),
    /// The copy of a filter for an order to retune; without one the order is over.
    Lent(Box<RetuneOrder>),
    /// A plan in motion was retuned, or not; nothing has changed then.
    Retuned(Box<RetuneOrder>, RetuneOutcome),
    /// A train was taken, or was out of date.
    Train(Box<TrainOrder>, Result<(), NotTaken>),
    /// To be dropped.
    Controller(Box<Controller>),
    /// To be dropped.
    Sensor(Box<DeformationSensor>),
}

/// A plan that was taken.
pub struct Taken {
    /// The plan, and in it the one before.
    pub plan: Box<Plan>,
    /// Tick with which it began.
    pub tick: u64,
    /// Its sample that was sent with this tick.
    pub first: usize,
    /// Time of this tick, s.
    pub time: f64,
}

/// Tick to engine, some 20 times a second: tick and link.
#[derive(Clone)]
pub struct WholeReport {
    /// Number of the next tick.
    pub tick: u64,
    /// Time of the last tick, s.
    pub time: f64,
    /// How well the tick is kept.
    pub statistics: TickStatistics,
    /// Counts of the link's messages.
    pub link: LinkHealth,
}

/// Tick to engine, some 20 times a second: one joint.
#[derive(Clone)]
pub struct JointReport {
    /// The joint.
    pub joint: usize,
    /// Command and belief; absent while the joint is not commanded.
    pub axis: Option<AxisReport>,
    /// The watchdog.
    pub watchdog: WatchdogState,
    /// The findings of the sensors' guard.
    pub guard: GuardReport,
    /// Distance of the motor side from what was commanded in the time in which it follows, rad.
    pub following_error: f64,
}

/// Command and belief of a joint.
#[derive(Clone)]
pub struct AxisReport {
    /// The state of the axis: its belief, its train, its counts.
    pub status: AxisStatus,
    /// The train in force.
    pub train: ImpulseTrain,
    /// Plan and command of the last tick.
    pub planned: Setpoint,
    /// Plan and command of the last tick.
    pub sent: Setpoint,
    /// Whether the command stands still.
    pub settled: bool,
    /// Whether the adaptation waits.
    pub frozen: bool,
}
