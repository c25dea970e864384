//! The messages on the rings between the tick and the engine. Allocated content is returned to be dropped.

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
    /// Stop commanding a joint.
    Cease(usize),
    /// Take a plan.
    Plan(Box<Plan>),
    /// Return the plan of this ticket, if it still waits.
    Withdraw(usize, u64),
    /// A joint stands where it was left before the silence.
    Resume(usize),
    /// Moves of this permit may begin; it was given when `trips` faults were known.
    Enable {
        /// The permit.
        permit: u64,
        /// Faults known.
        trips: u64,
    },
    /// No move may begin.
    Disable,
    /// Discard the state of the monitors after a reset.
    Forget,
    /// Take a train, once the joint rests.
    Train(Box<TrainOrder>),
    /// Go over to another train in motion: first lend a copy of the filter, then continue with it.
    Retune(Box<RetuneOrder>),
    /// Whether the train of a joint follows the estimate.
    Adaptive(usize, bool),
    /// Take a sensor that is registered.
    Sensor(usize, Box<DeformationSensor>),
    /// Change the payload.
    Carry(Load),
}

/// A train that a joint is to use.
pub struct TrainOrder {
    /// The joint.
    pub joint: usize,
    /// The train.
    pub train: Train,
}

/// A train that a joint is to use while a plan runs.
pub struct RetuneOrder {
    /// The joint.
    pub joint: usize,
    /// Number of the plan for whose way it was solved.
    pub ticket: u64,
    /// The train.
    pub train: Train,
    /// The modes on that way, 1 to 3, with their uncertainties.
    pub modes: Vec<UncertainMode>,
    /// The copy of the filter, in which the engine searches for the correction.
    pub lent: Option<Box<Lent>>,
    /// Number of the next tick when it was lent.
    pub tick: u64,
}

/// A plan with its start. Once it is taken, it carries the plan before it back.
pub struct Plan {
    /// The joint.
    pub joint: usize,
    /// Number of the move.
    pub id: u64,
    /// Number of this plan, to which events refer.
    pub ticket: u64,
    /// The plan at the control period.
    pub samples: Option<SampledTrajectory>,
    /// Time of its start.
    pub start: Start,
    /// The plans with which it begins, at rest; `None` if it begins alone.
    pub together: Option<Together>,
    /// The permit of its request; `None` for a plan that brings the joint to rest.
    pub permit: Option<u64>,
}

/// Plans of several joints that begin with one tick, or not at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Together {
    /// Number of their common move.
    pub id: u64,
    /// Number of plans.
    pub size: usize,
}

/// Start of a plan.
pub enum Start {
    /// As soon as the joint rests, with this train in force.
    Rest(Box<Train>),
    /// In motion, exactly at this tick.
    Tick(u64),
}

/// A train with its origin.
#[derive(Clone)]
pub struct Train {
    /// The rule that designed it.
    pub shaper: Option<&'static dyn Shaper>,
    /// The mode of its design, with its uncertainty.
    pub known: UncertainMode,
    /// The train.
    pub train: GridTrain,
    /// Number of changes of the train by an estimate at its design; if there are more by now, it is outdated.
    pub retunes: u32,
    /// Why it is not to be adapted in motion, if so.
    pub hold: Option<Hold>,
}

/// Why a plan was not taken.
#[derive(Clone, Debug, PartialEq)]
pub enum NotTaken {
    /// The joint is not commanded.
    Idle,
    /// Its starting tick was over.
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
    /// It is a move, and its permit is no longer valid.
    NotEnabled,
}

/// Tick to engine, for the stream.
#[derive(Clone, Copy)]
pub enum Record {
    /// A joint at a tick, and the number of the next one.
    Tick(TickRow, u64),
    /// A measurement.
    Measured(Measured),
    /// A sample of a joint's deformation, in or after the move of this number.
    Heard(usize, u64, Sample),
}

/// Tick to engine: events.
pub enum Event {
    /// A plan was taken. It now contains the plan before it.
    Taken(Taken),
    /// A plan was not taken, for this reason; nothing has changed.
    NotTaken(Box<Plan>, NotTaken),
    /// The command of a joint stands still after the move of this number, since this time (s).
    Settled(usize, u64, f64),
    /// The tick has closed the gate: no move begins until the engine opens it again.
    Tripped(Trip),
    /// A command would have led beyond the range of this joint: it brakes, and obeys no plan until it is commanded anew.
    Left(usize),
    /// A commanded joint has fallen silent.
    Lost(usize),
    /// A lost joint reports its motor side again, at this position, rad.
    Back(usize, f64),
    /// The copy of a filter for a retune; without one the order is over.
    Lent(Box<RetuneOrder>),
    /// The outcome of a retune in motion; on a refusal nothing has changed.
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
    /// The plan, which contains the one before.
    pub plan: Box<Plan>,
    /// Tick with which it began.
    pub tick: u64,
    /// The sample of it that was sent with this tick.
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
    /// State of the sensors' guard.
    pub guard: GuardReport,
    /// Following error of the motor side beyond its lag, rad.
    pub following_error: f64,
}

/// Command and belief of a joint.
#[derive(Clone)]
pub struct AxisReport {
    /// The state of the axis: estimate, train, counts.
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
