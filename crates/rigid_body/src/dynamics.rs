//! Dynamics of a tree of rigid links: torques of a motion, inertia seen by each joint.

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use quell_signal::{Body, JointKind, Tree, TreeJoint};

/// A tree of rigid links under gravity.
///
/// A joint that slides has forces (N) where one that turns has torques (N.m), and a mass (kg) for an inertia (kg.m^2).
#[derive(Clone, Debug)]
pub struct Dynamics {
    joints: Vec<TreeJoint>,
    bodies: Vec<Body>,
    gravity: Vector3<f64>,
}

/// Motion of a link in its own frame.
#[derive(Clone, Copy)]
struct Moving {
    pose: Isometry3<f64>,
    rate: Vector3<f64>,
    angular: Vector3<f64>,
    linear: Vector3<f64>,
}

/// What a joint carries: mass, centre of mass and inertia about it, in the link's frame.
#[derive(Clone, Copy)]
struct Composite {
    mass: f64,
    moment: Vector3<f64>,
    /// About the frame's origin.
    inertia: Matrix3<f64>,
}

impl Dynamics {
    /// The dynamics of a description; `gravity` in the base frame, m/s^2.
    pub fn new(tree: &Tree, gravity: Vector3<f64>) -> Self {
        Self {
            joints: tree.joints.clone(),
            bodies: tree.bodies.clone(),
            gravity,
        }
    }

    /// The same with a body more.
    #[must_use]
    pub fn with(&self, body: Body) -> Self {
        let mut other = self.clone();
        other.bodies.push(body);
        other
    }

    /// The same links, and of their bodies this one alone: its share of the torques.
    pub(crate) fn of_body(&self, body: Body) -> Self {
        Self {
            bodies: vec![body],
            ..self.clone()
        }
    }

    /// The joints.
    pub fn joints(&self) -> &[TreeJoint] {
        &self.joints
    }

    /// The bodies.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// The joint that carries no other and is furthest from the base: where a tool is.
    pub fn last(&self) -> usize {
        let depth = |mut joint: usize| {
            let mut depth = 0;
            while let Some(parent) = self.joints[joint].parent {
                (joint, depth) = (parent, depth + 1);
            }
            depth
        };
        // Of two that are as far the first.
        let all = (0..self.joints.len()).rev();
        all.max_by_key(|&joint| depth(joint)).unwrap_or(0)
    }

    /// `tau = M(q) q'' + C(q, q') q' + g(q)`: the torques that make a motion. Each slice has a value for each joint.
    ///
    /// Source: Luh, Walker, Paul, On-line computational scheme for mechanical manipulators, ASME J. Dynamic Systems,
    /// Measurement and Control 102 (1980); Featherstone, Rigid Body Dynamics Algorithms (2008), chapter 5.
    pub fn torques(&self, q: &[f64], rate: &[f64], acceleration: &[f64]) -> Vec<f64> {
        let moving = self.moving(q, rate, acceleration);
        let mut force = vec![Vector3::zeros(); self.joints.len()];
        let mut torque = force.clone();
        for body in &self.bodies {
            let Moving {
                rate,
                angular,
                linear,
                ..
            } = moving[body.joint];
            let centre = body.centre.coords;
            let own = linear + angular.cross(&centre) + rate.cross(&rate.cross(&centre));
            let own = own * body.mass;
            force[body.joint] += own;
            torque[body.joint] +=
                body.inertia * angular + rate.cross(&(body.inertia * rate)) + centre.cross(&own);
        }
        let mut torques = vec![0.0; self.joints.len()];
        for (k, joint) in self.joints.iter().enumerate().rev() {
            torques[k] = match joint.kind {
                JointKind::Revolute => joint.axis.dot(&torque[k]),
                JointKind::Prismatic => joint.axis.dot(&force[k]),
            };
            if let Some(parent) = joint.parent {
                let pose = moving[k].pose;
                let carried = pose.rotation * force[k];
                let twist = pose.rotation * torque[k] + pose.translation.vector.cross(&carried);
                force[parent] += carried;
                torque[parent] += twist;
            }
        }
        torques
    }

