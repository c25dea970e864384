//! The controller at the tick: target to trajectory to shaper to setpoint, sample to estimate to train.
//!
//! [`Controller::tick`] runs all of it for one axis. It does no I/O, does not allocate, block or fail. Work
//! that allocates (planning, building an axis) happens off the tick, and its result is handed over. Several
//! axes are several controllers; [`KeptPath`] lets them keep a path in space.

mod adapting;
mod ahead;
mod axis;
mod change;
mod corrected;
mod foresight;
mod path;
mod settings;
mod slow_down;

pub use adapting::ringing_time;
pub use ahead::setpoint;
pub use axis::{Axis, AxisStatus};
pub use foresight::Lent;
pub use path::KeptPath;
pub use quell_shapers::{RetuneOutcome, Setpoint};
pub use settings::{AxisSettings, RetunePolicy, motion_limits};
pub use slow_down::{SlowedPlan, plan_shaped, plan_shaped_by, shaped_peaks};

use quell_shapers::{Refusal, ShaperError};
use quell_trajectories::SampledTrajectory;

use self::ahead::Ahead;
use quell_signal::Measurement;

/// A plan that the controller does not take, handed back with the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// The plan does not move one axis.
    #[error("the plan moves {0} axes; a controller takes a plan of one")]
    Axes(usize),
    /// The plan was sampled at another period than the control period.
    #[error("the plan is sampled every {found} s, the control period is {expected} s")]
    Period {
        /// Control period, s.
        expected: f64,
        /// Period of the plan, s.
        found: f64,
    },
    /// The plan does not begin where the axis stands or moves now.
    #[error("the plan begins at {found} rad, the command is at {expected} rad")]
    Start {
        /// Present planned position, rad.
        expected: f64,
        /// First position of the plan, rad.
        found: f64,
    },
    /// The plan does not begin with the motion that the axis is in.
    #[error("the plan begins with a {quantity} of {found}, the command has {expected}")]
    Motion {
        /// Velocity (rad/s) or acceleration (rad/s^2).
        quantity: &'static str,
        /// The present planned one.
        expected: f64,
        /// The plan's first one.
        found: f64,
    },
    /// A correction is under way, and with the plan the command would exceed the limits. Try again at the next
    /// tick, or plan with lower limits.
    #[error("a correction is under way: {0}")]
    Correction(Refusal),
}

/// The controller of one axis.
pub struct Controller {
    axis: Axis,
    planned: Setpoint,
    plan: Option<SampledTrajectory>,
    cursor: usize,
    /// Copy for a search beside the tick; `None` while it is lent.
    spare: Option<Box<Lent>>,
}

impl Controller {
    /// A controller of an axis at rest at `position` (rad); allocates all its memory.
    ///
    /// # Errors
    /// [`ShaperError`] where the belief cannot be shaped for at the control rate.
    pub fn new(settings: AxisSettings, position: f64) -> Result<Self, ShaperError> {
        Ok(Self {
            axis: Axis::new(settings, position)?,
            planned: Setpoint::at_rest(position),
            plan: None,
            cursor: 0,
            spare: None,
        })
    }

    /// Takes a plan of one axis that begins at the present planned state, and gives the last one back,
    /// to be dropped off the tick. No allocation.
    ///
    /// In motion, for example for a new target or a stop, the plan begins at [`Controller::planned`], which was
    /// sent with the last tick. The next tick sends the plan's second sample. A correction under way is
    /// computed again for the new plan.
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
        // From rest the first sample is sent, too: the same position for one more tick.
        let cursor = usize::from(self.is_moving());
        let ahead = Ahead::new(Some(&plan), cursor, self.planned);
        if let Err(reason) = self.axis.follow(&ahead) {
            return Err((plan, LoadError::Correction(reason)));
        }
        if self.is_settled() {
            self.axis.begin_from_rest();
        }
        self.cursor = cursor;
        self.axis.changes += 1;
        Ok(self.plan.replace(plan))
    }

    /// From now on no correction sends a position outside of this range, rad, in which the plans stay. No allocation.
    pub fn keep_within(&mut self, range: [f64; 2]) {
        self.axis.filter.keep_within(range);
    }

    /// One control period: takes what was measured since the last tick, returns the setpoint.
    ///
    /// Does not allocate, block, print or fail. Cost: most often below a microsecond; a retune
    /// in motion once costs in proportion to the length of the move.
    pub fn tick(&mut self, measurements: &[Measurement]) -> Setpoint {
        self.observe(measurements);
        let ahead = Ahead::new(self.plan.as_ref(), self.cursor, self.planned);
        self.planned = ahead.setpoint(0);
        let setpoint = self.axis.step(&ahead);
        self.cursor = self.cursor.saturating_add(1);
        setpoint
    }

    /// Takes measurements, for callers in which these and the control periods do not alternate. The next
    /// [`Controller::tick`] adapts to them. Does not allocate, block, print or fail.
    pub fn observe(&mut self, measurements: &[Measurement]) {
        for &measurement in measurements {
            self.axis.observe(measurement);
        }
    }

    /// The axis: its belief, its trains, its counts.
    pub fn axis(&self) -> &Axis {
        &self.axis
    }

    /// The planned, unshaped state at the last tick.
    pub fn planned(&self) -> Setpoint {
        self.planned
    }

    /// Whether a plan is in motion: a new one then begins with the sample after its first.
    pub fn is_moving(&self) -> bool {
        self.planned.velocity != 0.0 || self.planned.acceleration != 0.0
    }

    /// Control period, s.
    pub fn sample_time(&self) -> f64 {
        self.axis.settings.sample_time
    }

    /// Whether the plan has ended and the command stands still.
    pub fn is_settled(&self) -> bool {
        let plan = self.plan.as_ref();
        plan.is_none_or(|plan| self.cursor >= plan.samples()) && self.axis.is_settled()
    }

    fn check(&self, plan: &SampledTrajectory) -> Result<(), LoadError> {
        if plan.degrees_of_freedom() != 1 {
            return Err(LoadError::Axes(plan.degrees_of_freedom()));
        }
        let (expected, found) = (self.sample_time(), plan.period());
        if expected != found {
            return Err(LoadError::Period { expected, found });
        }
        check_start(&self.planned, plan)
    }
}

fn check_start(planned: &Setpoint, plan: &SampledTrajectory) -> Result<(), LoadError> {
    let Some(first) = plan.state(0, 0) else {
        return Ok(());
    };
    let (expected, found) = (planned.position, first.position);
    if (expected - found).abs() > START_TOLERANCE {
        return Err(LoadError::Start { expected, found });
    }
    let motion = [
        ("velocity", planned.velocity, first.velocity),
        ("acceleration", planned.acceleration, first.acceleration),
    ];
    for (quantity, expected, found) in motion {
        if (expected - found).abs() > START_TOLERANCE * (1.0 + expected.abs()) {
            return Err(LoadError::Motion {
                quantity,
                expected,
                found,
            });
        }
    }
    Ok(())
}

/// Largest distance of a plan's start from the present planned position, rad. The planner's own end is exact,
/// so only the rounding of a position in a file or a message is allowed for.
const START_TOLERANCE: f64 = 1e-9;
