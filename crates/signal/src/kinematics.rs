//! Kinematics of a serial arm: pose of the tip, Jacobian column of a joint, the arc it sweeps.

use nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};

use super::SignalError;

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns about its axis; coordinate in rad.
    Revolute,
    /// Slides along its axis; coordinate in m.
    Prismatic,
}

/// One row of the standard (distal) Denavit-Hartenberg table.
///
/// The link transform is `Rz(theta + q) Tz(d) Tx(a) Rx(alpha)`, for a sliding joint
/// `Rz(theta) Tz(d + q) Tx(a) Rx(alpha)`.
///
/// Source: Denavit and Hartenberg, "A kinematic notation for lower-pair mechanisms based on
/// matrices", ASME J. Applied Mechanics 22 (1955).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DhRow {
    /// Length along the new x axis, m.
    pub a: f64,
    /// Twist about the new x axis, rad.
    pub alpha: f64,
    /// Length along the joint's axis, m.
    pub d: f64,
    /// Angle about the joint's axis at `q = 0`, rad.
    pub theta: f64,
    /// Whether `q` adds to `theta` or to `d`.
    pub kind: JointKind,
}

/// One joint of a chain: a fixed transform, the motion, a fixed transform.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainJoint {
    /// Name in the robot's description.
    pub name: String,
    /// From the frame of the link before to the joint's frame at `q = 0`.
    pub before: Isometry3<f64>,
    /// Axis of the motion in the joint's frame.
    pub axis: Unit<Vector3<f64>>,
    /// Turns or slides.
    pub kind: JointKind,
    /// From the moved joint's frame to the frame of its link.
    pub after: Isometry3<f64>,
}

impl ChainJoint {
    fn motion(&self, q: f64) -> Isometry3<f64> {
        match self.kind {
            JointKind::Revolute => Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_axis_angle(&self.axis, q),
            ),
            JointKind::Prismatic => Isometry3::from_parts(
                Translation3::from(self.axis.into_inner() * q),
                UnitQuaternion::identity(),
            ),
        }
    }
}

/// A serial chain from the base to the tip of the tool.
///
/// A configuration `q` is a slice, rad or m, one value a joint; joints beyond its end stand at 0.
/// Joints are counted from 0 in code. No method allocates.
///
/// # Example
/// ```
/// use quell_signal::{Chain, DhRow, JointKind};
/// // Two links of 1 m in a plane: stretched out the tip is at (2, 0, 0), bent by 90 deg at (1, 1, 0).
/// let row = DhRow { a: 1.0, alpha: 0.0, d: 0.0, theta: 0.0, kind: JointKind::Revolute };
/// let chain = Chain::from_dh(&[row, row], nalgebra::Isometry3::identity());
/// assert!((chain.tip(&[0.0, 0.0]).x - 2.0).abs() < 1e-15);
/// assert!((chain.tip(&[0.0, core::f64::consts::FRAC_PI_2]).y - 1.0).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    joints: Vec<ChainJoint>,
    tool: Isometry3<f64>,
}

impl Chain {
    /// A chain of joints and the transform from the last link to the tip.
    pub fn new(joints: Vec<ChainJoint>, tool: Isometry3<f64>) -> Self {
        Self { joints, tool }
    }

    /// A chain from the rows of a Denavit-Hartenberg table; joints are named `joint_1`, `joint_2`...
    pub fn from_dh(rows: &[DhRow], tool: Isometry3<f64>) -> Self {
        let about_z = |angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let joints = rows.iter().enumerate().map(|(index, row)| ChainJoint {
            name: format!("joint_{}", index + 1),
            before: Isometry3::from_parts(Translation3::identity(), about_z(row.theta)),
            axis: Vector3::z_axis(),
            kind: row.kind,
            after: Isometry3::from_parts(
                Translation3::new(row.a, 0.0, row.d),
                UnitQuaternion::from_axis_angle(&Vector3::x_axis(), row.alpha),
            ),
        });
        Self {
            joints: joints.collect(),
            tool,
        }
    }

    /// The joints, from the base on.
    pub fn joints(&self) -> &[ChainJoint] {
        &self.joints
    }

    /// The transform from the last link to the tip.
    pub fn tool(&self) -> &Isometry3<f64> {
        &self.tool
    }

    /// Frame of link `link` (that joint `link` moves) in the base frame.
    pub fn link_pose(&self, q: &[f64], link: usize) -> Isometry3<f64> {
        let mut pose = Isometry3::identity();
        for (index, joint) in self.joints.iter().enumerate().take(link + 1) {
            let value = q.get(index).copied().unwrap_or(0.0);
            pose = pose * joint.before * joint.motion(value) * joint.after;
        }
        pose
    }

    /// Pose of the tip in the base frame: forward kinematics.
    fn tip_pose(&self, q: &[f64]) -> Isometry3<f64> {
        match self.joints.len() {
            0 => self.tool,
            n => self.link_pose(q, n - 1) * self.tool,
        }
    }

    /// Position of the tip in the base frame, m.
    pub fn tip(&self, q: &[f64]) -> Point3<f64> {
        Point3::from(self.tip_pose(q).translation.vector)
    }

