//! What runs at the tick: target to trajectory to shaper to setpoint, sample to estimate to train.
//!
//! [`Controller::tick`] composes everything. It does no I/O, does not allocate, block or fail; what
//! allocates (planning, building an axis) happens off the tick and is handed over.

mod adapting;
mod ahead;
mod axis;
mod change;
mod path;
mod settings;
mod slow_down;

pub use adapting::ringing_time;
pub use axis::{Axis, AxisStatus};
pub use path::PathPolicy;
pub use quell_shapers::Setpoint;
pub use settings::{AxisSettings, RetunePolicy, motion_limits};
pub use slow_down::{SlowedPlan, plan_shaped};

use quell_shapers::{Refusal, ShaperError};
use quell_trajectories::SampledTrajectory;

use self::ahead::Ahead;
use self::path::Lane;
use quell_signal::Measurement;

/// A measurement and the axis, counted from 0, that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisMeasurement {
    /// Axis, counted from 0.
    pub axis: usize,
    /// What was measured.
    pub measurement: Measurement,
}

/// A plan that the controller does not take, handed back with the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The plan has another number of axes than the controller.
    #[error("the plan moves {found} axes, the controller has {expected}")]
    Axes {
        /// Axes of the controller.
        expected: usize,
        /// Axes of the plan.
        found: usize,
    },
    /// The plan was sampled at another period than the control period.
    #[error("the plan is sampled every {found} s, the control period is {expected} s")]
    Period {
        /// Control period, s.
        expected: f64,
        /// Period of the plan, s.
        found: f64,
    },
    /// The plan does not begin where the axis stands or moves now.
    #[error("axis {axis}: the plan begins at {found} rad, the command is at {expected} rad")]
    Start {
        /// Axis, counted from 0.
        axis: usize,
        /// Present planned position, rad.
        expected: f64,
        /// First position of the plan, rad.
        found: f64,
    },
    /// The plan does not begin with the motion that the axis is in.
    #[error(
        "axis {axis}: the plan begins with a {quantity} of {found}, the command has {expected}"
    )]
    Motion {
        /// Axis, counted from 0.
        axis: usize,
        /// Velocity (rad/s) or acceleration (rad/s^2).
        quantity: &'static str,
        /// The present planned one.
        expected: f64,
        /// The plan's first one.
        found: f64,
    },
    /// A correction is under way, and with the plan the command would exceed the limits: try again
    /// at the next tick, or plan with lower limits.
    #[error("axis {axis}: a correction is under way: {reason}")]
    Correction {
        /// Axis, counted from 0.
        axis: usize,
        /// Why it cannot go on with the plan.
        reason: Refusal,
    },
}

/// The controller of one or more axes.
pub struct Controller {
    sample_time: f64,
    axes: Vec<Axis>,
    planned: Vec<Setpoint>,
    setpoints: Vec<Setpoint>,
    plan: Option<SampledTrajectory>,
    cursor: usize,
    /// Ticks for which every command has stood still.
    rested: usize,
}

impl Controller {
    /// A controller of axes at rest at the given positions (rad), one for each of `settings`;
    /// allocates all that it will ever need. The control period is that of the first axis.
    ///
    /// # Errors
    /// [`ShaperError`] where a belief cannot be shaped for at the control rate, or where the path
    /// shall be kept by axes of different control periods.
    pub fn new(
        settings: Vec<AxisSettings>,
        positions: &[f64],
        path: PathPolicy,
    ) -> Result<Self, ShaperError> {
        let sample_time = settings.first().map_or(1.0, |axis| axis.sample_time);
        let start = |axis: usize| positions.get(axis).copied().unwrap_or(0.0);
        let rest: Vec<_> = (0..settings.len())
            .map(|i| Setpoint::at_rest(start(i)))
            .collect();
        let mut axes = settings
            .into_iter()
            .enumerate()
            .map(|(index, settings)| Axis::new(settings, start(index)))
            .collect::<Result<Vec<_>, _>>()?;
        if path == PathPolicy::Kept {
            keep_path(&mut axes, start)?;
        }
        Ok(Self {
            sample_time,
            axes,
            planned: rest.clone(),
            setpoints: rest,
            plan: None,
            cursor: 0,
            rested: 0,
        })
    }

    /// Takes a plan that begins at the present planned state, and gives the last one back, to be
    /// dropped off the tick. No allocation.
    ///
    /// In motion, as for a new target or a stop, the plan begins at [`Controller::planned`], which was
    /// sent with the last tick, and the next tick sends the plan's second sample. A correction that is
    /// under way is made anew, for the new plan.
    ///
    /// # Errors
    /// The plan itself with a [`LoadError`]; nothing has changed then.
    pub fn load(
        &mut self,
        plan: SampledTrajectory,
    ) -> Result<Option<SampledTrajectory>, (SampledTrajectory, LoadError)> {
        if let Err(error) = self.check(&plan) {
            return Err((plan, error));
        }
        // From rest the first sample is sent too: the same position for a tick more.
        let cursor = usize::from(self.is_moving());
        if let Err((axis, reason)) = self.prepare(&plan, cursor) {
            return Err((plan, LoadError::Correction { axis, reason }));
        }
        self.axes.iter_mut().for_each(Axis::take_new_plan);
        if self.is_settled() {
            self.axes.iter_mut().for_each(Axis::begin_move);
        }
        self.cursor = cursor;
        Ok(self.plan.replace(plan))
    }

