//! Slower moves for trains with negative impulses, which can exceed limits that the plan keeps.

use quell_shapers::{GridTrain, PeakRatios, ShapingFilter, peak_ratios};
use quell_trajectories::{AxisState, Limits, PlanError, Planner, SampledTrajectory};

use super::ahead::setpoint;
use super::settings::motion_limits;

/// Rounding of velocities and accelerations by the planner and of differences over one tick.
const ROUNDING: f64 = 1e-9;
/// Most slower plans that are tried. Each is stretched by the excess of the last one, and a plan at lower
/// limits is nearly a stretched plan, so that the second try is almost right.
const ATTEMPTS: usize = 8;

/// A plan whose shaped command keeps the limits.
#[derive(Clone, Debug, PartialEq)]
pub struct SlowedPlan {
    /// The plan at the control period, not yet shaped.
    pub plan: SampledTrajectory,
    /// Speed of the plan, 1 for full speed: limits are scaled by it, its square and its cube.
    pub speed: f64,
    /// Peaks of the shaped command over the limits.
    pub peaks: PeakRatios,
}

impl SlowedPlan {
    /// A plan that keeps the limits as it is.
    pub fn at_full_speed(plan: SampledTrajectory) -> Self {
        Self {
            plan,
            speed: 1.0,
            peaks: PeakRatios::default(),
        }
    }
}

/// Plans a move of one axis from rest to rest and slows it down until `train` keeps the limits.
///
/// Trains of positive amplitudes keep them at full speed. Off the tick.
///
/// # Errors
/// [`PlanError`] where the move cannot be planned.
pub fn plan_shaped(
    planner: &Planner,
    [from, to]: [f64; 2],
    limits: Limits,
    train: &GridTrain,
) -> Result<SlowedPlan, PlanError> {
    let trains = core::slice::from_ref(train);
    plan_shaped_by(planner, [from, to], limits, (train.sample_time(), trains))
}

/// As [`plan_shaped`], at a control period (s), until each of several trains alone keeps the limits. It is for
/// axes on one path that each have their own train.
///
/// # Errors
/// [`PlanError`] where the move cannot be planned.
pub fn plan_shaped_by(
    planner: &Planner,
    [from, to]: [f64; 2],
    limits: Limits,
    (period, trains): (f64, &[GridTrain]),
) -> Result<SlowedPlan, PlanError> {
    let mut speed: f64 = 1.0;
    let mut attempt = 1;
    loop {
        let ends = [AxisState::at_rest(from), AxisState::at_rest(to)];
        let plan = planner
            .plan(&ends[..1], &ends[1..], &[limits.slowed(speed)])?
            .sample(period)?;
        let peaks = trains
            .iter()
            .map(|train| shaped_peaks(&plan, limits, train));
        let peaks = peaks.fold(PeakRatios::default(), worst_of);
        if peaks.worst() <= 1.0 + ROUNDING || attempt == ATTEMPTS {
            return Ok(SlowedPlan { plan, speed, peaks });
        }
        speed /= peaks.stretch();
        attempt += 1;
    }
}

fn worst_of(one: PeakRatios, other: PeakRatios) -> PeakRatios {
    PeakRatios {
        velocity: one.velocity.max(other.velocity),
        acceleration: one.acceleration.max(other.acceleration),
        jerk: one.jerk.max(other.jerk),
    }
}

/// The largest velocity, acceleration and jerk of the first axis of a plan from rest, shaped by a train, over limits.
pub fn shaped_peaks(plan: &SampledTrajectory, limits: Limits, train: &GridTrain) -> PeakRatios {
    let mut filter = ShapingFilter::new(train.sample_time(), train.duration_in_ticks());
    let start = plan.positions(0)[0];
    // The filter's capacity is the train's length, so that it cannot refuse the train.
    if filter.install(train).is_err() {
        return PeakRatios::default();
    }
    filter.reset(start);
    let command = (0..plan.samples() + train.duration_in_ticks()).map(|tick| {
        let planned = plan.state(0, tick).unwrap_or(AxisState::at_rest(start));
        filter.step(setpoint(planned))
    });
    peak_ratios(command, &motion_limits(limits), train.sample_time())
}
