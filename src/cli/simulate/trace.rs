//! The response of the arm to the command: the readings of its sensors, and the residual after each move.

use super::motion::{Leg, Motion};
use crate::plant::{ArmSimulation, Command, MeasurementLog};
use crate::recording::Recording;

/// Motor side and tip at an instant, from the true state of the simulation.
struct Sample {
    time: f64,
    motor_position: f64,
    tip_deformation: f64,
}

/// The result of a motion.
pub struct Trace {
    /// Command, encoder and tracker, each on its own clock.
    pub recording: Recording,
    /// One entry a leg of the motion.
    pub settled: Vec<Option<Settled>>,
    /// Peak of the true deformation at the tip over all, m.
    pub peak: f64,
}

/// The residual vibration of a move.
#[derive(Clone, Copy, Debug)]
pub struct Settled {
    /// Time from which the motor side stays within one encoder step of the target, s.
    pub motor_end: f64,
    /// Peak of the true deformation at the tip from there until the next move, m.
    pub residual: f64,
}

impl Trace {
    /// Sends the motion through the arm.
    pub fn run(arm: &mut ArmSimulation, motion: &Motion) -> Self {
        let mut log = MeasurementLog::new();
        let mut samples = Vec::with_capacity(motion.knots.len());
        for (index, knot) in motion.knots.iter().enumerate() {
            log.push_command(knot.time, knot.position);
            if index > 0 {
                let command = Command {
                    position: knot.position,
                    velocity: Some(knot.velocity),
                };
                let measurements = arm.step(command, knot.time - arm.time());
                measurements.iter().for_each(|seen| log.push(seen));
            }
            samples.push(Sample {
                time: knot.time,
                motor_position: arm.true_motor_position(),
                tip_deformation: arm.true_tip_deformation(),
            });
        }
        // One encoder step, or a millionth of a turn with an ideal encoder.
        let ideal = core::f64::consts::TAU * 1e-6;
        let step = arm.robot().encoder.resolution.max(ideal);
        let legs = motion.legs.iter().enumerate();
        let settled = legs
            .map(|(index, leg)| settled(&samples, leg, motion.watched_until(index), step))
            .collect();
        Self {
            recording: log.into_recording(&arm.robot().name),
            settled,
            peak: peak(&samples),
        }
    }
}

/// `None` if the motor side is not at rest before the next move.
fn settled(samples: &[Sample], leg: &Leg, until: f64, step: f64) -> Option<Settled> {
    let index = |time: f64| samples.partition_point(|sample| sample.time <= time);
    let watched = &samples[index(leg.until) - 1..index(until)];
    let away = |sample: &Sample| (sample.motor_position - leg.target).abs() > step;
    let first = watched.iter().rposition(away).map_or(0, |last| last + 1);
    let rest = watched.get(first..).filter(|rest| rest.len() > 1)?;
    Some(Settled {
        motor_end: rest[0].time,
        residual: peak(rest),
    })
}

fn peak(samples: &[Sample]) -> f64 {
    let deformations = samples.iter().map(|sample| sample.tip_deformation.abs());
    deformations.fold(0.0, f64::max)
}
