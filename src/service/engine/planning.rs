//! From an order to a plan for the tick.

use quell_shapers::{Shaper, shaper_by_name};
use quell_trajectories::{Limits, Planner, SampledTrajectory};

use super::axis::train;
use super::in_motion::{Moment, in_motion};
use super::joint::{Joint, What};
use super::running::ROUNDING;
use crate::controller::plan_shaped;
use crate::service::contract::ServiceError;
use crate::service::tick::{Start, Train};

/// A plan with its start.
pub struct Planned {
    /// The plan at the control period.
    pub samples: SampledTrajectory,
    /// Time of its start.
    pub start: Start,
    /// Speed to which it was slowed, 1 for full speed.
    pub speed: f64,
    /// The rule of its train.
    pub shaper: Option<&'static dyn Shaper>,
}

/// Plans for a joint; in motion the plan begins at the moment `at`.
pub fn plan(
    joint: &Joint,
    what: What,
    planner: &Planner,
    period: f64,
    at: Moment,
) -> Result<Planned, ServiceError> {
    match (&joint.running, what) {
        (Some(running), _) if !joint.is_at_rest() => {
            let range = joint.config.range;
            let samples = in_motion(running, what, (planner, period), range, at);
            Ok(Planned {
                samples: samples.map_err(refused)?,
                start: Start::Tick(at.tick),
                speed: 1.0,
                shaper: shaper_by_name(&running.start.shaper),
            })
        }
        (_, What::Move { target, shaper, .. }) => from_rest(
            joint,
            (target, at.fed),
            shaper.unwrap_or(joint.standing_shaper()),
            planner,
            period,
        ),
        (_, What::Stop) => {
            let here = (joint.position, at.fed);
            from_rest(joint, here, joint.standing_shaper(), planner, period)
        }
    }
}

/// The train of a joint for its mode.
pub fn standing_train(
    joint: &Joint,
    shaper: Option<&'static dyn Shaper>,
    period: f64,
) -> Result<Train, ServiceError> {
    if let Some(solved) = joint.solved_train(shaper) {
        return Ok(solved.clone());
    }
    let known = joint.known();
    let designed = train(shaper, &known, period).map_err(|error| ServiceError::Train {
        reason: error.to_string(),
    })?;
    Ok(Train {
        shaper,
        known,
        train: designed,
        retunes: joint.retunes,
        hold: None,
    })
}

fn from_rest(
    joint: &Joint,
    (target, limits): (f64, Limits),
    shaper: Option<&'static dyn Shaper>,
    planner: &Planner,
    period: f64,
) -> Result<Planned, ServiceError> {
    let train = standing_train(joint, shaper, period)?;
    let ends = [joint.position, target];
    let slowed = plan_shaped(planner, ends, limits, &train.train).map_err(refused)?;
    if slowed.peaks.worst() > 1.0 + ROUNDING {
        let reason = format!(
            "shaped by {} it reaches {:.2} times a limit, even at {:.0} % speed",
            super::joint::name_of(shaper),
            slowed.peaks.worst(),
            100.0 * slowed.speed
        );
        return Err(ServiceError::Plan { reason });
    }
    Ok(Planned {
        samples: slowed.plan,
        start: Start::Rest(Box::new(train)),
        speed: slowed.speed,
        shaper,
    })
}

pub fn refused(error: quell_trajectories::PlanError) -> ServiceError {
    ServiceError::Plan {
        reason: error.to_string(),
    }
}
