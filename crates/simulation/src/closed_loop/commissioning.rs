//! Commissioning: the tracker's frame and clock from a move.

use nalgebra::Point3;
use quell_trajectories::{AxisState, Limits, Planner, Trajectory};

use super::ClosedLoopError;
use crate::plant::{ArmSimulation, Command};
use quell_signal::{ArcRegistration, CubicSpline, End, Measurement, SignalError, register_arc};

/// Rest before each of the two moves, s, so that the tracker also sees the arm at rest.
const PAUSE: f64 = 0.5;
/// Rest after the last recorded move, s: 3 Hz at 5 % decays to 6 %.
const RING_OUT: f64 = 3.0;
/// Further rest in time constants of the envelope, to 1 in 1000: the controller takes the arm to be at rest
/// when it begins.
const TIME_CONSTANTS: f64 = 7.0;
/// Longest rest, s: 0.1 % at 10 Hz has a time constant of 16 s.
const LONGEST_REST: f64 = 120.0;
/// Arc above which the move is not doubled any more, rad: an arc of 20 degrees at a radius of 1 m has a height
/// of 14 mm.
const LONGEST_ARC: f64 = 0.35;

/// Moves the joint there and back, unshaped, and registers frame and clock of the tracker from the data of
/// encoder and tracker. The mode from this fit is not passed on: the controller must learn it on its own. An
/// arc that the tracker's noise does not distinguish from a line is doubled.
///
/// # Errors
/// [`ClosedLoopError::Plan`]; [`ClosedLoopError::Registration`] where the longest arc is too short.
pub fn commission(
    arm: &mut ArmSimulation,
    displacement: f64,
    limits: Limits,
) -> Result<ArcRegistration, ClosedLoopError> {
    let start = arm.true_motor_position();
    let mut displacement = displacement;
    let registration = loop {
        let (encoder, tracker) = there_and_back(arm, start, displacement, limits)?;
        let motor = CubicSpline::new(&encoder.0, &encoder.1, End::NotAKnot)?;
        match register_arc(arm.arc(), &motor, &tracker.0, &tracker.1, None) {
            Err(SignalError::Degenerate { .. }) if displacement.abs() < LONGEST_ARC => {
                displacement *= 2.0;
            }
            other => break other?,
        }
    };
    if let Some(mode) = registration.mode {
        let rest = (TIME_CONSTANTS / mode.decay_rate()).min(LONGEST_REST) - RING_OUT;
        stay(arm, start, rest, &mut Seen::default());
    }
    Ok(registration)
}

/// Samples of one sensor: stamps and readings.
type Samples<T> = (Vec<f64>, Vec<T>);
/// The samples of encoder and tracker.
type Seen = (Samples<f64>, Samples<Point3<f64>>);

fn there_and_back(
    arm: &mut ArmSimulation,
    start: f64,
    displacement: f64,
    limits: Limits,
) -> Result<Seen, ClosedLoopError> {
    let start = AxisState::at_rest(start);
    let end = AxisState::at_rest(start.position + displacement);
    let planner = Planner::new(1)?;
    let mut seen = Seen::default();
    for [from, to] in [[start, end], [end, start]] {
        let plan = planner.plan(&[from], &[to], &[limits])?;
        follow(arm, &plan, plan.duration(), &mut seen);
    }
    stay(arm, start.position, RING_OUT, &mut seen);
    Ok(seen)
}

/// Rests at a position.
fn stay(arm: &mut ArmSimulation, position: f64, duration: f64, seen: &mut Seen) {
    let command = Command {
        position,
        velocity: Some(0.0),
    };
    let period = 1.0 / arm.robot().control_rate;
    for _ in 0..(duration / period).ceil() as usize {
        for measurement in arm.step(command, period) {
            sort(measurement, seen);
        }
    }
}

/// Rests, then follows a plan for `duration` (s).
fn follow(arm: &mut ArmSimulation, plan: &Trajectory, duration: f64, seen: &mut Seen) {
    let period = 1.0 / arm.robot().control_rate;
    let ticks = ((PAUSE + duration) / period).ceil() as usize;
    for tick in 0..ticks {
        let state = plan.state_at(tick as f64 * period - PAUSE)[0];
        let command = Command {
            position: state.position,
            velocity: Some(state.velocity),
        };
        for measurement in arm.step(command, period) {
            sort(measurement, seen);
        }
    }
}

fn sort(measurement: &Measurement, seen: &mut Seen) {
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
