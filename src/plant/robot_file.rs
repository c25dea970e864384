//! The keys of a robot description in TOML, with their units, and their check.

use std::path::{Path, PathBuf};

use nalgebra::{Isometry3, Matrix3, Point3, Translation3, UnitQuaternion, Vector3};
use quell_shapers::Mode;
use serde::Deserialize;

use super::error::RobotError;
use super::robot::{
    Damping, DefaultMove, Encoder, JointLimits, ModeOfJoint, Robot, RobotJoint, Servo, Tracker,
};
use crate::signal::{Body, Chain, Clock, DhRow, JointKind, read_urdf};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotFile {
    name: String,
    urdf: Option<PathBuf>,
    tip_link: Option<String>,
    #[serde(default)]
    tool: PoseKeys,
    #[serde(rename = "move")]
    default_move: MoveKeys,
    controller: ControllerKeys,
    servo: ServoKeys,
    encoder: EncoderKeys,
    tracker: TrackerKeys,
    joint: Vec<JointKeys>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct PoseKeys {
    #[serde(default)]
    position_m: [f64; 3],
    #[serde(default)]
    rpy_deg: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MoveKeys {
    joint: usize,
    target_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ControllerKeys {
    rate_hz: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ServoKeys {
    bandwidth_hz: f64,
    damping_ratio: f64,
    velocity_feed_forward: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct EncoderKeys {
    rate_hz: f64,
    resolution_rad: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TrackerKeys {
    rate_hz: f64,
    noise_um: f64,
    position_m: [f64; 3],
    rpy_deg: [f64; 3],
    #[serde(default)]
    clock_offset_s: f64,
    #[serde(default)]
    clock_skew_ppm: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct JointKeys {
    name: Option<String>,
    dh: Option<DhKeys>,
    #[serde(default)]
    home_deg: f64,
    limits: LimitKeys,
    #[serde(default)]
    mode: Vec<ModeKeys>,
    link: Option<LinkKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct DhKeys {
    a_m: f64,
    alpha_deg: f64,
    d_m: f64,
    theta_deg: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LimitKeys {
    velocity_deg_s: f64,
    acceleration_deg_s2: f64,
    jerk_deg_s3: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ModeKeys {
    frequency_hz: f64,
    damping_ratio: f64,
    damping: Damping,
    #[serde(default = "one")]
    participation: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct LinkKeys {
    mass_kg: f64,
    centre_m: [f64; 3],
    #[serde(default)]
    inertia_kg_m2: [f64; 3],
}

fn one() -> f64 {
    1.0
}

/// Parses and checks a description; `file` names it in errors and is what `urdf` is relative to.
pub(super) fn parse(text: &str, file: &Path) -> Result<Robot, RobotError> {
    let keys: RobotFile = toml::from_str(text).map_err(|error| RobotError::Syntax {
        file: file.to_path_buf(),
        message: error.to_string(),
    })?;
    let check = Check { file };
    let (chain, bodies) = kinematics(&keys, &check)?;
    let mut joints = Vec::new();
    for (index, joint) in keys.joint.iter().enumerate() {
        joints.push(robot_joint(
            joint,
            &format!("joint[{}]", index + 1),
            &check,
        )?);
    }
    let target = check.finite("move.target_deg", keys.default_move.target_deg)?;
    let joint = keys.default_move.joint;
    let movable = joint >= 1
        && chain
            .joints()
            .get(joint - 1)
            .is_some_and(|entry| entry.kind == JointKind::Revolute);
    if !movable {
        return Err(check.refuse(
            "move.joint",
            joint,
            "the number of a joint that turns, from 1",
        ));
    }
    Ok(Robot {
        name: keys.name,
        chain,
        bodies,
        joints,
        servo: servo(&keys.servo, &check)?,
        encoder: Encoder {
            rate: check.positive("encoder.rate_hz", keys.encoder.rate_hz)?,
            resolution: check
                .not_negative("encoder.resolution_rad", keys.encoder.resolution_rad)?,
        },
        tracker: tracker(&keys.tracker, &check)?,
        control_rate: check.positive("controller.rate_hz", keys.controller.rate_hz)?,
        default_move: DefaultMove {
            joint: joint - 1,
            target: target.to_radians(),
        },
    })
}

/// Chain and bodies from the URDF file, or from the Denavit-Hartenberg rows.
fn kinematics(keys: &RobotFile, check: &Check) -> Result<(Chain, Vec<Body>), RobotError> {
    let tool = check.pose("tool", keys.tool.position_m, keys.tool.rpy_deg)?;
    if let Some(urdf) = &keys.urdf {
        let path = check.file.parent().unwrap_or(Path::new("")).join(urdf);
        let read = read_urdf(&path, keys.tip_link.as_deref()).map_err(|source| {
            RobotError::Kinematics {
                file: check.file.to_path_buf(),
                source,
            }
        })?;
        if read.chain.joints().len() != keys.joint.len() {
            let expected = "as many [[joint]] tables as the URDF chain has moving joints";
            return Err(check.refuse("joint (tables)", keys.joint.len(), expected));
        }
        for (index, (entry, key)) in read.chain.joints().iter().zip(&keys.joint).enumerate() {
            if let Some(name) = key.name.as_ref().filter(|name| **name != entry.name) {
                let key = format!("joint[{}].name", index + 1);
                return Err(check.refuse(&key, name, "the joint's name in the URDF, in its order"));
            }
        }
        let joints = read.chain.joints().to_vec();
        return Ok((Chain::new(joints, read.chain.tool() * tool), read.bodies));
    }
    let mut rows = Vec::new();
    let mut bodies = Vec::new();
    for (index, joint) in keys.joint.iter().enumerate() {
        let at = format!("joint[{}]", index + 1);
        let Some(dh) = &joint.dh else {
            return Err(check.refuse(&format!("{at}.dh"), "(missing)", "a row, or `urdf`"));
        };
        rows.push(dh_row(dh, &at, check)?);
        if let Some(link) = &joint.link {
            bodies.push(body(link, index, &at, check)?);
        }
    }
    Ok((Chain::from_dh(&rows, tool), bodies))
}

fn dh_row(dh: &DhKeys, at: &str, check: &Check) -> Result<DhRow, RobotError> {
    Ok(DhRow {
        a: check.finite(&format!("{at}.dh.a_m"), dh.a_m)?,
        alpha: check
            .finite(&format!("{at}.dh.alpha_deg"), dh.alpha_deg)?
            .to_radians(),
        d: check.finite(&format!("{at}.dh.d_m"), dh.d_m)?,
        theta: check
            .finite(&format!("{at}.dh.theta_deg"), dh.theta_deg)?
            .to_radians(),
        kind: JointKind::Revolute,
    })
}

fn body(link: &LinkKeys, joint: usize, at: &str, check: &Check) -> Result<Body, RobotError> {
    for value in link.centre_m {
        check.finite(&format!("{at}.link.centre_m"), value)?;
    }
    for value in link.inertia_kg_m2 {
        check.not_negative(&format!("{at}.link.inertia_kg_m2"), value)?;
    }
    Ok(Body {
        joint,
        mass: check.not_negative(&format!("{at}.link.mass_kg"), link.mass_kg)?,
        centre: Point3::from(link.centre_m),
        inertia: Matrix3::from_diagonal(&Vector3::from(link.inertia_kg_m2)),
    })
}

fn robot_joint(joint: &JointKeys, at: &str, check: &Check) -> Result<RobotJoint, RobotError> {
    let limits = &joint.limits;
    let limit = |key: &str, value: f64| {
        check
            .positive(&format!("{at}.limits.{key}"), value)
            .map(f64::to_radians)
    };
    let mut modes = Vec::new();
    for (index, mode) in joint.mode.iter().enumerate() {
        modes.push(mode_of_joint(
            mode,
            &format!("{at}.mode[{}]", index + 1),
            check,
        )?);
    }
    if modes.len() > super::axis::MAX_MODES {
        return Err(check.refuse(
            &format!("{at}.mode"),
            modes.len(),
            "at most 4 modes a joint",
        ));
    }
    Ok(RobotJoint {
        home: check
            .finite(&format!("{at}.home_deg"), joint.home_deg)?
            .to_radians(),
        limits: JointLimits {
            velocity: limit("velocity_deg_s", limits.velocity_deg_s)?,
            acceleration: limit("acceleration_deg_s2", limits.acceleration_deg_s2)?,
            jerk: limit("jerk_deg_s3", limits.jerk_deg_s3)?,
        },
        modes,
    })
}

fn mode_of_joint(keys: &ModeKeys, at: &str, check: &Check) -> Result<ModeOfJoint, RobotError> {
    let frequency = check.positive(&format!("{at}.frequency_hz"), keys.frequency_hz)?;
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
        bandwidth: check.positive("servo.bandwidth_hz", keys.bandwidth_hz)? * std::f64::consts::TAU,
        damping_ratio: check.positive("servo.damping_ratio", keys.damping_ratio)?,
        velocity_feed_forward: check.finite(key, keys.velocity_feed_forward)?,
    })
}

fn tracker(keys: &TrackerKeys, check: &Check) -> Result<Tracker, RobotError> {
    let skew = check.finite("tracker.clock_skew_ppm", keys.clock_skew_ppm)? * 1e-6;
    if skew <= -1.0 {
        let value = keys.clock_skew_ppm;
        return Err(check.refuse("tracker.clock_skew_ppm", value, "above -1e6"));
    }
    Ok(Tracker {
        rate: check.positive("tracker.rate_hz", keys.rate_hz)?,
        noise: check.not_negative("tracker.noise_um", keys.noise_um)? * 1e-6,
        pose: check.pose("tracker", keys.position_m, keys.rpy_deg)?,
        clock: Clock {
            offset: check.finite("tracker.clock_offset_s", keys.clock_offset_s)?,
            skew,
        },
    })
}

struct Check<'a> {
    file: &'a Path,
}

impl Check<'_> {
    fn refuse(
        &self,
        key: &str,
        value: impl std::fmt::Display,
        expected: &'static str,
    ) -> RobotError {
        let value = value.to_string();
        RobotError::Value {
            file: self.file.to_path_buf(),
            key: key.to_string(),
            value,
            expected,
        }
    }

    fn finite(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number"))
        }
    }

    fn positive(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        let holds = value.is_finite() && value > 0.0;
        if holds {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number above 0"))
        }
    }

    fn not_negative(&self, key: &str, value: f64) -> Result<f64, RobotError> {
        let holds = value.is_finite() && value >= 0.0;
        if holds {
            Ok(value)
        } else {
            Err(self.refuse(key, value, "a finite number, 0 or more"))
        }
    }

    fn pose(
        &self,
        at: &str,
        position: [f64; 3],
        rpy_deg: [f64; 3],
    ) -> Result<Isometry3<f64>, RobotError> {
        for value in position {
            self.finite(&format!("{at}.position_m"), value)?;
        }
        for value in rpy_deg {
            self.finite(&format!("{at}.rpy_deg"), value)?;
        }
        let [roll, pitch, yaw] = rpy_deg.map(f64::to_radians);
        let rotation = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
        Ok(Isometry3::from_parts(
            Translation3::from(Vector3::from(position)),
            rotation,
        ))
    }
}
