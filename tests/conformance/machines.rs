//! Machines and what they are made to do.

use quell::effects::{Effect, Place};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use std::f64::consts::PI;

/// Sampling period of drive and encoder, s.
const PERIOD: f64 = 0.004;
/// Period of a sensor with a clock of its own, s.
const OWN_PERIOD: f64 = 0.003;
/// Length of a recording, s.
const DURATION: f64 = 6.0;

/// A machine whose model is known, and its moves.
pub struct Machine {
    /// Its name in messages.
    pub name: &'static str,
    /// The model, which lacks whatever is concealed.
    pub model: Model,
    /// The recording: the input as it is, and outputs whose values are not yet there.
    pub blank: Recording,
    /// Noise of the outputs relative to each other.
    pub noise: &'static [f64],
}

impl Machine {
    /// Whether an effect can sit there in this machine and is seen by its sensors.
    pub fn can_have(&self, effect: &Effect, place: Place) -> bool {
        let input = self.blank.channels[0].role;
        let relative = self.blank.channel(Role::Deformation).is_some();
        let shared = self.blank.channels[1].time == self.blank.channels[0].time;
        let seen = match effect.name {
            // A part of the deformation alone is what a strain gauge shows.
            "deformation_gain" => relative,
            // To a clock of its own a delay is an offset.
            "sensor_delay" => shared,
            _ => true,
        };
        (self.model.kind.places)(input).contains(&place) && seen
    }
}

/// The machines of this test.
pub fn machines() -> Vec<Machine> {
    let joint = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";
    let moves = steps(PERIOD);
    let own = stamps(OWN_PERIOD);
    let shared = stamps(PERIOD);
    let angle = |role| Channel { role, unit: "rad".into(), time: shared.clone(), columns: vec![moves.clone()] };
    vec![
        Machine {
            name: "joint",
            model: Model::from_toml(joint, "model.toml").unwrap(),
            blank: recording(vec![angle(Role::MotorPosition), blank(Role::LinkPosition, &own)]),
            noise: &[1.0],
        },
        Machine {
            name: "gauge",
            model: Model::from_toml(joint, "model.toml").unwrap(),
            blank: recording(vec![angle(Role::MotorPosition), blank(Role::Deformation, &shared)]),
            noise: &[1.0],
        },
        Machine {
            name: "commanded",
            model: Model::from_toml(joint, "model.toml").unwrap(),
            blank: recording(vec![angle(Role::CommandPosition), blank(Role::LinkPosition, &shared)]),
            noise: &[1.0],
        },
        Machine {
            name: "axis",
            model: Model::from_toml("kind = \"rigid_axis\"\nmass = 95.0\n", "model.toml").unwrap(),
            blank: recording(vec![
                Channel { role: Role::Force, unit: "N".into(), time: shared.clone(), columns: vec![pulses(100.0)] },
                Channel { unit: "m".into(), ..blank(Role::MotorPosition, &shared) },
            ]),
            noise: &[1.0],
        },
        Machine {
            name: "two masses",
            model: Model::from_toml("kind = \"two_mass\"\nmotor_inertia = 0.06\nlink_inertia = 0.17\nstiffness = 200.0\ndamping = 0.3\ntorque_constant = 2.0\n", "model.toml").unwrap(),
            blank: recording(vec![
                Channel { role: Role::MotorCurrent, unit: "A".into(), time: shared.clone(), columns: vec![pulses(2.0)] },
                blank(Role::MotorPosition, &shared),
                blank(Role::Deformation, &shared),
            ]),
            noise: &[3.0, 1.0],
        },
    ]
}

fn recording(channels: Vec<Channel>) -> Recording {
    Recording { name: "arm".into(), channels }
}

fn blank(role: Role, stamps: &[f64]) -> Channel {
    Channel { role, unit: "rad".into(), time: stamps.to_vec(), columns: vec![vec![0.0; stamps.len()]] }
}

fn stamps(period: f64) -> Vec<f64> {
    (0..=(DURATION / period) as usize).map(|k| k as f64 * period).collect()
}

/// Moves: start, ramp, cruise (s), speed (rad/s). Short and long, slow and fast, back and forth.
const MOVES: &[(f64, f64, f64, f64)] = &[
    (0.8, 0.10, 0.25, 1.2),
    (1.5, 0.07, 0.05, -0.8),
    (1.9, 0.15, 0.50, 0.4),
    (2.8, 0.08, 0.30, -1.5),
    (3.6, 0.12, 0.10, 1.0),
    (4.1, 0.06, 0.20, -0.5),
    (4.7, 0.10, 0.30, 0.9),
];

/// Position of a motor side that speeds up and slows down by half sines.
fn steps(period: f64) -> Vec<f64> {
    let ramp = |t: f64, ramp: f64, v: f64| {
        let (t, late) = (t.clamp(0.0, ramp), (t - ramp).max(0.0));
        0.5 * v * (t - ramp / PI * (PI * t / ramp).sin()) + v * late
    };
    let at = |t: f64| -> f64 {
        MOVES.iter().map(|&(start, length, cruise, v)| ramp(t - start, length, v) - ramp(t - start - length - cruise, length, v)).sum()
    };
    stamps(period).into_iter().map(|t| 0.2 + at(t)).collect()
}

/// What drives: a push at the start of a move, one against it at its end.
fn pulses(size: f64) -> Vec<f64> {
    let bump = |t: f64, length: f64| match t > 0.0 && t < length {
        true => (PI * t / length).sin(),
        false => 0.0,
    };
    let at = |t: f64| -> f64 {
        MOVES.iter().map(|&(start, length, cruise, v)| v * (bump(t - start, 2.0 * length) - 0.8 * bump(t - start - length - cruise, 2.0 * length))).sum()
    };
    stamps(PERIOD).into_iter().map(|t| size * at(t)).collect()
}