    /// A point on the joint's axis and the axis' direction, in the base frame.
    ///
    /// # Errors
    /// [`SignalError::NoSuchJoint`].
    pub fn joint_axis(
        &self,
        q: &[f64],
        joint: usize,
    ) -> Result<(Point3<f64>, Unit<Vector3<f64>>), SignalError> {
        let Some(entry) = self.joints.get(joint) else {
            return Err(SignalError::NoSuchJoint {
                joint: joint + 1,
                joints: self.joints.len(),
            });
        };
        let parent = if joint == 0 {
            Isometry3::identity()
        } else {
            self.link_pose(q, joint - 1)
        };
        let frame = parent * entry.before;
        Ok((
            Point3::from(frame.translation.vector),
            frame.rotation * entry.axis,
        ))
    }

    /// The arc of the tip in the base frame when only `joint` turns; the others stay as in `q`.
    ///
    /// # Errors
    /// [`SignalError::NoSuchJoint`], [`SignalError::NotRevolute`], or [`SignalError::TipOnAxis`]
    /// where the tip is within 1 um of the axis.
    pub fn arc(&self, q: &[f64], joint: usize) -> Result<JointArc, SignalError> {
        let (origin, axis) = self.joint_axis(q, joint)?;
        if self.joints[joint].kind != JointKind::Revolute {
            return Err(SignalError::NotRevolute { joint: joint + 1 });
        }
        let arm = self.tip(q) - origin;
        let along = axis.dot(&arm);
        // Turned back by the joint's own angle: the tip at zero.
        let own = q.get(joint).copied().unwrap_or(0.0);
        let radial =
            UnitQuaternion::from_axis_angle(&axis, -own) * (arm - axis.into_inner() * along);
        if radial.norm() < 1e-6 {
            return Err(SignalError::TipOnAxis {
                joint: joint + 1,
                radius: radial.norm(),
            });
        }
        Ok(JointArc::new(
            origin + axis.into_inner() * along,
            axis,
            radial,
        ))
    }
}

/// The circle that the tip draws when one joint turns: `p(q) = c + cos q r + sin q (z x r)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointArc {
    centre: Point3<f64>,
    axis: Unit<Vector3<f64>>,
    radial: Vector3<f64>,
    tangential: Vector3<f64>,
}

impl JointArc {
    /// A circle about `axis` through `centre`; `radial` leads from there to the tip at angle 0, m.
    ///
    /// Only the part of `radial` that is perpendicular to the axis counts.
    pub fn new(centre: Point3<f64>, axis: Unit<Vector3<f64>>, radial: Vector3<f64>) -> Self {
        let radial = radial - axis.into_inner() * axis.dot(&radial);
        Self {
            centre,
            axis,
            radial,
            tangential: axis.cross(&radial),
        }
    }

    /// The arc about the base frame's z axis of a tip known only by its lever arm and height, m.
    ///
    /// # Errors
    /// [`SignalError::Length`] where the lever arm is not above 0 or a value is not finite.
    ///
    /// # Example
    /// ```
    /// let arc = quell_signal::JointArc::from_lever_arm(1.8, 0.9).unwrap();
    /// assert_eq!(arc.tip(0.0), nalgebra::Point3::new(1.8, 0.0, 0.9));
    /// ```
    pub fn from_lever_arm(lever_arm: f64, tip_height: f64) -> Result<Self, SignalError> {
        if !(lever_arm.is_finite() && lever_arm > 0.0) {
            return Err(SignalError::Length {
                name: "lever_arm",
                value: lever_arm,
            });
        }
        if !tip_height.is_finite() {
            return Err(SignalError::Length {
                name: "tip_height",
                value: tip_height,
            });
        }
        let centre = Point3::new(0.0, 0.0, tip_height);
        Ok(Self::new(
            centre,
            Vector3::z_axis(),
            Vector3::x() * lever_arm,
        ))
    }

    /// Tip at joint angle `q` (rad), m.
    pub fn tip(&self, q: f64) -> Point3<f64> {
        self.tip_and_tangent(q).0
    }

    /// `J = dp/dq` at joint angle `q` (rad), m/rad.
    pub fn tangent(&self, q: f64) -> Vector3<f64> {
        self.tip_and_tangent(q).1
    }

    /// [`JointArc::tip`] and [`JointArc::tangent`].
    pub fn tip_and_tangent(&self, q: f64) -> (Point3<f64>, Vector3<f64>) {
        let (sin, cos) = q.sin_cos();
        (
            self.centre + self.radial * cos + self.tangential * sin,
            self.tangential * cos - self.radial * sin,
        )
    }

    /// Radius of the circle, m: the lever arm that turns rad at the joint into m at the tip.
    pub fn radius(&self) -> f64 {
        self.radial.norm()
    }

    /// Centre of the circle, m.
    pub fn centre(&self) -> Point3<f64> {
        self.centre
    }

    /// Direction of the joint's axis.
    pub fn axis(&self) -> Unit<Vector3<f64>> {
        self.axis
    }
}
