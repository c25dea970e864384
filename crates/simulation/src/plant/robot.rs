//! A robot for simulation: kinematics, masses, modes, servo, sensors, limits.

use nalgebra::{Isometry3, Point3};
use quell_shapers::{Mode, ModeError};
use quell_trajectories::Limits;
use serde::Deserialize;

use quell_signal::{Body, Chain, Clock, DeformationSensor, JointArc, SignalError};

/// Where the damper of a mode is attached.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Damping {
    /// Between motor side and link: `delta'' + 2 xi w delta' + w^2 delta = -u''`.
    AcrossJoint,
    /// Between link and ground: `delta'' + 2 xi w delta' + w^2 delta = -u'' - 2 xi w u'`.
    ToGround,
}

/// A mode of a joint in the reference condition: home pose, no payload.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModeOfJoint {
    /// `omega_n` and `xi` in the reference condition.
    pub mode: Mode,
    /// Where its damper is attached.
    pub damping: Damping,
    /// Share of the motor's acceleration that drives it; 1 for a single mode.
    pub participation: f64,
}

/// The description of one joint beside its kinematics.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotJoint {
    /// Position in the reference pose, rad, or m for a joint that slides.
    pub home: f64,
    /// Limits of the command, with m for rad where it slides.
    pub limits: Limits,
    /// Modes in the reference condition, the dominating one first; empty for a stiff joint.
    pub modes: Vec<ModeOfJoint>,
}

/// Servo between command `r` and motor position `u`:
/// `u'' + 2 z w u' + w^2 u = w^2 r + f 2 z w r'`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servo {
    /// `w`, rad/s.
    pub bandwidth: f64,
    /// `z`.
    pub damping_ratio: f64,
    /// `f`: at 1 the servo follows constant velocity without lag.
    pub velocity_feed_forward: f64,
}

/// Motor-side encoder, on the controller's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Samples per second, Hz.
    pub rate: f64,
    /// Step of the reading, rad; 0 for none.
    pub resolution: f64,
}

/// Laser tracker that sees the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tracker {
    /// Samples per second of its own clock, Hz.
    pub rate: f64,
    /// Standard deviation of each coordinate, m.
    pub noise: f64,
    /// Its frame in the robot's base frame: maps tracker coordinates to base coordinates.
    pub pose: Isometry3<f64>,
    /// Offset and skew of its clock.
    pub clock: Clock,
}

/// The default move, from the home pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DefaultMove {
    /// Joint, counted from 0.
    pub joint: usize,
    /// Displacement, rad.
    pub target: f64,
}

/// A robot; SI throughout.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Name.
    pub name: String,
    /// Kinematics to the tip.
    pub chain: Chain,
    /// Bodies that give the inertia; may be empty, then modes do not depend on pose or payload.
    pub bodies: Vec<Body>,
    /// One entry for each joint of the chain.
    pub joints: Vec<RobotJoint>,
    /// Servo of the moved joint.
    pub servo: Servo,
    /// Encoder of the moved joint.
    pub encoder: Encoder,
    /// Sensor of the tip.
    pub tracker: Tracker,
    /// Commands per second, Hz.
    pub control_rate: f64,
    /// The default move.
    pub default_move: DefaultMove,
}

impl Robot {
    /// The reference pose, rad.
    pub fn home(&self) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.home).collect()
    }

    /// Inertia of everything that joint `joint` carries, about its axis, kg m^2:
    /// `J = sum z'I z + m |z x (c - o)|^2`, with the payload (kg) as a point at the tip.
    ///
    /// # Errors
    /// [`SignalError::NoSuchJoint`].
    pub fn inertia(&self, pose: &[f64], payload: f64, joint: usize) -> Result<f64, SignalError> {
        let (origin, axis) = self.chain.joint_axis(pose, joint)?;
        let point = |mass: f64, at: Point3<f64>| mass * axis.cross(&(at - origin)).norm_squared();
        let mut sum = point(payload, self.chain.tip(pose));
        for body in self.bodies.iter().filter(|body| body.joint >= joint) {
            let frame = self.chain.link_pose(pose, body.joint);
            let local = frame.rotation.inverse() * axis.into_inner();
            sum += local.dot(&(body.inertia * local)) + point(body.mass, frame * body.centre);
        }
        Ok(sum)
    }

    /// A mode of `joint` at a pose and payload (kg): stiffness and damper constant, so
    /// `omega = omega_ref sqrt(J_ref / J)` and `xi = xi_ref sqrt(J_ref / J)`.
    ///
    /// Without bodies in the description the mode stays as in the reference condition.
    ///
    /// # Errors
    /// [`ModeError`] where the damping ratio leaves `[0, 1)`.
    pub fn mode_at(
        &self,
        reference: Mode,
        joint: usize,
        pose: &[f64],
        payload: f64,
    ) -> Result<Mode, ModeError> {
        let inertia = |pose: &[f64], payload| self.inertia(pose, payload, joint).unwrap_or(0.0);
        let (at_home, now) = (inertia(&self.home(), 0.0), inertia(pose, payload));
        let scale = if at_home > 0.0 && now > 0.0 {
            (at_home / now).sqrt()
        } else {
            1.0
        };
        Mode::new(
            reference.natural_frequency() * scale,
            reference.damping_ratio() * scale,
        )
    }

    /// The arc of the tip about `joint`.
    ///
    /// # Errors
    /// As [`Chain::arc`].
    pub fn arc(&self, pose: &[f64], joint: usize) -> Result<JointArc, SignalError> {
        self.chain.arc(pose, joint)
    }

    /// The on-line deformation sensor of `joint` for a tracker whose frame and clock are known.
    ///
    /// # Errors
    /// As [`Chain::arc`].
    pub fn deformation_sensor(
        &self,
        pose: &[f64],
        joint: usize,
    ) -> Result<DeformationSensor, SignalError> {
        let arc = self.arc(pose, joint)?;
        Ok(DeformationSensor::new(
            arc,
            self.tracker.pose,
            self.tracker.clock,
        ))
    }
}
