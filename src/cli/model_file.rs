//! What is believed of a joint, as the model file that `quell identify --model` reads.

use quell_shapers::Mode;

use crate::signal::JointArc;

/// The text of a `flexible_joint` model: the mode, and where the tip turns about the joint.
pub fn flexible_joint(mode: Mode, arc: &JointArc) -> String {
    format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = {}\ndamping_ratio = {}\n\
         lever_arm_m = {}\ntip_height_m = {}\n",
        mode.hertz(),
        mode.damping_ratio(),
        arc.radius(),
        arc.centre().z,
    )
}
