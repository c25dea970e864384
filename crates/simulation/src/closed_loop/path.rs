//! A move of several joints on a straight path in joint space, with a train for each joint and with one for all.

use quell_shapers::{Mode, Shaper, UncertainMode};
use quell_trajectories::Limits;

use super::side_by_side::Cells;
use super::{CellSettings, ClosedLoopError, PathTrace};
use crate::plant::{Robot, SimulationOptions};
use quell_control::controller::RetunePolicy;
use quell_control::estimators::EstimatorEntry;
use quell_control::tolerance::{Bounds, Moving, Tolerance, fastest};

/// Number of poses on the way at which the distance of the tip from an axis is computed.
const LOOKS: usize = 32;

/// One of the moves on a path that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathKind {
    /// The unshaped plan.
    Unshaped,
    /// Each joint has a train of its own, for the belief until the mode is known.
    OwnTrainsFirst,
    /// The next move of the same controllers: back, with the learned modes.
    OwnTrainsNext,
    /// Each joint has the trains of all, for the beliefs: new trains wait for rest.
    CommonTrainFirst,
    /// The next move of the same controllers: back, with the learned modes.
    CommonTrainNext,
    /// The first move again, as fast as a tolerance allows with the learned modes.
    WithinTolerance,
}

impl PathKind {
    /// All six, in the order of reports.
    pub const ALL: [Self; 6] = [
        Self::Unshaped,
        Self::OwnTrainsFirst,
        Self::OwnTrainsNext,
        Self::CommonTrainFirst,
        Self::CommonTrainNext,
        Self::WithinTolerance,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unshaped => "unshaped",
            Self::OwnTrainsFirst => "own_trains_first",
            Self::OwnTrainsNext => "own_trains_next",
            Self::CommonTrainFirst => "common_train_first",
            Self::CommonTrainNext => "common_train_next",
            Self::WithinTolerance => "within_tolerance",
        }
    }
}

/// A joint that moves on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathJoint {
    /// The joint, counted from 0.
    pub joint: usize,
    /// Its displacement, rad, not 0.
    pub displacement: f64,
    /// Its limits.
    pub limits: Limits,
    /// The believed mode; `None` for a stiff joint, which has no train of its own.
    pub belief: Option<Mode>,
}

/// A move on a path, and the robot that makes it.
#[derive(Clone)]
pub struct PathScenario {
    /// The robot.
    pub robot: Robot,
    /// The joints that move, at least one of them with a mode.
    pub joints: Vec<PathJoint>,
    /// How the arms are simulated.
    pub simulation: SimulationOptions,
    /// The rule that designs trains.
    pub shaper: &'static dyn Shaper,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
}

/// The moves side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct PathComparison {
    /// The moves, in the order of [`PathKind::ALL`]; the last one where it was asked for.
    pub moves: Vec<(PathKind, PathTrace)>,
    /// Bounds of the residual of the move within a tolerance.
    pub bounds: Option<Bounds>,
}

impl PathComparison {
    /// Combines the moves of the three sets of cells.
    pub fn new(unshaped: PathTrace, own: [PathTrace; 2], common: [PathTrace; 2]) -> Self {
        let traces = [unshaped].into_iter().chain(own).chain(common);
        Self {
            moves: PathKind::ALL.into_iter().zip(traces).collect(),
            bounds: None,
        }
    }

    /// Adds the move within a tolerance.
    pub fn with_tolerance(mut self, (trace, bounds): (PathTrace, Bounds)) -> Self {
        self.moves.push((PathKind::WithinTolerance, trace));
        self.bounds = Some(bounds);
        self
    }

    /// Additional duration of the command relative to the plan at the limits, s.
    pub fn added_delay(&self, kind: PathKind) -> f64 {
        let trace = self.trace(kind);
        match kind {
            // Its plan is longer, and has no train.
            PathKind::WithinTolerance => {
                trace.command_end() - self.trace(PathKind::Unshaped).command_end()
            }
            _ => trace.added_delay(),
        }
    }

    /// The move of that kind; the last one only where it was added.
    pub fn trace(&self, kind: PathKind) -> &PathTrace {
        &self.moves[kind as usize].1
    }

    /// Residual vibration of a joint, by its index in the scenario, relative to that of its unshaped move; NaN
    /// for a stiff joint.
    pub fn ratio(&self, kind: PathKind, joint: usize) -> f64 {
        let of = |kind| self.trace(kind).joints[joint].residual();
        of(kind) / of(PathKind::Unshaped)
    }
}

