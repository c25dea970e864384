//! Plans for a joint in motion: a new target, or a stop.
//!
//! A joint in motion has its whole limits to brake with, whatever the feed is. It goes to a new target as quickly
//! as these allow, but no faster than the feed, until the slower limits of the feed suffice: until a stop within
//! them would end before the target. From there on it moves as the feed says. So it never leaves the hull of its
//! shortest stop and its target. At full feed that is one plan, the quickest.
//!
//! A plan with less effort brakes later. Where it would leave the way that is allowed to it, it is made with the
//! whole effort.

use quell_trajectories::{AxisState, Limits, PlanError, Planner, SampledTrajectory};

use super::extent::{extent, stays};
use super::joint::What;
use super::running::{ROUNDING, Running};

/// Start and effort of a plan in motion.
#[derive(Clone, Copy)]
pub struct Moment {
    /// The tick at which it begins.
    pub tick: u64,
    /// Share of the acceleration and jerk limits that it uses.
    pub effort: f64,
    /// Limits of the joint.
    pub own: Limits,
    /// Those of the feed.
    pub fed: Limits,
}

/// A plan for a joint in motion that begins at the moment `at`. `range` is where its targets may be, rad.
pub fn in_motion(
    running: &Running,
    what: What,
    (planner, period): (&Planner, f64),
    range: [f64; 2],
    at: Moment,
) -> Result<SampledTrajectory, PlanError> {
    let from = running.state_before(at.tick);
    let planned = |effort: f64| match what {
        What::Stop => planner
            .plan_stop(&[from], &[with(at.own, effort)])?
            .sample(period),
        What::Move { target, .. } => {
            let limits = [with(at.own, effort), with(at.fed, effort)];
            turned(planner, period, [from, AxisState::at_rest(target)], limits)
        }
    };
    let plan = planned(at.effort)?;
    let way = match what {
        What::Stop => extent(running.positions_from(at.tick)),
        What::Move { .. } => range,
    };
    match at.effort < 1.0 && !stays(&plan, way) {
        true => planned(1.0),
        false => Ok(plan),
    }
}

/// From a motion to a target: within a joint's own limits, then within those of the feed.
fn turned(
    planner: &Planner,
    period: f64,
    [from, to]: [AxisState; 2],
    [own, fed]: [Limits; 2],
) -> Result<SampledTrajectory, PlanError> {
    let no_faster = Limits {
        velocity: fed.velocity,
        ..own
    };
    let quickest = planner.plan(&[from], &[to], &[no_faster])?.sample(period)?;
    if no_faster == fed {
        return Ok(quickest);
    }
    let mut states = (0..quickest.samples()).map_while(|tick| quickest.state(0, tick));
    let suffices = |state: AxisState| suffice(fed, state, to.position);
    let Some(tick) = states.position(suffices) else {
        return Ok(quickest);
    };
    let state = quickest.state(0, tick).unwrap_or(to);
    let rest = planner.plan(&[state], &[to], &[fed])?.sample(period)?;
    Ok(quickest.then(tick, &rest))
}

/// Whether limits suffice from a state: they are kept, and a stop ends between there and the target.
fn suffice(limits: Limits, state: AxisState, target: f64) -> bool {
    let way = target - state.position;
    let gone = (state.stops_at(limits) - state.position) * way.signum();
    let toward = state.velocity * way >= 0.0;
    state.keeps(limits) && toward && (-ROUNDING..=way.abs() + ROUNDING).contains(&gone)
}

fn with(limits: Limits, effort: f64) -> Limits {
    Limits {
        acceleration: effort * limits.acceleration,
        jerk: effort * limits.jerk,
        ..limits
    }
}
