//! A move of several joints on a straight path in joint space, with a train for each joint and with one for all.

use quell_shapers::{Mode, Shaper};
use quell_trajectories::Limits;

use super::side_by_side::Cells;
use super::{CellSettings, ClosedLoopError, MoveTrace, Tick};
use crate::plant::{Robot, SimulationOptions};
use quell_control::controller::RetunePolicy;
use quell_control::estimators::EstimatorEntry;

/// One of the moves on a path that are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PathKind {
    /// The plan as it is.
    Unshaped,
    /// Each joint shaped by a train of its own, for the belief until the mode is known.
    OwnTrainsFirst,
    /// The next move of the same controllers: back, with what they have learned.
    OwnTrainsNext,
    /// Each joint shaped by the trains of all, for the beliefs: new trains wait for rest.
    CommonTrainFirst,
    /// The next move of the same controllers: back, with what they have learned.
    CommonTrainNext,
}

impl PathKind {
    /// All five, in the order in which they are told.
    pub const ALL: [Self; 5] = [
        Self::Unshaped,
        Self::OwnTrainsFirst,
        Self::OwnTrainsNext,
        Self::CommonTrainFirst,
        Self::CommonTrainNext,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Unshaped => "unshaped",
            Self::OwnTrainsFirst => "own_trains_first",
            Self::OwnTrainsNext => "own_trains_next",
            Self::CommonTrainFirst => "common_train_first",
            Self::CommonTrainNext => "common_train_next",
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
    /// The mode that is believed in; none for a stiff joint, which has no train of its own.
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

/// One move of all joints.
#[derive(Clone, Debug, PartialEq)]
pub struct PathTrace {
    /// Where the joints stood, rad.
    pub from: Vec<f64>,
    /// The move of each joint; all have the same ticks.
    pub joints: Vec<MoveTrace>,
}

impl PathTrace {
    /// Largest distance of the command from the straight line between start and target in joint space, rad.
    pub fn command_departure(&self) -> f64 {
        self.departure(|_, tick| tick.position)
    }

    /// Largest distance of the links, vibration included, from the same line, rad.
    pub fn link_departure(&self) -> f64 {
        self.departure(|joint, tick| {
            tick.motor_position + tick.tip_deformation / joint.arc.radius()
        })
    }

    /// Distance of the command from the line at every tick, rad.
    pub fn command_departures(&self) -> Vec<f64> {
        self.departures(|_, tick| tick.position)
    }

    /// Last change of any joint's command, s after the start.
    pub fn command_end(&self) -> f64 {
        let ends = self.joints.iter().map(|joint| joint.command_end);
        ends.fold(0.0, f64::max)
    }

    /// The delay that shaping and corrections added to the command, s.
    pub fn added_delay(&self) -> f64 {
        let planned = self.joints.iter().map(|joint| joint.planned_end);
        self.command_end() - planned.fold(0.0, f64::max)
    }

    fn departure(&self, of: impl Fn(&MoveTrace, &Tick) -> f64) -> f64 {
        self.departures(of).into_iter().fold(0.0, f64::max)
    }

    fn departures(&self, of: impl Fn(&MoveTrace, &Tick) -> f64) -> Vec<f64> {
        let ends = self.from.iter().zip(&self.joints);
        let line: Vec<f64> = ends.map(|(from, joint)| joint.target - from).collect();
        let length = dot(&line, &line);
        let count = self.joints.iter().map(|joint| joint.ticks.len()).min();
        let distance = |tick: usize| {
            let at = self.joints.iter().zip(&self.from);
            let at: Vec<f64> = at
                .map(|(joint, from)| of(joint, &joint.ticks[tick]) - from)
                .collect();
            let share = dot(&at, &line) / length;
            let beside = at.iter().zip(&line).map(|(at, line)| at - share * line);
            beside.map(|away| away * away).sum::<f64>().sqrt()
        };
        (0..count.unwrap_or(0)).map(distance).collect()
    }
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

/// The five moves side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct PathComparison {
    /// The moves, in the order of [`PathKind::ALL`].
    pub moves: Vec<(PathKind, PathTrace)>,
}

impl PathComparison {
    /// Puts the moves of the three sets of cells side by side.
    pub fn new(unshaped: PathTrace, own: [PathTrace; 2], common: [PathTrace; 2]) -> Self {
        let traces = [unshaped].into_iter().chain(own).chain(common);
        Self {
            moves: PathKind::ALL.into_iter().zip(traces).collect(),
        }
    }

    /// The move of that kind.
    pub fn trace(&self, kind: PathKind) -> &PathTrace {
        &self.moves[kind as usize].1
    }

    /// Residual vibration of a joint, by its place in the scenario, over that of its unshaped move; not a number for a
    /// stiff joint.
    pub fn ratio(&self, kind: PathKind, joint: usize) -> f64 {
        let of = |kind| self.trace(kind).joints[joint].residual();
        of(kind) / of(PathKind::Unshaped)
    }
}

impl PathScenario {
    /// The plan as it is.
    ///
    /// # Errors
    /// [`ClosedLoopError`] where the robot cannot be simulated or the move cannot be planned.
    pub fn unshaped(&self) -> Result<PathTrace, ClosedLoopError> {
        let mut cells = Cells::new(&self.cells(false), false)?;
        let targets = self.targets(&cells.positions());
        cells.run_move(&targets, self.limits())
    }

    /// There and back, every joint with a train of its own.
    ///
    /// # Errors
    /// As [`PathScenario::unshaped`].
    pub fn own_trains(&self) -> Result<[PathTrace; 2], ClosedLoopError> {
        self.there_and_back(Cells::new(&self.cells(true), false)?)
    }

    /// There and back, every joint with the trains of all.
    ///
    /// # Errors
    /// As [`PathScenario::unshaped`].
    pub fn common_train(&self) -> Result<[PathTrace; 2], ClosedLoopError> {
        self.there_and_back(Cells::new(&self.cells(true), true)?)
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

    /// Limits of the path parameter: those of the joint that they bind most. A joint that goes `d` while the parameter
    /// goes 1 has `|d|` times its velocity, acceleration and jerk.
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
        // A stiff joint is watched as long as one that rings.
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
