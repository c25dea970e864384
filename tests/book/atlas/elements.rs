//! Elements of MuJoCo's models of the two machines.

use super::arm::Arm;
use super::drawing::short;
use super::mjcf::Mjcf;
use std::f64::consts::TAU;

/// Joint stiffness (N m/rad) of the flexible joint for a link of 1 kg m^2.
pub fn stiffness(arm: &Arm) -> f64 {
    let (frequency, _) = arm.model.mode().expect("a joint");
    (TAU * frequency).powi(2)
}

/// Its damping, N m s/rad.
pub fn damping(arm: &Arm) -> f64 {
    let (frequency, ratio) = arm.model.mode().expect("a joint");
    2.0 * ratio * TAU * frequency
}

/// Time step of both models, s.
pub const STEP: f64 = 5e-4;
const OPTION: &str = "<option timestep=\"0.0005\" integrator=\"implicitfast\"/>";

/// The machine without an effect.
pub fn plain(arm: &Arm) -> Mjcf {
    let none = String::new();
    match arm.model.mode() {
        Some(_) => Mjcf {
            option: OPTION.into(),
            motor: "<joint name=\"motor\" axis=\"0 0 1\"/>".into(),
            transmission: spring(arm, &[], &[], ""),
            inertial: "<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"1 1 1\"/>".into(),
            carried: none.clone(),
            tendon: link("", ""),
            actuator: none,
            sensor: "<tendonpos name=\"link\" tendon=\"link\"/>".into(),
        },
        None => Mjcf {
            option: OPTION.into(),
            motor: axis(50.0),
            transmission: none.clone(),
            inertial: "<inertial pos=\"0 0 0\" mass=\"10\" diaginertia=\"1 1 1\"/>".into(),
            carried: none.clone(),
            tendon: none,
            actuator: servo(""),
            sensor: "<jointpos name=\"position\" joint=\"axis\"/>".into(),
        },
    }
}

/// The joint between motor side and link: linear spring and damper, then what they have beyond, then other attributes.
pub fn spring(arm: &Arm, spring: &[f64], damper: &[f64], more: &str) -> String {
    let list = |linear: f64, rest: &[f64]| {
        let all = std::iter::once(&linear).chain(rest).map(|own| short(*own));
        all.collect::<Vec<_>>().join(" ")
    };
    format!(
        "<joint name=\"transmission\" axis=\"0 0 1\" stiffness=\"{}\" damping=\"{}\"{more}/>",
        list(stiffness(arm), spring),
        list(damping(arm), damper),
    )
}

/// The joint of the axis.
pub fn axis(damping: f64) -> String {
    format!(
        "<joint name=\"axis\" type=\"slide\" axis=\"1 0 0\" damping=\"{}\"/>",
        short(damping)
    )
}

/// The position loop: 1000 (60 (u - x) - v).
pub fn servo(more: &str) -> String {
    format!("<position name=\"servo\" joint=\"axis\" kp=\"60000\" kv=\"1000\"{more}/>")
}

/// The link's angle in space, with attributes and further joints.
pub fn link(attributes: &str, joints: &str) -> String {
    format!(
        "<fixed name=\"link\"{attributes}>\n<joint joint=\"motor\" coef=\"1\"/>\n<joint joint=\"transmission\" \
         coef=\"1\"/>\n{joints}</fixed>"
    )
}

/// A motor without electrics, which has friction or cogging alone.
pub fn passive(at: &str, what: &str) -> String {
    format!("<dcmotor {at} input=\"none\" motorconst=\"0\" resistance=\"1\" {what}/>")
}

/// A constant force on a joint.
pub fn constant(joint: &str, force: f64) -> String {
    let force = short(force);
    format!(
        "<general joint=\"{joint}\" gainprm=\"0\" biastype=\"affine\" biasprm=\"{force} 0 0\"/>"
    )
}

/// Friction of bristles of a stiffness and a damping.
pub fn lugre([stiffness, damping]: [f64; 2], levels: [f64; 2], stribeck: f64) -> String {
    let [stiffness, damping, stribeck] = [stiffness, damping, stribeck].map(short);
    let [kinetic, breakaway] = levels.map(short);
    format!("lugre=\"{stiffness} {damping} {kinetic} {breakaway} {stribeck}\"")
}

/// A joint that swings by itself: an inertia, its frequency and its damping ratio.
pub fn resonance(name: &str, [inertia, frequency, ratio]: [f64; 3], more: &str) -> String {
    let spring = short(inertia.abs() * frequency * frequency);
    let damper = short(2.0 * ratio * inertia.abs() * frequency);
    format!(
        "<joint name=\"{name}\" axis=\"0 0 1\" stiffness=\"{spring}\" damping=\"{damper}\"{more}/>"
    )
}
