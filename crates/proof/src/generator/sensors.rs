//! The sensors' readings of the motion, and the noise they add.

use super::joint::{Joint, Seen};
use super::moving::Moving;
use super::programme::Programme;
use super::random::Draw;
use super::{Channel, integrate};
use nalgebra::{Rotation3, Vector3};

/// The faults of a sensor; 0 where there is none.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    /// Relative error of the scale.
    pub gain: f64,
    /// Relative error with which the deformation is seen.
    pub deformation_gain: f64,
    /// Amplitude and phase of an error that repeats with the turn: a disc off its centre.
    pub eccentricity: [f64; 2],
    /// Drift: its rate (per s) and 0, or its last level (rad or m) and its time constant, s.
    pub drift: [f64; 2],
    /// Direction of the drift of a tip sensor.
    pub drift_direction: [f64; 3],
    /// Relative error of the clock's rate.
    pub skew: f64,
    /// Amplitude, and the value at which it is reached, of an error with the fifth power.
    pub fifth: [f64; 2],
}

/// The arm with its sensor: everything that makes a noise-free reading.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Mechanics and lag of the sensor.
    pub joint: Joint,
    /// Static faults and the clock.
    pub faults: Faults,
    /// The channel beside the motor side.
    pub channel: Channel,
    /// Distance of the tip from the axis, m.
    pub lever_arm: f64,
    /// Height of the tip, m.
    pub tip_height: f64,
    /// Where the tip sensor stands: robot to sensor.
    pub frame: (Rotation3<f64>, Vector3<f64>),
    /// Reading of the sensor's clock at the encoder's zero, s.
    pub clock_offset: f64,
}

impl Arm {
    fn seen(&self) -> Seen {
        match self.channel {
            Channel::Deformation => Seen::Deformation,
            Channel::Tip | Channel::Link => Seen::Link,
        }
    }

    /// True time at a stamp of the sensor.
    pub fn true_time(&self, stamp: f64) -> f64 {
        (stamp - self.clock_offset) / (1.0 + self.faults.skew)
    }

    /// The tip in the robot's frame.
    pub fn tip(&self, angle: f64) -> Vector3<f64> {
        let (sin, cos) = angle.sin_cos();
        Vector3::new(self.lever_arm * cos, self.lever_arm * sin, self.tip_height)
    }

    /// Noise-free readings at stamps of the sensor's clock, one column or three. Stamps before the
    /// start of the motion show its start.
    pub fn read(&self, programme: &Programme, stamps: &[f64], step: f64) -> Vec<Vec<f64>> {
        let moving = Moving {
            joint: &self.joint,
            programme,
            seen: self.seen(),
        };
        let step = step.min(self.joint.laws.longest_step());
        let times: Vec<f64> = stamps.iter().map(|&stamp| self.true_time(stamp)).collect();
        let late = times.partition_point(|&time| time < 0.0);
        let mut shown = integrate::integrate(
            &moving,
            moving.start(),
            step,
            &moving.breaks(),
            &times[late..],
        );
        let first = shown.first().copied().unwrap_or(0.0);
        shown.splice(0..0, std::iter::repeat_n(first, late));
        let angles = times.iter().zip(shown).map(|(&time, angle)| {
            let motor = programme.at(time)[0];
            self.static_faults(angle, motor) + self.scalar_drift(time)
        });
        match self.channel {
            Channel::Tip => self.in_sensor_frame(angles, &times),
            Channel::Link | Channel::Deformation => vec![angles.collect()],
        }
    }

    fn static_faults(&self, angle: f64, motor: f64) -> f64 {
        let faults = &self.faults;
        let still = if self.seen() == Seen::Link {
            motor
        } else {
            0.0
        };
        let mut value = still + (1.0 + faults.deformation_gain) * (angle - still);
        if faults.fifth[0] != 0.0 {
            value += faults.fifth[0] * (value / faults.fifth[1]).powi(5);
        }
        if self.channel == Channel::Link {
            value *= 1.0 + faults.gain;
            let [size, phase] = faults.eccentricity;
            value += size * ((value + phase).sin() - phase.sin());
        }
        value
    }

    fn drift_at(&self, time: f64) -> f64 {
        let [size, tau] = self.faults.drift;
        match tau {
            0.0 => size * time,
            tau => size * (1.0 - (-time.max(0.0) / tau).exp()),
        }
    }

    fn scalar_drift(&self, time: f64) -> f64 {
        match self.channel {
            Channel::Tip => 0.0,
            Channel::Link | Channel::Deformation => self.drift_at(time),
        }
    }

    fn in_sensor_frame(&self, angles: impl Iterator<Item = f64>, times: &[f64]) -> Vec<Vec<f64>> {
        let direction = Vector3::from(self.faults.drift_direction);
        let mut columns = vec![Vec::new(); 3];
        for (angle, &time) in angles.zip(times) {
            let seen = self.frame.0 * self.tip(angle) + self.frame.1;
            let seen = seen * (1.0 + self.faults.gain) + direction * self.drift_at(time);
            for (column, value) in columns.iter_mut().zip(seen.iter()) {
                column.push(*value);
            }
        }
        columns
    }
}

/// Noise of a sensor, in its own unit.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// One standard deviation.
    pub std: f64,
    /// Its colour.
    pub colour: Colour,
}

/// How the noise of neighbouring samples hangs together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Colour {
    /// Each sample for itself.
    White,
    /// `n_k = rho n_(k-1) + ...`.
    Autoregressive(f64),
    /// Rounded to steps, over white noise of half the standard deviation.
    Quantised,
}

impl Colour {
    /// Its name in the truth.
    pub fn name(self) -> String {
        match self {
            Self::White => "white".into(),
            Self::Autoregressive(rho) => format!("ar1 {rho:.2}"),
            Self::Quantised => "quantised".into(),
        }
    }
}

impl Noise {
    /// Adds noise to a column.
    pub fn add(&self, draw: &mut Draw, column: &mut [f64]) {
        match self.colour {
            Colour::White => column
                .iter_mut()
                .for_each(|x| *x += self.std * draw.normal()),
            Colour::Autoregressive(rho) => {
                let (mut state, fresh) = (draw.normal(), (1.0 - rho * rho).sqrt());
                for value in column {
                    *value += self.std * state;
                    state = rho * state + fresh * draw.normal();
                }
            }
            Colour::Quantised => {
                let white = 0.5 * self.std;
                let step = 12f64.sqrt() * (self.std * self.std - white * white).sqrt();
                for value in column {
                    *value = step * ((*value + white * draw.normal()) / step).round();
                }
            }
        }
    }
}
