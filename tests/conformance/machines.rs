//! Machines and what they are made to do.

use quell::effects::{Effect, Place};
use quell::model::Model;
use quell::recording::{Channel, Recording, Role};
use std::f64::consts::PI;

/// Sampling period of drive and encoder, s.
pub const PERIOD: f64 = 0.004;
/// Period of a sensor with a clock of its own, s.
pub const OWN_PERIOD: f64 = 0.003;
/// Length of a recording, s.
const DURATION: f64 = 6.0;

const JOINT: &str = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";

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
    fn new(name: &'static str, model: &str, channels: Vec<Channel>) -> Self {
        Self {
            name,
            model: Model::from_toml(model, "model.toml").unwrap(),
            blank: Recording {
                name: name.into(),
                payload: None,
                channels,
            },
            noise: &[1.0],
        }
    }

    /// Whether an effect can sit there in this machine and is seen by its sensors.
    pub fn can_have(&self, effect: &Effect, place: Place) -> bool {
        let [input, sensor, ..] = &self.blank.channels[..] else {
            return false;
        };
        let shows = !effect.is_of_deformation_only() || sensor.role == Role::Deformation;
        let seen = shows && (!effect.shifts_stamps() || sensor.time == input.time);
        (self.model.kind.places)(input.role).contains(&place) && seen
    }
}

/// A flexible joint whose encoder and link sensor have these stamps.
pub fn joint_at(encoder: &[f64], sensor: &[f64]) -> Machine {
    let channels = vec![
        angle(Role::MotorPosition, encoder, position),
        blank(Role::LinkPosition, sensor),
    ];
    Machine::new("joint", JOINT, channels)
}

/// A flexible joint behind its encoder, with a sensor of the link that has a clock of its own.
pub fn joint() -> Machine {
    joint_at(&stamps(PERIOD), &stamps(OWN_PERIOD))
}

/// The same with a strain gauge that is read with the encoder.
pub fn gauge() -> Machine {
    let shared = stamps(PERIOD);
    let channels = vec![
        angle(Role::MotorPosition, &shared, position),
        blank(Role::Deformation, &shared),
    ];
    Machine::new("gauge", JOINT, channels)
}

/// The same behind the command; the link starts away from 0.
pub fn commanded() -> Machine {
    let shared = stamps(PERIOD);
    let channels = vec![
        angle(Role::CommandPosition, &shared, position),
        blank(Role::LinkPosition, &shared),
    ];
    Machine::new("commanded", JOINT, channels)
}

/// A rigid axis that a measured force drives.
pub fn axis() -> Machine {
    let shared = stamps(PERIOD);
    let channels = vec![
        Channel {
            unit: "N".into(),
            ..angle(Role::Force, &shared, |t| 100.0 * push(t))
        },
        Channel {
            unit: "m".into(),
            ..blank(Role::MotorPosition, &shared)
        },
    ];
    Machine::new("axis", "kind = \"rigid_axis\"\nmass = 95.0\n", channels)
}

/// The same under a position loop, driven by its reference.
pub fn looped() -> Machine {
    let shared = stamps(PERIOD);
    let model =
        "kind = \"rigid_axis\"\nmass = 95.0\nposition_gain = 20.0\nvelocity_gain = 3000.0\n";
    let channels = vec![
        Channel {
            unit: "m".into(),
            ..angle(Role::CommandPosition, &shared, position)
        },
        Channel {
            unit: "m".into(),
            ..blank(Role::MotorPosition, &shared)
        },
    ];
    Machine::new("loop", model, channels)
}

/// A motor and a link on a spring, driven by a current.
pub fn two_masses() -> Machine {
    let shared = stamps(PERIOD);
    let model = "kind = \"two_mass\"\nmotor_inertia = 0.06\nlink_inertia = 0.17\nstiffness = 200.0\n\
        damping = 0.3\ntorque_constant = 2.0\n";
    let channels = vec![
        Channel {
            unit: "A".into(),
            ..angle(Role::MotorCurrent, &shared, |t| 2.0 * push(t))
        },
        blank(Role::MotorPosition, &shared),
        blank(Role::Deformation, &shared),
    ];
    Machine {
        noise: &[3.0, 1.0],
        ..Machine::new("two masses", model, channels)
    }
}

/// A spring, a mass and a damper that a force drives.
pub fn oscillator() -> Machine {
    let shared = stamps(PERIOD);
    let model = "kind = \"oscillator\"\nnatural_frequency_hz = 8.0\ndamping_ratio = 0.05\n";
    let channels = vec![
        angle(Role::Force, &shared, push),
        blank(Role::LinkPosition, &shared),
    ];
    Machine::new("oscillator", model, channels)
}

/// A spring and a damper that are moved, and push back.
pub fn held() -> Machine {
    let shared = stamps(PERIOD);
    let model = "kind = \"oscillator\"\nstiffness = 1000.0\nviscous = 5.0\n";
    let channels = vec![
        angle(Role::LinkPosition, &shared, position),
        blank(Role::Force, &shared),
    ];
    Machine::new("spring and damper", model, channels)
}

/// A channel with the values of a function of time.
pub fn angle(role: Role, time: &[f64], at: impl Fn(f64) -> f64) -> Channel {
    Channel {
        role,
        unit: "rad".into(),
        time: time.to_vec(),
        columns: vec![time.iter().map(|t| at(*t)).collect()],
    }
}

/// A recording of two angles that are read on one clock.
pub fn two_angles(name: &str, time: &[f64], angles: [(Role, Vec<f64>); 2]) -> Recording {
    let channel = |(role, values)| Channel {
        columns: vec![values],
        ..blank(role, time)
    };
    Recording {
        name: name.into(),
        payload: None,
        channels: angles.map(channel).into(),
    }
}

/// A channel whose values are not yet there.
pub fn blank(role: Role, time: &[f64]) -> Channel {
    angle(role, time, |_| 0.0)
}

/// A regular clock.
pub fn stamps(period: f64) -> Vec<f64> {
    (0..=(DURATION / period) as usize)
        .map(|k| k as f64 * period)
        .collect()
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
pub fn position(t: f64) -> f64 {
    let ramp = |t: f64, ramp: f64, v: f64| {
        let (t, late) = (t.clamp(0.0, ramp), (t - ramp).max(0.0));
        0.5 * v * (t - ramp / PI * (PI * t / ramp).sin()) + v * late
    };
    let moved = MOVES.iter().map(|&(start, length, cruise, v)| {
        ramp(t - start, length, v) - ramp(t - start - length - cruise, length, v)
    });
    0.2 + moved.sum::<f64>()
}

/// The drive: a push at the start of a move, one against it at its end.
pub fn push(t: f64) -> f64 {
    let bump = |t: f64, length: f64| match t > 0.0 && t < length {
        true => (PI * t / length).sin(),
        false => 0.0,
    };
    let pushes = MOVES.iter().map(|&(start, length, cruise, v)| {
        let stop = bump(t - start - length - cruise, 2.0 * length);
        v * (bump(t - start, 2.0 * length) - 0.8 * stop)
    });
    pushes.sum()
}
