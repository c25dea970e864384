//! Kinematics and masses of a description: Denavit-Hartenberg rows, or a URDF file.

use std::path::Path;

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};

use super::check::Check;
use super::keys::{DhKeys, LinkKeys, RobotFile};
use crate::plant::RobotError;
use quell_signal::{Body, Chain, DhRow, JointKind, read_urdf};

/// Chain and bodies from the URDF file, or from the Denavit-Hartenberg rows.
pub fn kinematics(keys: &RobotFile, check: &Check) -> Result<(Chain, Vec<Body>), RobotError> {
    let tool = check.pose("tool", keys.tool.position_m, keys.tool.rpy_deg)?;
    match &keys.urdf {
        Some(urdf) => from_urdf(urdf, keys, tool, check),
        None => from_dh(keys, tool, check),
    }
}

/// The keys beside the URDF file must not contradict it.
fn from_urdf(
    urdf: &Path,
    keys: &RobotFile,
    tool: Isometry3<f64>,
    check: &Check,
) -> Result<(Chain, Vec<Body>), RobotError> {
    for (index, joint) in keys.joint.iter().enumerate() {
        let given = [("dh", joint.dh.is_some()), ("link", joint.link.is_some())];
        if let Some((key, _)) = given.iter().find(|(_, given)| *given) {
            let key = format!("joint[{}].{key}", index + 1);
            return Err(check.refuse(&key, "(given)", "nothing: the URDF says it already"));
        }
    }
    let path = check.file.parent().unwrap_or(Path::new("")).join(urdf);
    let read =
        read_urdf(&path, keys.tip_link.as_deref()).map_err(|reason| RobotError::Kinematics {
            file: check.file.to_path_buf(),
            reason,
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
    Ok((Chain::new(joints, read.chain.tool() * tool), read.bodies))
}

fn from_dh(
    keys: &RobotFile,
    tool: Isometry3<f64>,
    check: &Check,
) -> Result<(Chain, Vec<Body>), RobotError> {
    if let Some(link) = &keys.tip_link {
        return Err(check.refuse(
            "tip_link",
            link,
            "nothing without `urdf`: rows have no names",
        ));
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
        kind: match dh.slides {
            true => JointKind::Prismatic,
            false => JointKind::Revolute,
        },
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