    /// `M_jj(q)`: the inertia that each joint sees while all others are held.
    ///
    /// Source: Walker and Orin, Efficient dynamic computer simulation of robotic mechanisms, ASME J. Dynamic Systems,
    /// Measurement and Control 104 (1982).
    pub fn inertias(&self, q: &[f64]) -> Vec<f64> {
        let none = Composite {
            mass: 0.0,
            moment: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        };
        let mut carried = vec![none; self.joints.len()];
        for body in &self.bodies {
            let own = &mut carried[body.joint];
            let centre = body.centre.coords;
            own.mass += body.mass;
            own.moment += centre * body.mass;
            own.inertia += body.inertia + about(&centre, &centre) * body.mass;
        }
        let mut seen = vec![0.0; self.joints.len()];
        for (k, joint) in self.joints.iter().enumerate().rev() {
            let own = carried[k];
            seen[k] = match joint.kind {
                JointKind::Revolute => joint.axis.dot(&(own.inertia * joint.axis.into_inner())),
                JointKind::Prismatic => own.mass,
            };
            if let Some(parent) = joint.parent {
                let pose = joint.pose(q[k]);
                let turned = pose.rotation * own.moment;
                let shift = pose.translation.vector;
                let rotation = pose.rotation.to_rotation_matrix();
                let inertia = rotation * own.inertia * rotation.transpose()
                    + about(&shift, &turned)
                    + about(&turned, &shift)
                    + about(&shift, &shift) * own.mass;
                carried[parent].mass += own.mass;
                carried[parent].moment += turned + shift * own.mass;
                carried[parent].inertia += inertia;
            }
        }
        seen
    }

    fn moving(&self, q: &[f64], rate: &[f64], acceleration: &[f64]) -> Vec<Moving> {
        let base = Moving {
            pose: Isometry3::identity(),
            rate: Vector3::zeros(),
            angular: Vector3::zeros(),
            // A base that is pushed upwards feels as one under gravity.
            linear: -self.gravity,
        };
        let mut all: Vec<Moving> = Vec::with_capacity(self.joints.len());
        for (k, joint) in self.joints.iter().enumerate() {
            let from = joint.parent.map_or(base, |parent| all[parent]);
            all.push(joint.moved(&from, [q[k], rate[k], acceleration[k]]));
        }
        all
    }
}

trait Moves {
    fn pose(&self, q: f64) -> Isometry3<f64>;
    fn moved(&self, from: &Moving, own: [f64; 3]) -> Moving;
}

impl Moves for TreeJoint {
    /// From the frame of the link before to that of the link.
    fn pose(&self, q: f64) -> Isometry3<f64> {
        let own = match self.kind {
            JointKind::Revolute => Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&self.axis, q),
            ),
            JointKind::Prismatic => {
                Isometry3::translation(q * self.axis.x, q * self.axis.y, q * self.axis.z)
            }
        };
        self.before * own
    }

    /// The motion of the link, from that of the link before.
    fn moved(&self, from: &Moving, [q, rate, acceleration]: [f64; 3]) -> Moving {
        let pose = self.pose(q);
        let back = pose.rotation.inverse();
        let arm = pose.translation.vector;
        let carried = back * from.rate;
        let linear =
            from.linear + from.angular.cross(&arm) + from.rate.cross(&from.rate.cross(&arm));
        let along = self.axis.into_inner() * rate;
        let own = self.axis.into_inner() * acceleration;
        let mut moving = Moving {
            pose,
            rate: carried,
            angular: back * from.angular,
            linear: back * linear,
        };
        match self.kind {
            JointKind::Revolute => {
                moving.rate += along;
                moving.angular += own + carried.cross(&along);
            }
            JointKind::Prismatic => moving.linear += own + 2.0 * carried.cross(&along),
        }
        moving
    }
}

/// `(a . b) 1 - b a'`: the inertia about the origin of a mass at `a` with first moment `b`.
fn about(a: &Vector3<f64>, b: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * a.dot(b) - b * a.transpose()
}
