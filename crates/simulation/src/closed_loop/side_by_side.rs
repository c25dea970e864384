//! Cells of several joints that move together on a straight path in joint space.

use quell_control::controller::{Controller, KeptPath, SlowedPlan, plan_shaped_by};
use quell_shapers::{GridTrain, common_train};
use quell_trajectories::{Limits, Planner, SampledTrajectory};

use super::cell::within_limits;
use super::{Cell, CellSettings, ClosedLoopError, PathTrace};

/// Cells of several joints with one plan. The joints do not excite one another.
pub(super) struct Cells {
    cells: Vec<Cell>,
    planner: Planner,
    /// The kept path; `None` where each axis runs a train of its own.
    path: Option<KeptPath>,
}

impl Cells {
    /// Cells at rest. With `kept` every axis runs the trains of all, so that the command keeps the path.
    ///
    /// # Errors
    /// [`ClosedLoopError`] as for one cell.
    pub fn new(settings: &[CellSettings], kept: bool) -> Result<Self, ClosedLoopError> {
        let cells = settings.iter().map(Cell::new);
        let mut cells = cells.collect::<Result<Vec<_>, _>>()?;
        let path = match kept {
            true => Some(KeptPath::new(&mut controllers(&mut cells))?),
            false => None,
        };
        Ok(Self {
            cells,
            planner: Planner::new(1)?,
            path,
        })
    }

    /// Positions of the commands, rad.
    pub fn positions(&self) -> Vec<f64> {
        self.cells.iter().map(Cell::position).collect()
    }

    /// Moves every joint to its target (rad) on one path, and observes the arms until their vibration has
    /// decayed. `limits` are those of the path parameter, which goes from 0 to 1.
    ///
    /// # Errors
    /// [`ClosedLoopError`] as for one cell.
    pub fn run_move(
        &mut self,
        targets: &[f64],
        limits: Limits,
    ) -> Result<PathTrace, ClosedLoopError> {
        let from = self.positions();
        let slowed = self.plan(limits)?;
        let ends = from.iter().zip(targets);
        let plans = ends.map(|(from, to)| SlowedPlan {
            plan: slowed.plan.along(*from, to - from),
            ..slowed.clone()
        });
        self.run(plans.collect(), targets)
    }

    /// Sends given plans to the targets (rad).
    ///
    /// # Errors
    /// [`ClosedLoopError::Load`] where a controller refuses its plan.
    pub fn run_plans(
        &mut self,
        plans: Vec<SampledTrajectory>,
        targets: &[f64],
    ) -> Result<PathTrace, ClosedLoopError> {
        let plans = plans.into_iter().map(SlowedPlan::at_full_speed);
        self.run(plans.collect(), targets)
    }

    fn run(
        &mut self,
        plans: Vec<SlowedPlan>,
        targets: &[f64],
    ) -> Result<PathTrace, ClosedLoopError> {
        let from = self.positions();
        let mut running = Vec::with_capacity(self.cells.len());
        for ((cell, plan), to) in self.cells.iter_mut().zip(plans).zip(targets) {
            running.push(cell.begin(plan, *to)?);
        }
        while !self
            .cells
            .iter()
            .zip(&running)
            .all(|(cell, running)| cell.is_over(running))
        {
            if let Some(path) = &mut self.path {
                path.exchange_trains(&mut controllers(&mut self.cells));
            }
            for (cell, running) in self.cells.iter_mut().zip(&mut running) {
                cell.tick(running);
            }
        }
        let ended = self.cells.iter().zip(running);
        let mut joints: Vec<_> = ended.map(|(cell, running)| cell.end(running)).collect();
        if self.path.is_some() {
            let all = joints.iter().map(|joint| joint.longest_train).sum();
            joints
                .iter_mut()
                .for_each(|joint| joint.longest_train = all);
        }
        Ok(PathTrace { from, joints })
    }

    /// The path parameter over time, such that the command of every joint keeps its limits.
    fn plan(&self, limits: Limits) -> Result<SlowedPlan, ClosedLoopError> {
        let next = |cell: &Cell| cell.controller().axis().next_train().clone();
        let own: Vec<GridTrain> = self.cells.iter().map(next).collect();
        let trains = match self.path {
            Some(_) => vec![common_train(&own)?],
            None => own,
        };
        let period = self
            .cells
            .first()
            .map_or(1.0, |cell| cell.controller().sample_time());
        let slowed = plan_shaped_by(&self.planner, [0.0, 1.0], limits, (period, &trains))?;
        within_limits(slowed)
    }
}

fn controllers(cells: &mut [Cell]) -> Vec<&mut Controller> {
    cells.iter_mut().map(Cell::controller_mut).collect()
}
