//! The same move unshaped, shaped by a wrong belief, and adaptive.

use quell_shapers::{Mode, Shaper};
use quell_trajectories::Limits;

use super::{Cell, CellSettings, ClosedLoopError, MoveTrace};
use crate::controller::Retune;
use crate::estimators::EstimatorEntry;
use crate::plant::{Robot, SimulationOptions};

/// One of the four moves that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MoveKind {
    /// The plan as it is.
    Unshaped,
    /// Shaped for the belief, which stays.
    WrongBelief,
    /// Shaped for the belief, and corrected in motion once the mode is known.
    AdaptiveFirst,
    /// The next move of the same controller: back, with what it has learned.
    AdaptiveNext,
}

impl MoveKind {
    /// All four, in the order in which they are made.
    pub const ALL: [Self; 4] = [
        Self::Unshaped,
        Self::WrongBelief,
        Self::AdaptiveFirst,
        Self::AdaptiveNext,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unshaped => "unshaped",
            Self::WrongBelief => "wrong_belief",
            Self::AdaptiveFirst => "adaptive_first",
            Self::AdaptiveNext => "adaptive_next",
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
    /// What the engineer believes of the mode.
    pub belief: Mode,
    /// The rule that designs trains.
    pub shaper: &'static dyn Shaper,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
}

/// The four moves side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The moves, in the order of [`MoveKind::ALL`].
    pub moves: Vec<(MoveKind, MoveTrace)>,
    /// The simulated arm's true mode.
    pub truth: Mode,
}

impl Scenario {
    /// Makes the four moves.
    ///
    /// # Errors
    /// [`ClosedLoopError`] where the robot cannot be simulated or the move cannot be planned.
    pub fn run(&self) -> Result<Comparison, ClosedLoopError> {
        let mut moves = Vec::with_capacity(MoveKind::ALL.len());
        let mut unshaped = Cell::new(&self.cell(None, false))?;
        let start = unshaped.arm().true_motor_position();
        let target = start + self.displacement;
        moves.push((MoveKind::Unshaped, unshaped.run_move(target)?));
        let mut wrong = Cell::new(&self.cell(Some(self.shaper), false))?;
        moves.push((MoveKind::WrongBelief, wrong.run_move(target)?));
        let mut adaptive = Cell::new(&self.cell(Some(self.shaper), true))?;
        moves.push((MoveKind::AdaptiveFirst, adaptive.run_move(target)?));
        moves.push((MoveKind::AdaptiveNext, adaptive.run_move(start)?));
        let truth = adaptive.arm().true_mode().unwrap_or(self.belief);
        Ok(Comparison { moves, truth })
    }

    fn cell(&self, shaper: Option<&'static dyn Shaper>, adaptive: bool) -> CellSettings {
        CellSettings {
            robot: self.robot.clone(),
            joint: self.joint,
            simulation: self.simulation.clone(),
            limits: self.limits,
            shaper,
            belief: self.belief,
            adaptive,
            retune: Retune::InMotion,
            estimator: self.estimator,
        }
    }
}