impl PathScenario {
    /// The unshaped move.
    ///
    /// # Errors
    /// [`ClosedLoopError`] where the robot cannot be simulated or the move cannot be planned.
    pub fn unshaped(&self) -> Result<PathTrace, ClosedLoopError> {
        let mut cells = Cells::new(&self.cells(false), false)?;
        let targets = self.targets(&cells.positions());
        cells.run_move(&targets, self.limits())
    }

    /// There and back, with a train of its own for every joint.
    ///
    /// # Errors
    /// As [`PathScenario::unshaped`].
    pub fn own_trains(&self) -> Result<[PathTrace; 2], ClosedLoopError> {
        self.there_and_back(Cells::new(&self.cells(true), false)?)
    }

    /// There and back, with the trains of all for every joint.
    ///
    /// # Errors
    /// As [`PathScenario::unshaped`].
    pub fn common_train(&self) -> Result<[PathTrace; 2], ClosedLoopError> {
        self.there_and_back(Cells::new(&self.cells(true), true)?)
    }

    /// The fastest move within a tolerance for the learned modes of each joint; its plans are sent unshaped.
    ///
    /// # Errors
    /// As [`PathScenario::unshaped`], and [`ClosedLoopError::Tolerance`] where no move is within the tolerance.
    pub fn within(
        &self,
        tolerance: Tolerance,
        modes: &[Vec<UncertainMode>],
    ) -> Result<(PathTrace, Bounds), ClosedLoopError> {
        let mut cells = Cells::new(&self.cells(false), false)?;
        let start = cells.positions();
        let each = self.joints.iter().zip(&start).zip(modes);
        let moving = each.map(|((joint, from), modes)| {
            let ends = [*from, from + joint.displacement];
            Ok(Moving {
                ends,
                limits: joint.limits,
                modes: modes.clone(),
                lever: self.lever(joint.joint)?,
            })
        });
        let moving = moving.collect::<Result<Vec<_>, ClosedLoopError>>()?;
        let found = fastest(&moving, tolerance, 1.0 / self.robot.control_rate)?;
        let trace = cells.run_plans(found.plans, &self.targets(&start))?;
        Ok((trace, found.bounds))
    }

    /// The largest distance of the tip from a joint's axis on the straight line, m.
    fn lever(&self, joint: usize) -> Result<f64, ClosedLoopError> {
        let home: Vec<f64> = self.robot.joints.iter().map(|joint| joint.home).collect();
        let mut most: f64 = 0.0;
        for k in 0..=LOOKS {
            let mut pose = home.clone();
            for moved in &self.joints {
                pose[moved.joint] += moved.displacement * k as f64 / LOOKS as f64;
            }
            most = most.max(self.robot.chain.arc(&pose, joint)?.radius());
        }
        Ok(most)
    }

    fn there_and_back(&self, mut cells: Cells) -> Result<[PathTrace; 2], ClosedLoopError> {
        let start = cells.positions();
        let there = cells.run_move(&self.targets(&start), self.limits())?;
        Ok([there, cells.run_move(&start, self.limits())?])
    }

    fn targets(&self, start: &[f64]) -> Vec<f64> {
        let ends = start.iter().zip(&self.joints);
        ends.map(|(start, joint)| start + joint.displacement)
            .collect()
    }

    /// Limits of the path parameter: those of the most restrictive joint. A joint that moves by `d` while the
    /// parameter goes from 0 to 1 has `|d|` times its velocity, acceleration and jerk.
    fn limits(&self) -> Limits {
        let least = |of: fn(&Limits) -> f64| {
            let each = self
                .joints
                .iter()
                .map(|one| of(&one.limits) / one.displacement.abs());
            each.fold(f64::INFINITY, f64::min)
        };
        Limits {
            velocity: least(|limits| limits.velocity),
            acceleration: least(|limits| limits.acceleration),
            jerk: least(|limits| limits.jerk),
        }
    }

    fn cells(&self, shaped: bool) -> Vec<CellSettings> {
        // A stiff joint is observed as long as one with a mode.
        let any = self.joints.iter().find_map(|joint| joint.belief);
        let cell = |(index, joint): (u64, &PathJoint)| {
            let shaped = shaped && joint.belief.is_some();
            Some(CellSettings {
                robot: self.robot.clone(),
                joint: joint.joint,
                displacement: joint.displacement,
                simulation: SimulationOptions {
                    seed: self.simulation.seed.wrapping_add(index),
                    ..self.simulation.clone()
                },
                limits: joint.limits,
                shaper: shaped.then_some(self.shaper),
                belief: joint.belief.or(any)?,
                adaptive: shaped,
                retune: RetunePolicy::InMotion,
                estimator: self.estimator,
            })
        };
        (0..).zip(&self.joints).filter_map(cell).collect()
    }
}
