//! The same move unshaped, shaped by a wrong belief, and adaptive.

use quell_shapers::{Mode, Shaper, UncertainMode, Zvd};
use quell_trajectories::Limits;

use super::{Cell, CellSettings, ClosedLoopError, MoveTrace};
use crate::plant::{Robot, SimulationOptions};
use quell_control::controller::RetunePolicy;
use quell_control::estimators::{ESTIMATORS, EstimatorEntry};
use quell_control::tolerance::{Bounds, Moving, Tolerance, fastest};

/// One of the moves that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MoveKind {
    /// The unshaped plan.
    Unshaped,
    /// Shaped for the belief, which does not change.
    WrongBelief,
    /// Shaped for the belief, and corrected in motion once the mode is known.
    AdaptiveFirst,
    /// The next move of the same controller: back, with the learned mode.
    AdaptiveNext,
    /// The first move again, as fast as a tolerance allows with the learned modes.
    WithinTolerance,
}

impl MoveKind {
    /// All five, in the order in which they are made.
    pub const ALL: [Self; 5] = [
        Self::Unshaped,
        Self::WrongBelief,
        Self::AdaptiveFirst,
        Self::AdaptiveNext,
        Self::WithinTolerance,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unshaped => "unshaped",
            Self::WrongBelief => "wrong_belief",
            Self::AdaptiveFirst => "adaptive_first",
            Self::AdaptiveNext => "adaptive_next",
            Self::WithinTolerance => "within_tolerance",
        }
    }
}

/// A move to be compared, and the robot that makes it.
#[derive(Clone)]
pub struct Scenario {
    /// The robot.
    pub robot: Robot,
    /// Moved joint, counted from 0.
    pub joint: usize,
    /// Displacement of the move, rad.
    pub displacement: f64,
    /// Limits of the move.
    pub limits: Limits,
    /// How the arm is simulated.
    pub simulation: SimulationOptions,
    /// The engineer's believed mode.
    pub belief: Mode,
    /// The rule that designs trains.
    pub shaper: &'static dyn Shaper,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
}

/// The moves side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The first four of [`MoveKind::ALL`].
    made: [MoveTrace; 4],
    /// The move within a tolerance, if requested, and the bounds of its residual.
    within: Option<(MoveTrace, Bounds)>,
    /// The simulated arm's true mode.
    pub truth: Mode,
}

impl Comparison {
    /// Combines the moves of the three cells.
    pub fn new(
        unshaped: MoveTrace,
        wrong_belief: MoveTrace,
        (first, next, truth): (MoveTrace, MoveTrace, Mode),
    ) -> Self {
        Self {
            made: [unshaped, wrong_belief, first, next],
            within: None,
            truth,
        }
    }

    /// Adds the move within a tolerance.
    pub fn with_tolerance(self, within: (MoveTrace, Bounds)) -> Self {
        Self {
            within: Some(within),
            ..self
        }
    }

    /// The available moves, in the order of [`MoveKind::ALL`].
    pub fn moves(&self) -> impl Iterator<Item = (MoveKind, &MoveTrace)> {
        let within = self.within.iter().map(|(trace, _)| trace);
        MoveKind::ALL
            .into_iter()
            .zip(self.made.iter().chain(within))
    }

    /// The move of that kind; `None` for the one within a tolerance if it was not requested.
    pub fn trace(&self, kind: MoveKind) -> Option<&MoveTrace> {
        let mut moves = self.moves();
        moves.find(|one| one.0 == kind).map(|one| one.1)
    }

    /// The unshaped move.
    pub fn unshaped(&self) -> &MoveTrace {
        &self.made[0]
    }

    /// The one shaped for the belief.
    pub fn wrong_belief(&self) -> &MoveTrace {
        &self.made[1]
    }

    /// The adaptive one.
    pub fn adaptive_first(&self) -> &MoveTrace {
        &self.made[2]
    }

    /// The one after it, with the learned mode.
    pub fn adaptive_next(&self) -> &MoveTrace {
        &self.made[3]
    }

    /// Bounds of the residual of the move within a tolerance.
    pub fn bounds(&self) -> Option<Bounds> {
        self.within.as_ref().map(|(_, bounds)| *bounds)
    }

    /// Residual vibration of a move relative to that of the unshaped one; NaN if it was not made.
    pub fn ratio(&self, kind: MoveKind) -> f64 {
        self.of(kind, MoveTrace::residual) / self.unshaped().residual()
    }

