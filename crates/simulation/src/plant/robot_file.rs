//! A robot description in TOML: its keys with their units, checked, as a [`Robot`].

mod check;
mod keys;
mod kinematics;

use std::path::Path;

use quell_recording::SyntaxError;
use quell_shapers::Mode;
use quell_trajectories::Limits;

use super::error::RobotError;
use super::robot::{DefaultMove, Encoder, ModeOfJoint, Robot, RobotJoint, Servo, Tracker};
use check::Check;
use keys::{
    EncoderKeys, JointKeys, LimitKeys, ModeKeys, MoveKeys, RobotFile, ServoKeys, TrackerKeys,
};
use quell_signal::{Chain, Clock, JointKind};

impl Robot {
    /// The embedded arm: RX-170B class, joint 1 at 8.12 Hz and 8.4 %.
    pub fn rx170() -> Self {
        parse(include_str!("rx170.toml"), Path::new("rx170.toml"))
            .expect("the embedded description is part of the source and read by the tests")
    }

    /// Reads a robot description.
    ///
    /// # Errors
    /// [`RobotError`] with file, key and value.
    pub fn from_file(file: &Path) -> Result<Self, RobotError> {
        let text = std::fs::read_to_string(file).map_err(|error| RobotError::Unreadable {
            file: file.to_path_buf(),
            reason: error.to_string(),
        })?;
        parse(&text, file)
    }

    /// Parses a robot description; `file` names it in errors, and `urdf` is relative to it.
    ///
    /// # Errors
    /// As [`Robot::from_file`].
    pub fn from_toml(text: &str, file: &Path) -> Result<Self, RobotError> {
        parse(text, file)
    }
}

/// Parses and checks a description; `file` names it in errors, and `urdf` is relative to it.
fn parse(text: &str, file: &Path) -> Result<Robot, RobotError> {
    let keys: RobotFile = toml::from_str(text).map_err(|error| RobotError::Syntax {
        file: file.to_path_buf(),
        error: SyntaxError::of(text, &error),
    })?;
    let check = Check { file, text };
    let (chain, bodies) = kinematics::kinematics(&keys, &check)?;
    let mut joints = Vec::new();
    for (index, (joint, entry)) in keys.joint.iter().zip(chain.joints()).enumerate() {
        let at = format!("joint[{}]", index + 1);
        joints.push(robot_joint(joint, &at, entry.kind, &check)?);
    }
    Ok(Robot {
        name: keys.name,
        default_move: default_move(&keys.default_move, &chain, &check)?,
        chain,
        bodies,
        joints,
        servo: servo(&keys.servo, &check)?,
        encoder: encoder(&keys.encoder, &check)?,
        tracker: tracker(&keys.tracker, &check)?,
        control_rate: check.rate("controller.rate_hz", keys.controller.rate_hz)?,
    })
}

fn default_move(keys: &MoveKeys, chain: &Chain, check: &Check) -> Result<DefaultMove, RobotError> {
    let target = check.finite("move.target_deg", keys.target_deg)?;
    let joint = keys.joint.checked_sub(1);
    let entry = joint.and_then(|index| chain.joints().get(index));
    let turns = entry.is_some_and(|entry| entry.kind == JointKind::Revolute);
    match joint {
        Some(joint) if turns => Ok(DefaultMove {
            joint,
            target: target.to_radians(),
        }),
        _ => Err(check.refuse(
            "move.joint",
            keys.joint,
            "the number of a joint that turns, from 1",
        )),
    }
}

fn robot_joint(
    joint: &JointKeys,
    at: &str,
    kind: JointKind,
    check: &Check,
) -> Result<RobotJoint, RobotError> {
    let mut modes = Vec::new();
    for (index, mode) in joint.mode.iter().enumerate() {
        let at = format!("{at}.mode[{}]", index + 1);
        modes.push(mode_of_joint(mode, &at, check)?);
    }
    if modes.len() > super::axis::MAX_MODES {
        return Err(check.refuse(
            &format!("{at}.mode"),
            modes.len(),
            "at most 4 modes a joint",
        ));
    }
    Ok(RobotJoint {
        home: home(joint, at, kind, check)?,
        limits: limits(&joint.limits, &format!("{at}.limits"), kind, check)?,
        modes,
    })
}

