//! The chain in the text of a URDF file.

use nalgebra::{Isometry3, Matrix3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use urdf_rs::{JointType, Pose};

use crate::description::{Body, UrdfChain};
use crate::kinematics::{Chain, ChainJoint, JointKind};

/// The chain from the base to `tip_link`, or to the link at the end of the longest chain.
pub(super) fn parse(text: &str, tip_link: Option<&str>) -> Result<UrdfChain, String> {
    let robot = urdf_rs::read_from_string(text).map_err(|error| error.to_string())?;
    let tip = match tip_link {
        Some(name) if robot.links.iter().any(|link| link.name == name) => name,
        Some(name) => return Err(format!("no link is named \"{name}\"")),
        None => deepest_link(&robot)?,
    };
    let path = path_to(&robot, tip)?;
    if path
        .iter()
        .all(|joint| joint.joint_type == JointType::Fixed)
    {
        return Err(format!(
            "no joint moves between the base and link \"{tip}\""
        ));
    }
    let mut result = UrdfChain {
        chain: Chain::new(Vec::new(), Isometry3::identity()),
        bodies: Vec::new(),
        velocity_limits: Vec::new(),
    };
    let mut joints = Vec::new();
    let mut pending = Isometry3::identity();
    for joint in path {
        pending *= isometry(&joint.origin);
        if let Some(entry) = moving_joint(joint, pending)? {
            joints.push(entry);
            result.velocity_limits.push(joint.limit.velocity);
            pending = Isometry3::identity();
        }
        let child = robot
            .links
            .iter()
            .find(|link| link.name == joint.child.link);
        if let (Some(link), Some(last)) = (child, joints.len().checked_sub(1)) {
            result.bodies.extend(body(&link.inertial, last, &pending));
        }
    }
    result.chain = Chain::new(joints, pending);
    Ok(result)
}

/// Joints from the base to the link, in that order.
fn path_to<'a>(robot: &'a urdf_rs::Robot, tip: &str) -> Result<Vec<&'a urdf_rs::Joint>, String> {
    let mut path: Vec<&urdf_rs::Joint> = Vec::new();
    let mut link = tip;
    while let Some(joint) = robot.joints.iter().find(|joint| joint.child.link == link) {
        if path.len() >= robot.joints.len() {
            return Err(format!("the joints above link \"{tip}\" form a loop"));
        }
        path.push(joint);
        link = &joint.parent.link;
    }
    path.reverse();
    Ok(path)
}

fn deepest_link(robot: &urdf_rs::Robot) -> Result<&str, String> {
    let mut best: Option<(usize, &str)> = None;
    for link in &robot.links {
        let depth = path_to(robot, &link.name)?.len();
        if best.is_none_or(|(deepest, _)| depth > deepest) {
            best = Some((depth, &link.name));
        }
    }
    best.map(|(_, name)| name)
        .ok_or_else(|| "the file has no links".to_string())
}

pub(super) fn moving_joint(
    joint: &urdf_rs::Joint,
    before: Isometry3<f64>,
) -> Result<Option<ChainJoint>, String> {
    let kind = match joint.joint_type {
        JointType::Fixed => return Ok(None),
        JointType::Revolute | JointType::Continuous => JointKind::Revolute,
        JointType::Prismatic => JointKind::Prismatic,
        ref other => {
            return Err(format!(
                "joint \"{}\" is {other:?}: not part of a serial chain",
                joint.name
            ));
        }
    };
    if joint.mimic.is_some() {
        return Err(format!(
            "joint \"{}\" mimics another: not a serial chain",
            joint.name
        ));
    }
    let axis = Unit::try_new(Vector3::from(joint.axis.xyz.0), 1e-9)
        .ok_or_else(|| format!("joint \"{}\" has an axis of length 0", joint.name))?;
    let after = Isometry3::identity();
    Ok(Some(ChainJoint {
        name: joint.name.clone(),
        before,
        axis,
        kind,
        after,
    }))
}

pub(super) fn body(
    inertial: &urdf_rs::Inertial,
    joint: usize,
    link: &Isometry3<f64>,
) -> Option<Body> {
    let mass = inertial.mass.value;
    if mass <= 0.0 {
        return None;
    }
    let pose = link * isometry(&inertial.origin);
    let i = &inertial.inertia;
    let tensor = Matrix3::new(
        i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz,
    );
    let rotation = pose.rotation.to_rotation_matrix();
    Some(Body {
        joint,
        mass,
        centre: Point3::from(pose.translation.vector),
        inertia: rotation * tensor * rotation.transpose(),
    })
}

pub(super) fn isometry(pose: &Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = pose.rpy.0;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(pose.xyz.0)),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}
