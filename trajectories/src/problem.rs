//! A checked problem, as Ruckig takes it and answers it.

use ruckig::{ControlInterface, InputParameter, Ruckig, Synchronization};

use crate::profile::{Scale, read_back};
use crate::{AxisState, Limits, PlanError, Planner, Trajectory};

/// Ruckig refuses longer moves of several axes (`calculator_target.hpp`); of one axis, too, here.
const LONGEST_MOVE: f64 = 7.6e3;

/// Twice what Ruckig itself accepts as the error of a profile's end (`profile.hpp`: 1e-8 in
/// position and velocity, 1e-10 in acceleration), to leave room for the sum over its phases.
const END_TOLERANCES: [(&str, f64); 3] = [
    ("position", 2e-8),
    ("velocity", 2e-8),
    ("acceleration", 2e-10),
];

/// A checked problem: one entry for each axis in each list.
pub(crate) struct Problem<'a> {
    pub(crate) planner: &'a Planner,
    pub(crate) from: &'a [AxisState],
    pub(crate) to: &'a [AxisState],
    pub(crate) limits: &'a [Limits],
    pub(crate) interface: ControlInterface,
}

impl Problem<'_> {
    pub(crate) fn solve(&self) -> Result<Trajectory, PlanError> {
        let mut input = self.input();
        let mut solution = ruckig::Trajectory::new_direct(self.from.len());
        let mut solver = Ruckig::new_direct_and_offline(self.from.len());
        let result = solver.calculate(&mut input, &mut solution);
        if result != ruckig::Result::Working {
            return Err(self.failure(result));
        }
        let duration = solution.get_duration();
        if !(0.0..=LONGEST_MOVE).contains(&duration) {
            return Err(PlanError::TooLong {
                duration,
                limit: LONGEST_MOVE,
            });
        }
        let axes = (0..self.from.len())
            .map(|index| {
                let state_at = |time| self.state_at(&solution, index, time);
                let end = self.end(index, state_at(duration))?;
                let ends = (self.from[index], end);
                Ok(read_back(state_at, self.scale(index, duration), ends))
            })
            .collect::<Result<_, _>>()?;
        Ok(Trajectory { axes, duration })
    }

    /// The exact end of an axis, after a check that Ruckig's end is there.
    fn end(&self, index: usize, found: AxisState) -> Result<AxisState, PlanError> {
        let mut end = self.to[index];
        let largest = end.position.abs().max(self.from[index].position.abs());
        if self.interface == ControlInterface::Velocity {
            end.position = found.position;
        }
        let errors = [
            found.position - end.position,
            found.velocity - end.velocity,
            found.acceleration - end.acceleration,
        ];
        for ((what, tolerance), error) in END_TOLERANCES.into_iter().zip(errors) {
            let allowed = tolerance + 4.0 * f64::EPSILON * largest;
            if error.is_nan() || error.abs() > allowed {
                return Err(PlanError::Inexact {
                    axis: self.planner.label(index),
                    what,
                    error,
                });
            }
        }
        Ok(end)
    }

    fn failure(&self, result: ruckig::Result) -> PlanError {
        match result {
            ruckig::Result::ErrorExecutionTimeCalculation => PlanError::NoProfile {
                axis: self.planner.label(self.first_unsolvable_axis()),
            },
            ruckig::Result::ErrorSynchronizationCalculation => PlanError::NoCommonDuration {
                axes: self.from.len(),
            },
            ruckig::Result::ErrorTrajectoryDuration => PlanError::TooLong {
                duration: f64::NAN,
                limit: LONGEST_MOVE,
            },
            other => PlanError::Ruckig {
                code: format!("{other:?}"),
            },
        }
    }

    /// Ruckig's input. Positions count from the start of each axis: its tolerances are absolute,
    /// and a move does not depend on where it begins.
    fn input(&self) -> InputParameter {
        let per_axis = |pick: &dyn Fn(usize) -> f64| (0..self.from.len()).map(pick).collect();
        let mut input = InputParameter::new(self.from.len());
        input.control_interface = self.interface;
        input.synchronization = Synchronization::Time;
        input.current_velocity = per_axis(&|i| self.from[i].velocity);
        input.current_acceleration = per_axis(&|i| self.from[i].acceleration);
        input.target_position = per_axis(&|i| self.to[i].position - self.from[i].position);
        input.target_velocity = per_axis(&|i| self.to[i].velocity);
        input.target_acceleration = per_axis(&|i| self.to[i].acceleration);
        input.max_velocity = per_axis(&|i| self.limits[i].velocity);
        input.max_acceleration = per_axis(&|i| self.limits[i].acceleration);
        input.max_jerk = per_axis(&|i| self.limits[i].jerk);
        input
    }

    fn state_at(&self, solution: &ruckig::Trajectory, index: usize, time: f64) -> AxisState {
        let (positions, velocities, accelerations) = solution.at_time(time);
        AxisState {
            position: self.from[index].position + positions[index],
            velocity: velocities[index],
            acceleration: accelerations[index],
        }
    }

    fn scale(&self, index: usize, duration: f64) -> Scale {
        let (from, to, limit) = (self.from[index], self.to[index], self.limits[index]);
        Scale {
            duration,
            position: from.position.abs().max(to.position.abs()),
            velocity: from.velocity.abs().max(limit.velocity),
            acceleration: from.acceleration.abs().max(limit.acceleration),
            jerk: limit.jerk,
        }
    }

    /// Ruckig does not say which axis it could not solve: ask for each alone.
    fn first_unsolvable_axis(&self) -> usize {
        let fails = |&index: &usize| {
            let one = index..index + 1;
            let mut input = Problem {
                planner: self.planner,
                from: &self.from[one.clone()],
                to: &self.to[one.clone()],
                limits: &self.limits[one],
                interface: self.interface,
            }
            .input();
            let mut solution = ruckig::Trajectory::new_direct(1);
            let result = Ruckig::new_direct_and_offline(1).calculate(&mut input, &mut solution);
            result != ruckig::Result::Working
        };
        (0..self.from.len()).find(fails).unwrap_or(0)
    }
}
