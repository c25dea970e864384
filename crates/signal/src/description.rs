//! What a robot description says of a chain: kinematics and bodies.

use std::path::Path;

use nalgebra::{Matrix3, Point3};

use super::SignalError;
use super::kinematics::Chain;
#[cfg(feature = "urdf")]
use super::urdf::parse;

/// A rigid body carried by a joint of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// Joint that moves it, counted from 0.
    pub joint: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the frame of the joint's link, m.
    pub centre: Point3<f64>,
    /// Inertia about the centre of mass, in axes parallel to the link's frame, kg m^2.
    pub inertia: Matrix3<f64>,
}

/// What a URDF file says of a chain.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfChain {
    /// Kinematics to the tip link's frame.
    pub chain: Chain,
    /// Bodies of the links along the chain that have a mass.
    pub bodies: Vec<Body>,
    /// Velocity limit of each joint, rad/s or m/s; 0 where the file gives none.
    pub velocity_limits: Vec<f64>,
}

/// Reads the chain from the base to `tip_link`, or to the link at the end of the longest chain.
///
/// Fixed joints are folded into their neighbours. Branches off the chain are left out.
///
/// # Errors
/// [`SignalError::Urdf`] with the file and the reason: unreadable, no such link, a loop, a joint of
/// a kind that a serial chain cannot hold (floating, planar, spherical) or that mimics another; always where
/// the crate is built without the feature `urdf`.
pub fn read_urdf(file: &Path, tip_link: Option<&str>) -> Result<UrdfChain, SignalError> {
    let refuse = |reason: String| SignalError::Urdf {
        file: file.to_path_buf(),
        reason,
    };
    let text = std::fs::read_to_string(file).map_err(|error| refuse(error.to_string()))?;
    parse(&text, tip_link).map_err(refuse)
}

#[cfg(not(feature = "urdf"))]
fn parse(_: &str, _: Option<&str>) -> Result<UrdfChain, String> {
    Err("this program is built without URDF: build it with the feature `urdf`".into())
}
