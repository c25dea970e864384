//! A robot's description.

use super::fields::Sources;

/// Tables of the file, in its order.
const TABLES: [&str; 11] = [
    "MoveKeys",
    "ControllerKeys",
    "PoseKeys",
    "ServoKeys",
    "EncoderKeys",
    "TrackerKeys",
    "JointKeys",
    "DhKeys",
    "LimitKeys",
    "ModeKeys",
    "LinkKeys",
];

pub fn page() -> String {
    let sources = Sources::of(&["crates/simulation/src/plant/robot_file/keys.rs"]);
    let mut page = format!(
        "# The robot file\n\n`quell move --robot FILE`, `quell simulate --robot FILE`, and `service.description` of \
         `quell.toml` read it. [Your own robot](../start/robot.md) shows how to write one. `examples/robots/` and \
         `crates/simulation/src/plant/rx170.toml`, the embedded arm, are examples.\n\n## File\n\n{}",
        sources.fields("RobotFile")
    );
    for name in TABLES {
        let title = name.trim_end_matches("Keys");
        page += &format!("## {title}\n\n{}", sources.fields(name));
    }
    page
}