    /// Additional duration of a command relative to the plan at the limits, s; NaN if it was not made.
    pub fn added_delay(&self, kind: MoveKind) -> f64 {
        match kind {
            // Its plan is longer, and has no train.
            MoveKind::WithinTolerance => {
                self.of(kind, |trace| trace.command_end) - self.unshaped().planned_end
            }
            _ => self.of(kind, MoveTrace::added_delay),
        }
    }

    /// As [`Comparison::ratio`] of the whole move, in cruise and at the end.
    pub fn whole_ratio(&self, kind: MoveKind) -> f64 {
        self.of(kind, MoveTrace::vibration) / self.unshaped().vibration()
    }

    fn of(&self, kind: MoveKind, what: impl Fn(&MoveTrace) -> f64) -> f64 {
        self.trace(kind).map_or(f64::NAN, what)
    }
}

impl Scenario {
    /// The robot's default move at the joint's own limits, with ZVD and the likelihood estimator.
    pub fn new(robot: Robot, belief: Mode) -> Self {
        let joint = robot.default_move.joint;
        Self {
            joint,
            displacement: robot.default_move.target,
            limits: robot.joints[joint].limits,
            simulation: SimulationOptions::default(),
            belief,
            shaper: &Zvd,
            estimator: &ESTIMATORS[0],
            robot,
        }
    }

    /// Makes the four moves, the three cells one after the other; for cells side by side see
    /// [`Scenario::unshaped`], [`Scenario::wrong_belief`] and [`Scenario::adaptive`].
    ///
    /// # Errors
    /// [`ClosedLoopError`] where the robot cannot be simulated or the move cannot be planned.
    pub fn run(&self) -> Result<Comparison, ClosedLoopError> {
        Ok(Comparison::new(
            self.unshaped()?,
            self.wrong_belief()?,
            self.adaptive()?,
        ))
    }

    /// The unshaped move.
    ///
    /// # Errors
    /// As [`Scenario::run`].
    pub fn unshaped(&self) -> Result<MoveTrace, ClosedLoopError> {
        let mut cell = Cell::new(&self.cell(None, false))?;
        cell.run_move(cell.position() + self.displacement)
    }

    /// Shaped for the belief, which does not change.
    ///
    /// # Errors
    /// As [`Scenario::run`].
    pub fn wrong_belief(&self) -> Result<MoveTrace, ClosedLoopError> {
        let mut cell = Cell::new(&self.cell(Some(self.shaper), false))?;
        cell.run_move(cell.position() + self.displacement)
    }

    /// Two moves of one adaptive controller, there and back, and the arm's true mode.
    ///
    /// # Errors
    /// As [`Scenario::run`].
    pub fn adaptive(&self) -> Result<(MoveTrace, MoveTrace, Mode), ClosedLoopError> {
        let mut cell = Cell::new(&self.cell(Some(self.shaper), true))?;
        let start = cell.position();
        let first = cell.run_move(start + self.displacement)?;
        let next = cell.run_move(start)?;
        Ok((first, next, cell.arm().true_mode().unwrap_or(self.belief)))
    }

    /// The fastest move within a tolerance for learned modes; its plan is sent unshaped.
    ///
    /// # Errors
    /// As [`Scenario::run`], and [`ClosedLoopError::Tolerance`] where no move is within the tolerance.
    pub fn within(
        &self,
        tolerance: Tolerance,
        modes: Vec<UncertainMode>,
    ) -> Result<(MoveTrace, Bounds), ClosedLoopError> {
        let mut cell = Cell::new(&self.cell(None, false))?;
        let start = cell.position();
        let moving = Moving {
            ends: [start, start + self.displacement],
            limits: self.limits,
            modes,
            lever: cell.arm().arc().radius(),
        };
        let found = fastest(&[moving], tolerance, 1.0 / self.robot.control_rate)?;
        let target = start + self.displacement;
        let trace = match found.plans.into_iter().next() {
            Some(plan) => cell.run_plan(plan, target)?,
            None => cell.run_move(target)?,
        };
        Ok((trace, found.bounds))
    }

    fn cell(&self, shaper: Option<&'static dyn Shaper>, adaptive: bool) -> CellSettings {
        CellSettings {
            robot: self.robot.clone(),
            joint: self.joint,
            displacement: self.displacement,
            simulation: self.simulation.clone(),
            limits: self.limits,
            shaper,
            belief: self.belief,
            adaptive,
            retune: RetunePolicy::InMotion,
            estimator: self.estimator,
        }
    }
}
