//! Readings of a simulated motion, at the stamps of the sensors.

use super::experiment::Output;
use super::further_modes::FurtherModes;
use super::trace::{Kinematics, Trace, hermite, sloped};
use crate::effects::{Reading, Sensor};
use quell_recording::Role;

/// The predicted readings of an output.
#[derive(Clone, Debug, Default)]
pub struct Prediction {
    /// Values at the stamps, in the unit of the output's values.
    pub values: Vec<f64>,
    /// Their rate of change with time: minus the derivative to the clock's offset.
    pub rates: Vec<f64>,
}

/// The observation of a motion: the effects of the sensors, and the quantity that stands for the link.
pub(super) struct Eyes {
    pub sensors: Vec<Box<dyn Sensor>>,
    /// Further modes that a sensor of the link sees.
    pub modes: FurtherModes,
    /// Whether something prescribes or drives the motor side.
    pub prescribed: bool,
    /// Whether a link hangs on the motor side.
    pub elastic: bool,
}

impl Eyes {
    /// The effects of the sensor of an output. They do not apply to an encoder on the motor side, which is the
    /// reference for the sensor of the link.
    fn of(&self, output: &Output) -> &[Box<dyn Sensor>] {
        let at_motor = matches!(output.role, Role::MotorPosition | Role::MotorVelocity);
        match at_motor && self.elastic {
            true => &[],
            false => &self.sensors,
        }
    }

    /// The quantity that an output measures without the shares of further modes, at the nodes.
    fn curve(&self, trace: &Trace, role: Role) -> Vec<[f64; 2]> {
        let further: f64 = self.modes.laws.iter().map(|law| law.share).sum();
        let own = if self.prescribed { 1.0 - further } else { 1.0 };
        let first = |k: usize| -> Kinematics { trace.link[k].map(|value| own * value) };
        let nodes = 0..trace.time.len();
        match role {
            Role::MotorPosition => nodes
                .map(|k| [trace.motor[k][0], trace.motor[k][1]])
                .collect(),
            Role::MotorVelocity => nodes
                .map(|k| [trace.motor[k][1], trace.motor[k][2]])
                .collect(),
            Role::Deformation => nodes
                .map(|k| {
                    let (seen, motor) = (first(k), trace.motor[k]);
                    [seen[0] - motor[0], seen[1] - motor[1]]
                })
                .collect(),
            Role::LinkVelocity => nodes.map(|k| [first(k)[1], first(k)[2]]).collect(),
            Role::LinkAcceleration => sloped(&trace.time, nodes.map(|k| first(k)[2]).collect()),
            Role::Force | Role::Torque | Role::MotorCurrent | Role::MotorVoltage => {
                sloped(&trace.time, trace.force.clone())
            }
            _ => nodes.map(|k| [first(k)[0], first(k)[1]]).collect(),
        }
    }

    /// The derivative of further modes that an output sees, if it sees any.
    fn order(&self, role: Role) -> Option<usize> {
        match role {
            _ if self.modes.laws.is_empty() => None,
            Role::MotorPosition | Role::MotorVelocity => None,
            Role::Force | Role::Torque | Role::MotorCurrent | Role::MotorVoltage => None,
            Role::LinkVelocity => Some(1),
            Role::LinkAcceleration => Some(2),
            _ => Some(0),
        }
    }
}

/// Reads an output from a motion in one part, or in several
/// ([`integrate_in_parts`](super::integrate::integrate_in_parts)).
pub(super) struct Reader<'a> {
    eyes: &'a Eyes,
    output: &'a Output,
    /// Excess of the output's clock, s.
    offset: f64,
    /// State of each filter at the first node of the next part; empty before the first part.
    filtered: Vec<Option<[f64; 2]>>,
    begun: bool,
    /// States of further modes at the first node of the next part.
    modes: Vec<[f64; 2]>,
    prediction: Prediction,
}

impl<'a> Reader<'a> {
    pub fn new(eyes: &'a Eyes, output: &'a Output, offset: f64) -> Self {
        Self {
            eyes,
            output,
            offset,
            filtered: vec![None; eyes.of(output).len()],
            begun: false,
            modes: eyes.modes.start(),
            prediction: Prediction {
                values: Vec::with_capacity(output.time.len()),
                rates: Vec::with_capacity(output.time.len()),
            },
        }
    }

