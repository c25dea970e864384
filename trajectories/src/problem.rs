//! A checked problem in Ruckig's form, and its answer.

use ruckig::{ControlInterface, InputParameter, Synchronization};

use crate::closed_form::Known;
use crate::read_back::{Scale, read_back};
use crate::solver::Solver;
use crate::{AxisProfile, AxisState, Limits, PlanError, Trajectory};

/// Ruckig refuses longer moves of several axes (`calculator_target.hpp`); of one axis, too, here.
const LONGEST_MOVE: f64 = 7.6e3;

/// Twice what Ruckig itself accepts as the error of a profile's end (`profile.hpp`: 1e-8 in
/// position and velocity, 1e-10 in acceleration), to leave room for the sum over its phases.
pub(crate) const END_TOLERANCES: [(&str, f64); 3] = [
    ("position", 2e-8),
    ("velocity", 2e-8),
    ("acceleration", 2e-10),
];

/// Positions, velocities and accelerations of all axes, as Ruckig's binding tells them.
type States = (Vec<f64>, Vec<f64>, Vec<f64>);

/// Share of the duration at which all axes are seen: most of them cruise then.
const SEEN_AT: f64 = 0.5;

/// A checked problem: one entry for each axis in each list.
pub(crate) struct Problem<'a> {
    pub(crate) from: &'a [AxisState],
    pub(crate) to: &'a [AxisState],
    pub(crate) limits: &'a [Limits],
    pub(crate) interface: ControlInterface,
}

impl Problem<'_> {
    pub(crate) fn solve(&self) -> Result<Trajectory, PlanError> {
        Solver::kept(self.from.len(), |solver| self.solve_by(solver))
    }

    fn solve_by(&self, solver: &mut Solver) -> Result<Trajectory, PlanError> {
        self.set(&mut solver.input);
        let result = solver.solve();
        if result != ruckig::Result::Working {
            return Err(self.failure(result));
        }
        let duration = solver.solution.get_duration();
        if !(0.0..=LONGEST_MOVE).contains(&duration) {
            return Err(PlanError::TooLong {
                duration,
                limit: LONGEST_MOVE,
            });
        }
        let time = SEEN_AT * duration;
        let states = solver.solution.at_time(time);
        let mut axes = Vec::with_capacity(self.from.len());
        for index in 0..self.from.len() {
            let seen = (time, self.state(index, &states));
            axes.push(self.profile(index, &solver.solution, seen)?);
        }
        Ok(Trajectory { axes, duration })
    }

    /// The profile of an axis: in closed form if that is what was seen of it, else recovered from many states.
    fn profile(
        &self,
        index: usize,
        solution: &ruckig::Trajectory,
        seen: (f64, AxisState),
    ) -> Result<AxisProfile, PlanError> {
        let duration = solution.get_duration();
        let scale = self.scale(index, duration);
        let (from, to, limits) = (self.from[index], self.to[index], self.limits[index]);
        let known = Known {
            from,
            to,
            limits,
            scale,
            seen,
        };
        let closed = match self.interface {
            ControlInterface::Position => known.profile(),
            ControlInterface::Velocity => known.stop(),
        };
        if let Some(profile) = closed {
            return Ok(profile);
        }
        let state_at = |time| self.state(index, &solution.at_time(time));
        let end = self.end(index, state_at(duration))?;
        Ok(read_back(state_at, scale, (from, end)))
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
                    axis: index,
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
                axis: self.first_unsolvable_axis(),
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

    /// Sets Ruckig's input. Positions count from the start of each axis: its tolerances are absolute,
    /// and a move does not depend on where it begins.
    fn set(&self, input: &mut InputParameter) {
        input.control_interface = self.interface;
        input.synchronization = Synchronization::Time;
        let axes = self.from.iter().zip(self.to).zip(self.limits);
        for (i, ((from, to), limits)) in axes.enumerate() {
            input.current_velocity[i] = from.velocity;
            input.current_acceleration[i] = from.acceleration;
            input.target_position[i] = to.position - from.position;
            input.target_velocity[i] = to.velocity;
            input.target_acceleration[i] = to.acceleration;
            input.max_velocity[i] = limits.velocity;
            input.max_acceleration[i] = limits.acceleration;
            input.max_jerk[i] = limits.jerk;
        }
    }

    /// The state of one axis among Ruckig's positions, velocities and accelerations.
    fn state(&self, index: usize, (positions, velocities, accelerations): &States) -> AxisState {
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
            let problem = Problem {
                from: &self.from[one.clone()],
                to: &self.to[one.clone()],
                limits: &self.limits[one],
                interface: self.interface,
            };
            let mut solver = Solver::new(1);
            problem.set(&mut solver.input);
            solver.solve() != ruckig::Result::Working
        };
        (0..self.from.len()).find(fails).unwrap_or(0)
    }
}
