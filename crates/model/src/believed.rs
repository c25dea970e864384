//! The believed mode of a joint, as the model file that `quell identify --model` reads.

use quell_recording::to_resolution;
use quell_shapers::Mode;

use quell_signal::JointArc;

/// The text of a `flexible_joint` model: the mode and, if the tip is measured, the geometry of its circle about
/// the joint.
pub fn flexible_joint(mode: Mode, arc: Option<&JointArc>) -> String {
    let tip = arc.map(|arc| {
        format!(
            "lever_arm_m = {}\ntip_height_m = {}\n",
            to_resolution(arc.radius()),
            to_resolution(arc.centre().z)
        )
    });
    format!(
        "kind = \"flexible_joint\"\nnatural_frequency_hz = {}\ndamping_ratio = {}\n{}",
        to_resolution(mode.hertz()),
        to_resolution(mode.damping_ratio()),
        tip.unwrap_or_default(),
    )
}
