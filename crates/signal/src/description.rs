//! The chain of a robot description: kinematics and bodies.

use nalgebra::{Matrix3, Point3};

use super::kinematics::Chain;

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

/// The chain of a URDF file.
#[derive(Clone, Debug, PartialEq)]
pub struct UrdfChain {
    /// Kinematics to the tip link's frame.
    pub chain: Chain,
    /// Bodies of the links along the chain that have a mass.
    pub bodies: Vec<Body>,
    /// Velocity limit of each joint, rad/s or m/s; 0 where the file gives none.
    pub velocity_limits: Vec<f64>,
}
