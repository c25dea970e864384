//! Learning where the tracker stands and how its clock reads.

use nalgebra::Point3;
use quell_trajectories::{AxisState, Limits, Planner};

use super::ClosedLoopError;
use crate::plant::{ArmSimulation, Command};
use crate::signal::{ArcRegistration, CubicSpline, End, Measurement, register_arc};

/// The arm rests before, between and after the two moves, s: long enough for 3 Hz at 5 % to ring out
/// to 6 %, and seen at rest by the tracker too.
const REST: f64 = 3.0;

/// Moves the joint there and back, unshaped, and registers frame and clock of the tracker from what
/// encoder and tracker saw. The mode that comes out on the way is not handed on: the controller has
/// to learn it by itself.
///
/// # Errors
/// [`ClosedLoopError::Plan`]; [`ClosedLoopError::Registration`] where the arc is too short.
pub fn commission(
    arm: &mut ArmSimulation,
    displacement: f64,
    limits: Limits,
) -> Result<ArcRegistration, ClosedLoopError> {
    let (encoder, tracker) = there_and_back(arm, displacement, limits)?;
    let motor = CubicSpline::new(&encoder.0, &encoder.1, End::NotAKnot)?;
    Ok(register_arc(
        arm.arc(),
        &motor,
        &tracker.0,
        &tracker.1,
        None,
    )?)
}

/// Samples of one sensor: stamps and readings.
type Samples<T> = (Vec<f64>, Vec<T>);

fn there_and_back(
    arm: &mut ArmSimulation,
    displacement: f64,
    limits: Limits,
) -> Result<(Samples<f64>, Samples<Point3<f64>>), ClosedLoopError> {
    let period = 1.0 / arm.robot().control_rate;
    let start = arm.true_motor_position();
    let ends = [
        AxisState::at_rest(start),
        AxisState::at_rest(start + displacement),
    ];
    let planner = Planner::new(1)?;
    let mut seen = (Samples::default(), Samples::default());
    for [from, to] in [[ends[0], ends[1]], [ends[1], ends[0]]] {
        let plan = planner.plan(&[from], &[to], &[limits])?;
        let ticks = ((REST + plan.duration() + REST) / period).ceil() as usize;
        for tick in 0..ticks {
            let state = plan.state_at(tick as f64 * period - REST)[0];
            let command = Command {
                position: state.position,
                velocity: Some(state.velocity),
            };
            arm.step(command, period)
                .iter()
                .for_each(|measurement| sort(measurement, &mut seen));
        }
    }
    Ok(seen)
}

fn sort(measurement: &Measurement, seen: &mut (Samples<f64>, Samples<Point3<f64>>)) {
    match *measurement {
        Measurement::MotorPosition { time, position } => {
            seen.0.0.push(time);
            seen.0.1.push(position);
        }
        Measurement::TipPosition { time, position } => {
            seen.1.0.push(time);
            seen.1.1.push(Point3::from(position));
        }
        Measurement::LinkPosition { .. } | Measurement::Deformation { .. } => {}
    }
}
