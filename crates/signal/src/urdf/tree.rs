//! All moving links in the text of a URDF file.

use nalgebra::Isometry3;
use urdf_rs::Robot;

use super::parse::{body, isometry, moving_joint};
use crate::description::{Tree, TreeJoint};

/// The tree of the moving joints. Fixed joints are folded into the links before them.
pub(super) fn tree(text: &str) -> Result<Tree, String> {
    let robot = urdf_rs::read_from_string(text).map_err(|error| error.to_string())?;
    let is_child = |name: &str| robot.joints.iter().any(|joint| joint.child.link == name);
    let mut roots = robot.links.iter().filter(|link| !is_child(&link.name));
    let root = roots.next().ok_or("no link is the base")?;
    if let Some(other) = roots.next() {
        return Err(format!(
            "both \"{}\" and \"{}\" are carried by no joint",
            root.name, other.name
        ));
    }
    let mut tree = Tree {
        joints: Vec::new(),
        bodies: Vec::new(),
    };
    // A link, its joint, and its transform relative to the link that the joint moves.
    let mut left = vec![(root.name.as_str(), None, Isometry3::identity())];
    while let Some(own) = left.pop() {
        left.extend(behind(&robot, own, &mut tree)?);
    }
    match tree.joints.is_empty() {
        true => Err("no joint moves".into()),
        false => Ok(tree),
    }
}

type Place<'a> = (&'a str, Option<usize>, Isometry3<f64>);

/// Adds the joints of a link; returns the links behind them.
fn behind<'a>(
    robot: &'a Robot,
    (name, parent, at): Place,
    tree: &mut Tree,
) -> Result<Vec<Place<'a>>, String> {
    let mut links = Vec::new();
    for joint in robot
        .joints
        .iter()
        .filter(|joint| joint.parent.link == name)
    {
        let before = at * isometry(&joint.origin);
        let (mover, pose) = match moving_joint(joint, before)? {
            None => (parent, before),
            Some(entry) => {
                let friction = joint.dynamics.as_ref();
                tree.joints.push(TreeJoint {
                    name: entry.name,
                    parent,
                    before,
                    axis: entry.axis,
                    kind: entry.kind,
                    damping: friction.map_or(0.0, |own| own.damping),
                    friction: friction.map_or(0.0, |own| own.friction),
                });
                (Some(tree.joints.len() - 1), Isometry3::identity())
            }
        };
        let child = joint.child.link.as_str();
        let link = robot.links.iter().find(|link| link.name == child);
        if let (Some(link), Some(mover)) = (link, mover) {
            tree.bodies.extend(body(&link.inertial, mover, &pose));
        }
        links.push((child, mover, pose));
    }
    Ok(links)
}