    /// The readings at all stamps.
    pub fn end(self) -> Prediction {
        self.prediction
    }

    /// Reads a part. The `last` one also gives the readings after the end of the motion.
    pub fn read(&mut self, trace: &Trace, last: bool) {
        let sensors = self.eyes.of(self.output);
        // Where two parts meet, slopes are known up to the last node but one, and from the second node on.
        let from = usize::from(self.begun);
        let to = trace.time.len() - if last { 1 } else { 2 };
        self.begun = true;
        let mut curve = self.eyes.curve(trace, self.output.role);
        let order = self.eyes.order(self.output.role);
        let mut seen = order.map(|order| {
            let modes = &self.eyes.modes;
            modes.seen(trace, from..=to, (&curve, order), &mut self.modes)
        });
        let (time, motor, curve) = match &mut seen {
            Some(own) => (&own.time[..], &own.motor[..], &mut own.curve[..]),
            None => (
                &trace.time[from..=to],
                &trace.motor[from..=to],
                &mut curve[from..=to],
            ),
        };
        for (sensor, filtered) in sensors.iter().zip(&mut self.filtered) {
            if sensor.filters() {
                sensor.filter(time, curve, *filtered);
                *filtered = curve.last().copied();
            }
        }
        let part = Part {
            time,
            curve,
            motor,
            relative: self.output.role == Role::Deformation,
            tracked: self.output.channel == Role::TipPosition,
        };
        self.show(&part, last);
    }

    /// Values and rates at the stamps up to the last node.
    fn show(&mut self, part: &Part<'_>, last: bool) {
        let sensors = self.eyes.of(self.output);
        let (first, end) = (part.time[0], part.time[part.time.len() - 1]);
        let mut k = 0;
        for &stamp in &self.output.time[self.prediction.values.len()..] {
            let at = sensors
                .iter()
                .fold(stamp - self.offset, |at, sensor| sensor.instant(at));
            if !last && at > end {
                return;
            }
            // Before and after the record everything is constant.
            let at = at.clamp(first, end);
            k = part.interval(k, at);
            let [value, rate] = part.measured(k, at);
            self.prediction
                .values
                .push(part.shown(sensors, k, at, value));
            self.prediction.rates.push(rate);
        }
    }
}

/// A part of a motion: the measured quantity and the motor side at its nodes.
struct Part<'a> {
    time: &'a [f64],
    curve: &'a [[f64; 2]],
    motor: &'a [Kinematics],
    /// Whether the measured quantity is relative to the motor side.
    relative: bool,
    /// Whether it is the angle of a tip that a tracker follows.
    tracked: bool,
}

impl Part<'_> {
    /// The interval of an instant, searched from interval `k` on.
    fn interval(&self, mut k: usize, at: f64) -> usize {
        while k + 2 < self.time.len() && self.time[k + 1] < at {
            k += 1;
        }
        while k > 0 && self.time[k] > at {
            k -= 1;
        }
        k
    }

    /// The quantity and its rate at an instant in interval `k`.
    fn measured(&self, k: usize, at: f64) -> [f64; 2] {
        let (start, stop) = (self.time[k], self.time[k + 1]);
        let value = hermite(start, stop, self.curve[k], self.curve[k + 1], at);
        let s = (at - start) / (stop - start);
        let rate = self.curve[k][1] + s * (self.curve[k + 1][1] - self.curve[k][1]);
        [value, rate]
    }

    /// The readings of sensors for a value at an instant in interval `k`.
    fn shown(&self, sensors: &[Box<dyn Sensor>], k: usize, at: f64, value: f64) -> f64 {
        if sensors.is_empty() {
            return value;
        }
        let u = |k: usize| [self.motor[k][0], self.motor[k][1]];
        let motor = match self.relative {
            true => 0.0,
            false => hermite(self.time[k], self.time[k + 1], u(k), u(k + 1), at),
        };
        sensors.iter().fold(value, |value, sensor| {
            sensor.read(&Reading {
                time: at,
                value,
                motor,
                tracked: self.tracked,
            })
        })
    }
}
