//! Kinematics against hand values, differences, and another description of the same arm.

use nalgebra::{Isometry3, Point3};
use quell::plant::Robot;
use quell::signal::{Chain, DhRow, JointKind, SignalError, read_urdf};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

#[test]
fn val_rx170_stands_where_its_dimensions_say() {
    let robot = Robot::rx170();
    let tip = robot.chain.tip(&robot.home());
    // Shoulder 0.15 out and 0.55 up, upper arm 0.85 at 45 deg, forearm 0.75 + wrist 0.10 + tool 0.22 level.
    let arm = 0.85 * (PI / 4.0).sin();
    assert!((tip.x - (0.15 + arm + 1.07)).abs() < 1e-12, "{tip}");
    assert!(
        tip.y.abs() < 1e-12 && (tip.z - (0.55 + arm)).abs() < 1e-12,
        "{tip}"
    );
    let arc = robot.arc(&robot.home(), 0).unwrap();
    assert!((arc.radius() - tip.x).abs() < 1e-12);
    // Straight up at zero: on the axis' side, 0.15 m out.
    let up = robot.chain.tip(&[]);
    assert!(
        (up.x - 0.15).abs() < 1e-12 && (up.z - (0.55 + 0.85 + 1.07)).abs() < 1e-12,
        "{up}"
    );
}

#[test]
fn val_the_tangent_of_an_arc_is_the_derivative_of_the_tip() {
    let robot = Robot::rx170();
    let q = [0.3, 0.5, 0.9, -0.4, 0.7, 0.2];
    // The sixth turns the tip about itself.
    for joint in 0..5 {
        let arc = robot.arc(&q, joint).unwrap();
        let tangent = arc.tangent(q[joint]);
        let at = |step: f64| {
            let mut moved = q;
            moved[joint] += step;
            robot.chain.tip(&moved)
        };
        let difference = (at(1e-5) - at(-1e-5)) / 2e-5;
        // Central difference: h^2 / 6 of a third derivative of 2 m, 3e-11, and its rounding.
        assert!((tangent - difference).norm() < 1e-9, "joint {joint}");
    }
    let beyond = robot.arc(&q, 6).unwrap_err();
    assert_eq!(
        beyond,
        SignalError::NoSuchJoint {
            joint: 7,
            joints: 6
        }
    );
    assert!(matches!(
        robot.arc(&[0.0; 6], 5),
        Err(SignalError::TipOnAxis { joint: 6, .. })
    ));
    let slide = DhRow {
        a: 1.0,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        kind: JointKind::Prismatic,
    };
    let chain = Chain::from_dh(&[slide], Isometry3::identity());
    assert!((chain.tip(&[0.5]).z - 0.5).abs() < 1e-15);
    assert!(matches!(
        chain.arc(&[0.0], 0),
        Err(SignalError::NotRevolute { joint: 1 })
    ));
}

#[test]
fn a_urdf_of_the_same_arm_has_the_same_tip_and_inertia() {
    let text = r#"<robot name="two">
      <link name="base"/>
      <link name="upper"><inertial><origin xyz="0.5 0 0" rpy="0 0 0"/><mass value="4"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.3"/></inertial></link>
      <link name="lower"/><link name="tool"/><link name="camera"/>
      <joint name="shoulder" type="revolute"><origin xyz="0 0 0.4" rpy="0 0 0"/>
        <parent link="base"/><child link="upper"/><axis xyz="0 0 2"/>
        <limit effort="1" velocity="3" lower="-1" upper="1"/></joint>
      <joint name="elbow" type="continuous"><origin xyz="1 0 0" rpy="1.5707963267948966 0 0"/>
        <parent link="upper"/><child link="lower"/><axis xyz="0 0 1"/></joint>
      <joint name="flange" type="fixed"><origin xyz="0.8 0 0" rpy="0 0 0"/>
        <parent link="lower"/><child link="tool"/></joint>
      <joint name="side" type="fixed"><origin xyz="0 1 0" rpy="0 0 0"/>
        <parent link="base"/><child link="camera"/></joint>
    </robot>"#;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("two.urdf");
    std::fs::write(&file, text).unwrap();
    let read = read_urdf(&file, None).unwrap();
    let names: Vec<&str> = read
        .chain
        .joints()
        .iter()
        .map(|j| j.name.as_str())
        .collect();
    assert_eq!(names, ["shoulder", "elbow"]);
    assert_eq!(read.velocity_limits[0], 3.0);
    let row = |a, alpha, d| DhRow {
        a,
        alpha,
        d,
        theta: 0.0,
        kind: JointKind::Revolute,
    };
    let same = Chain::from_dh(
        &[row(1.0, FRAC_PI_2, 0.4), row(0.8, 0.0, 0.0)],
        Isometry3::identity(),
    );
    for q in [[0.0, 0.0], [0.7, -0.4], [-2.0, 1.3]] {
        assert!((read.chain.tip(&q) - same.tip(&q)).norm() < 1e-12, "{q:?}");
    }
    assert!((read.bodies[0].centre - Point3::new(0.5, 0.0, 0.0)).norm() < 1e-12);
    for (from, to, says) in [
        ("type=\"continuous\"", "type=\"floating\"", "elbow"),
        ("xyz=\"0 0 2\"", "xyz=\"0 0 0\"", "shoulder"),
        ("<robot", "<robo", "two.urdf"),
    ] {
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let error = read_urdf(&file, None).unwrap_err().to_string();
        assert!(
            error.contains(says) && error.contains("two.urdf"),
            "{error}"
        );
    }
    std::fs::write(&file, text).unwrap();
    let error = read_urdf(&file, Some("hand")).unwrap_err().to_string();
    assert!(error.contains("hand"), "{error}");
    assert!(
        read_urdf(Path::new("none.urdf"), None)
            .unwrap_err()
            .to_string()
            .contains("none.urdf")
    );
}
