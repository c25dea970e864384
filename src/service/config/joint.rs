//! One joint of the configuration, filled up from the robot's description.

use quell_shapers::{Mode, ModeError, Shaper, shaper_by_name};
use quell_trajectories::Limits;

use super::keys::{JointKeys, estimators};
use super::{Check, ConfigError};
use crate::estimators::{EstimatorEntry, estimator};
use crate::plant::{Robot, RobotJoint};
use crate::service::following::healthy;
use crate::service::remembered::{LONGEST_MOVE, LONGEST_PERIOD, LONGEST_TRAIN};
use crate::service::shapers;
use crate::signal::JointArc;

/// Range of targets if the configuration names none, rad: a turn either way.
const RANGE: [f64; 2] = [-core::f64::consts::TAU, core::f64::consts::TAU];
/// Default belief of a joint: typical of robot arms.
pub(super) const BELIEF: (f64, f64) = (10.0, 0.05);
/// Range of an encoder's step, deg.
const COARSEST: [f64; 2] = [0.0, 60.0];
/// Highest value of a limit, in degrees and seconds.
const HIGHEST: f64 = 1e9;

/// One joint that is commanded.
#[derive(Clone)]
pub struct JointConfig {
    /// Name.
    pub name: String,
    /// The joint of the description, counted from 0.
    pub index: usize,
    /// Lowest and highest target, rad.
    pub range: [f64; 2],
    /// Whether that is only a turn either way, because none was given for this robot.
    pub range_assumed: bool,
    /// Limits of the command.
    pub limits: Limits,
    /// Following error that is a fault, rad.
    pub following_limit: f64,
    /// Whether any limit is that of the embedded arm, because none was given for this robot.
    pub limits_assumed: bool,
    /// The mode that is shaped for until a better one is learned.
    pub belief: Mode,
    /// The rule that designs trains.
    pub shaper: &'static dyn Shaper,
    /// Method of estimation.
    pub estimator: &'static EstimatorEntry,
    /// Whether plans are shaped.
    pub shaping: bool,
    /// Whether the train follows the estimate.
    pub adaptation: bool,
    /// Samples a second of the sensor of tip, link or deformation, Hz.
    pub sensor_rate: f64,
    /// Step of the encoder's reading, rad.
    pub encoder_resolution: f64,
    /// Full scale of the deformation's sensor, rad.
    pub deformation_range: f64,
    /// The tip's arc, where the joint turns the tip.
    pub arc: Option<JointArc>,
}

impl JointConfig {
    /// Logs range and limits in force, with a warning if nothing was said of them for this robot.
    pub fn warn_of_limits(&self) {
        if self.range_assumed {
            tracing::warn!(
                joint = self.name,
                "nothing says where this joint may go: it may go a turn either way. Give range_deg"
            );
        }
        if self.limits_assumed {
            tracing::warn!(
                joint = self.name,
                "nothing says what this joint may do: the limits of the embedded arm are in force. \
                 Give service.description, or velocity_deg_s, acceleration_deg_s2 and jerk_deg_s3"
            );
        }
        tracing::info!(
            joint = self.name,
            range_rad = ?self.range,
            velocity_rad_s = self.limits.velocity,
            acceleration_rad_s2 = self.limits.acceleration,
            jerk_rad_s3 = self.limits.jerk,
            "range and limits in force"
        );
    }
}