/// In deg for a joint that turns, in m for one that slides; 0 where it is not given.
fn home(joint: &JointKeys, at: &str, kind: JointKind, check: &Check) -> Result<f64, RobotError> {
    let [turns, slides] = [("home_deg", joint.home_deg), ("home_m", joint.home_m)];
    let ((key, value), (other, unfit)) = match kind {
        JointKind::Revolute => (turns, slides),
        JointKind::Prismatic => (slides, turns),
    };
    if let Some(unfit) = unfit {
        return Err(check.refuse(&format!("{at}.{other}"), unfit, UNFIT));
    }
    Ok(si(
        check.finite(&format!("{at}.{key}"), value.unwrap_or(0.0))?,
        kind,
    ))
}

/// The error for a key in deg at a joint that slides, or in m at one that turns.
const UNFIT: &str = "keys in deg are for joints that turn, keys in m for joints that slide";

fn si(value: f64, kind: JointKind) -> f64 {
    match kind {
        JointKind::Revolute => value.to_radians(),
        JointKind::Prismatic => value,
    }
}

fn limits(
    keys: &LimitKeys,
    at: &str,
    kind: JointKind,
    check: &Check,
) -> Result<Limits, RobotError> {
    let turns = [
        ("velocity_deg_s", keys.velocity_deg_s),
        ("acceleration_deg_s2", keys.acceleration_deg_s2),
        ("jerk_deg_s3", keys.jerk_deg_s3),
    ];
    let slides = [
        ("velocity_m_s", keys.velocity_m_s),
        ("acceleration_m_s2", keys.acceleration_m_s2),
        ("jerk_m_s3", keys.jerk_m_s3),
    ];
    let (own, others) = match kind {
        JointKind::Revolute => (turns, slides),
        JointKind::Prismatic => (slides, turns),
    };
    for (key, value) in others {
        if let Some(value) = value {
            return Err(check.refuse(&format!("{at}.{key}"), value, UNFIT));
        }
    }
    let limit = |(key, value): (&str, Option<f64>)| {
        let key = format!("{at}.{key}");
        match value {
            Some(value) => check.positive(&key, value).map(|value| si(value, kind)),
            None => Err(check.refuse(&key, "(missing)", "a finite number above 0")),
        }
    };
    let [velocity, acceleration, jerk] = own;
    Ok(Limits {
        velocity: limit(velocity)?,
        acceleration: limit(acceleration)?,
        jerk: limit(jerk)?,
    })
}

fn mode_of_joint(keys: &ModeKeys, at: &str, check: &Check) -> Result<ModeOfJoint, RobotError> {
    let frequency = check.rate(&format!("{at}.frequency_hz"), keys.frequency_hz)?;
    let mode = Mode::from_hertz(frequency, keys.damping_ratio).map_err(|_| {
        check.refuse(
            &format!("{at}.damping_ratio"),
            keys.damping_ratio,
            "0 or more, below 1",
        )
    })?;
    Ok(ModeOfJoint {
        mode,
        damping: keys.damping,
        participation: check.finite(&format!("{at}.participation"), keys.participation)?,
    })
}

fn servo(keys: &ServoKeys, check: &Check) -> Result<Servo, RobotError> {
    let key = "servo.velocity_feed_forward";
    Ok(Servo {
        bandwidth: check.rate("servo.bandwidth_hz", keys.bandwidth_hz)? * std::f64::consts::TAU,
        damping_ratio: check.positive("servo.damping_ratio", keys.damping_ratio)?,
        velocity_feed_forward: check.finite(key, keys.velocity_feed_forward)?,
    })
}

fn encoder(keys: &EncoderKeys, check: &Check) -> Result<Encoder, RobotError> {
    Ok(Encoder {
        rate: check.rate("encoder.rate_hz", keys.rate_hz)?,
        resolution: check.not_negative("encoder.resolution_rad", keys.resolution_rad)?,
    })
}

fn tracker(keys: &TrackerKeys, check: &Check) -> Result<Tracker, RobotError> {
    let skew = check.finite("tracker.clock_skew_ppm", keys.clock_skew_ppm)? * 1e-6;
    if skew <= -1.0 {
        let value = keys.clock_skew_ppm;
        return Err(check.refuse("tracker.clock_skew_ppm", value, "above -1e6"));
    }
    Ok(Tracker {
        rate: check.rate("tracker.rate_hz", keys.rate_hz)?,
        noise: check.not_negative("tracker.noise_um", keys.noise_um)? * 1e-6,
        pose: check.pose("tracker", keys.position_m, keys.rpy_deg)?,
        clock: Clock {
            offset: check.finite("tracker.clock_offset_s", keys.clock_offset_s)?,
            skew,
        },
    })
}