    /// Looks for corrections that go on with a plan, for all axes, before any is taken.
    fn prepare(&mut self, plan: &SampledTrajectory, cursor: usize) -> Result<(), (usize, Refusal)> {
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let ahead = Ahead::new(Some(plan), index, cursor, self.planned[index]);
            axis.prepare(&ahead).map_err(|refusal| (index, refusal))?;
        }
        Ok(())
    }

    /// One control period: takes what was measured since the last tick, returns one setpoint an
    /// axis. Measurements of axes that do not exist are ignored.
    ///
    /// Does not allocate, block, print or fail. Cost: most often below a microsecond an axis; a retune
    /// in motion once costs in proportion to the length of the move.
    pub fn tick(&mut self, measurements: &[AxisMeasurement]) -> &[Setpoint] {
        self.observe(measurements);
        self.exchange_trains();
        for (index, axis) in self.axes.iter_mut().enumerate() {
            let ahead = Ahead::new(self.plan.as_ref(), index, self.cursor, self.planned[index]);
            self.planned[index] = ahead.setpoint(0);
            self.setpoints[index] = axis.step(&ahead);
        }
        self.cursor = self.cursor.saturating_add(1);
        &self.setpoints
    }

    /// Takes what was measured, where that and the control periods do not come one by one. The next
    /// [`Controller::tick`] adapts to it. Does not allocate, block, print or fail.
    pub fn observe(&mut self, measurements: &[AxisMeasurement]) {
        for measured in measurements {
            if let Some(axis) = self.axes.get_mut(measured.axis) {
                axis.observe(measured.measurement);
            }
        }
    }

    /// Puts trains that wait in force, with the same tick on all axes that keep a path.
    fn exchange_trains(&mut self) {
        self.rested = match self.is_settled() {
            true => self.rested.saturating_add(1),
            false => 0,
        };
        for index in 0..self.axes.len() {
            let lane = self.axes[index].lane.as_mut();
            if let Some(train) = lane.and_then(|lane| lane.take_waiting(self.rested)) {
                for lane in self.axes.iter_mut().filter_map(|axis| axis.lane.as_mut()) {
                    lane.install(index, &train);
                }
            }
        }
    }

    /// The axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The planned, unshaped state of each axis at the last tick.
    pub fn planned(&self) -> &[Setpoint] {
        &self.planned
    }

    /// Whether a plan is in motion: a new one then begins with the sample after its first.
    pub fn is_moving(&self) -> bool {
        let moves = |planned: &Setpoint| planned.velocity != 0.0 || planned.acceleration != 0.0;
        self.planned.iter().any(moves)
    }

    /// Control period, s.
    pub fn sample_time(&self) -> f64 {
        self.sample_time
    }

    /// Whether the plan has ended and every command stands still.
    pub fn is_settled(&self) -> bool {
        let ended = self
            .plan
            .as_ref()
            .is_none_or(|plan| self.cursor >= plan.samples());
        ended && self.axes.iter().all(Axis::is_settled)
    }

    fn check(&self, plan: &SampledTrajectory) -> Result<(), LoadError> {
        let (expected, found) = (self.axes.len(), plan.degrees_of_freedom());
        if expected != found {
            return Err(LoadError::Axes { expected, found });
        }
        let (expected, found) = (self.sample_time, plan.period());
        if expected != found {
            return Err(LoadError::Period { expected, found });
        }
        for (axis, planned) in self.planned.iter().enumerate() {
            check_start(axis, planned, plan)?;
        }
        Ok(())
    }
}

/// Gives every axis the trains of all.
fn keep_path(axes: &mut [Axis], start: impl Fn(usize) -> f64) -> Result<(), ShaperError> {
    let trains: Vec<_> = axes.iter().map(|axis| axis.next_train().clone()).collect();
    let capacities: Vec<_> = axes.iter().map(|axis| axis.filter.capacity()).collect();
    for (index, axis) in axes.iter_mut().enumerate() {
        let lane = Lane::new(index, start(index), &trains, &capacities)?;
        axis.enter(lane)?;
    }
    Ok(())
}

fn check_start(axis: usize, planned: &Setpoint, plan: &SampledTrajectory) -> Result<(), LoadError> {
    let Some(first) = plan.state(axis, 0) else {
        return Ok(());
    };
    let (expected, found) = (planned.position, first.position);
    if (expected - found).abs() > START_TOLERANCE {
        return Err(LoadError::Start {
            axis,
            expected,
            found,
        });
    }
    let motion = [
        ("velocity", planned.velocity, first.velocity),
        ("acceleration", planned.acceleration, first.acceleration),
    ];
    for (quantity, expected, found) in motion {
        if (expected - found).abs() > START_TOLERANCE * (1.0 + expected.abs()) {
            return Err(LoadError::Motion {
                axis,
                quantity,
                expected,
                found,
            });
        }
    }
    Ok(())
}

/// How far a plan may begin from the present planned position, rad: the planner's own end is exact,
/// so only the rounding of a position handed through a file or a message is left.
const START_TOLERANCE: f64 = 1e-9;