pub(super) fn checked(
    keys: &JointKeys,
    at: &str,
    robot: &Robot,
    check: &Check,
) -> Result<JointConfig, ConfigError> {
    let key = |name: &str| format!("{at}.{name}");
    let number = keys.number.unwrap_or(robot.default_move.joint + 1);
    let index = number.checked_sub(1).filter(|&i| i < robot.joints.len());
    let Some(index) = index else {
        let expected = format!("the number of a joint, from 1 to {}", robot.joints.len());
        return Err(check.refuse(&key("number"), number, expected));
    };
    let range = keys
        .range_deg
        .map_or(RANGE, |range| range.map(f64::to_radians));
    if !(range[0].is_finite() && range[1].is_finite() && range[0] < range[1]) {
        let given = format!("{:?}", keys.range_deg.unwrap_or_default());
        return Err(check.refuse(
            &key("range_deg"),
            given,
            "two finite numbers, the lower first",
        ));
    }
    let described = &robot.joints[index];
    let sensor_rate = keys.sensor_rate_hz.unwrap_or(robot.tracker.rate);
    let described_resolution = robot.encoder.resolution.to_degrees();
    let resolution = keys.encoder_resolution_deg.unwrap_or(described_resolution);
    let full_scale = keys.deformation_range_deg.unwrap_or(f64::MAX);
    let limits = limits(keys, at, described, check)?;
    let following = keys.following_error_deg.map(f64::to_radians);
    let following = following.unwrap_or_else(|| healthy(limits.acceleration));
    Ok(JointConfig {
        name: keys.name.clone(),
        index,
        range,
        range_assumed: false,
        limits,
        following_limit: check
            .within(
                &key("following_error_deg"),
                following.to_degrees(),
                [1e-3, 360.0],
            )?
            .to_radians(),
        limits_assumed: false,
        belief: belief(keys, at, described, check)?,
        shaper: shaper(keys, &key("shaper"), check)?,
        estimator: estimator(&keys.estimator)
            .ok_or_else(|| check.unknown(&key("estimator"), &keys.estimator, estimators()))?,
        shaping: keys.shaping,
        adaptation: keys.adaptation,
        sensor_rate: check.within(&key("sensor_rate_hz"), sensor_rate, [1.0, 1e5])?,
        encoder_resolution: check
            .within(&key("encoder_resolution_deg"), resolution, COARSEST)?
            .to_radians(),
        deformation_range: check
            .positive(&key("deformation_range_deg"), full_scale, f64::MAX)?
            .to_radians(),
        arc: robot.arc(&robot.home(), index).ok(),
    })
}

fn shaper(keys: &JointKeys, key: &str, check: &Check) -> Result<&'static dyn Shaper, ConfigError> {
    match shaper_by_name(&keys.shaper) {
        Some(shaper) if shaper.is_convex() => Ok(shaper),
        Some(shaper) => Err(check.refuse(key, format!("{:?}", shaper.name()), shapers::POSITIVE)),
        None => Err(check.unknown(key, &keys.shaper, shapers::names())),
    }
}

fn limits(
    keys: &JointKeys,
    at: &str,
    described: &RobotJoint,
    check: &Check,
) -> Result<Limits, ConfigError> {
    let limit = |name: &str, given: Option<f64>, described: f64| -> Result<f64, ConfigError> {
        let value = given.unwrap_or(described.to_degrees());
        check.positive(&format!("{at}.{name}"), value, HIGHEST)?;
        Ok(given.map_or(described, f64::to_radians))
    };
    let Limits {
        velocity,
        acceleration,
        jerk,
    } = described.limits;
    Ok(Limits {
        velocity: limit("velocity_deg_s", keys.velocity_deg_s, velocity)?,
        acceleration: limit(
            "acceleration_deg_s2",
            keys.acceleration_deg_s2,
            acceleration,
        )?,
        jerk: limit("jerk_deg_s3", keys.jerk_deg_s3, jerk)?,
    })
}

fn belief(
    keys: &JointKeys,
    at: &str,
    described: &RobotJoint,
    check: &Check,
) -> Result<Mode, ConfigError> {
    let (frequency, damping) = match described.modes.first() {
        Some(entry) => (entry.mode.hertz(), entry.mode.damping_ratio()),
        None => BELIEF,
    };
    let frequency = keys.frequency_hz.unwrap_or(frequency);
    let damping = keys.damping_ratio.unwrap_or(damping);
    let slowest = 1.0 / LONGEST_PERIOD;
    if frequency > 0.0 && frequency < slowest {
        let expected = format!(
            "at least {slowest} Hz: a train of {LONGEST_TRAIN} periods takes {LONGEST_MOVE} s then"
        );
        return Err(check.refuse(&format!("{at}.frequency_hz"), frequency, expected));
    }
    Mode::from_hertz(frequency, damping).map_err(|error| {
        let (key, value, expected) = match error {
            ModeError::NaturalFrequency(_) => ("frequency_hz", frequency, "finite and above 0"),
            ModeError::DampingRatio(_) => ("damping_ratio", damping, "0 or more, below 1"),
        };
        check.refuse(&format!("{at}.{key}"), value, expected)
    })
}
