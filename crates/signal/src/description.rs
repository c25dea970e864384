//! The chain of a robot description: kinematics and bodies.

use nalgebra::{Isometry3, Matrix3, Point3, Unit, Vector3};

use super::kinematics::{Chain, JointKind};

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

/// One joint of a tree of links.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeJoint {
    /// Name in the robot's description.
    pub name: String,
    /// Index of the joint before it, counted from 0; `None` at the base.
    pub parent: Option<usize>,
    /// From the frame of the link before to the frame of its own link at `q = 0`.
    pub before: Isometry3<f64>,
    /// Axis of the motion, in either frame.
    pub axis: Unit<Vector3<f64>>,
    /// Turns or slides.
    pub kind: JointKind,
    /// Viscous friction in the description, N.m.s/rad or N.s/m; 0 without one.
    pub damping: f64,
    /// Dry friction in the description, N.m or N; 0 without one.
    pub friction: f64,
}

/// All moving links of a description; each joint comes after its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// The joints.
    pub joints: Vec<TreeJoint>,
    /// Bodies of the links that move and have a mass.
    pub bodies: Vec<Body>,
}
