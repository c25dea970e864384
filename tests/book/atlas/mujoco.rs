//! How an effect is written for MuJoCo, where it has an element for it.

use super::arm::Arm;
use super::drawing::short;
use super::elements::{
    STEP, axis, constant, damping, link, lugre, passive, plain, resonance, servo, spring, stiffness,
};
use super::mjcf::Mjcf;
use quell::model::Term;
use std::f64::consts::PI;

/// How MuJoCo holds an effect.
pub enum Form {
    /// By this model, whose law is the same.
    Same(Box<Mjcf>),
    /// By this model, which differs from the law as the sentence says.
    Like(Box<Mjcf>, &'static str),
    /// Not at all; the sentence says what to do.
    None(&'static str),
}

const BRISTLES: &str = "MuJoCo's LuGre friction has bristles in the place of sticking: stiffer ones need a shorter time step.";
const LOOP: &str =
    "Its control is the force that the loop asks for: the loop itself is the program's.";

const READING: &str = "MuJoCo's sensors have a delay, an interval and a cutoff, and no such law: apply it to the reading.";
const CONTROL: &str = "MuJoCo has no element for it: apply the law to the control, in the program or in the callback `mjcb_control`.";
const FORCE: &str =
    "MuJoCo has no element for it: apply the law as a force in the callback `mjcb_passive`.";

/// Effects for which MuJoCo has no element, and what to do.
const ABSENT: [(&str, &str); 22] = [
    ("smooth_coulomb_friction", FORCE),
    ("hysteretic_stiffness", FORCE),
    ("bilinear_stiffness", FORCE),
    ("viscoelastic_creep", FORCE),
    (
        "stiffness_drift",
        "MuJoCo's stiffness is constant: change `mjModel.jnt_stiffness` between steps.",
    ),
    (
        "transmission_ripple",
        "MuJoCo has no element for it: move `mjModel.qpos_spring` of the joint with the motor side, between steps.",
    ),
    (
        "pose_dependent_frequency",
        "MuJoCo takes it from the geometry: model the bodies that fold and reach out.",
    ),
    (
        "swinging_load",
        "MuJoCo takes it from the geometry: hang a body below the link on a hinge, and give gravity.",
    ),
    (
        "payload_change",
        "MuJoCo's inertias are constant: change `mjModel.body_mass` and `body_inertia` at that time, then call `mj_setConst`.",
    ),
    (
        "external_disturbance",
        "MuJoCo has no element for it: add the jump to `mjData.qvel`, or a force to `mjData.qfrc_applied`, at that time.",
    ),
    (
        "harmonic_disturbance",
        "MuJoCo has no element for it: add the force to `mjData.qfrc_applied` at each step.",
    ),
    (
        "torque_constant_nonlinearity",
        "MuJoCo's gain is constant or affine in position and velocity: take `gaintype=\"user\"` and the callback `mjcb_act_gain`.",
    ),
    ("dead_zone", CONTROL),
    ("rate_limit", CONTROL),
    ("sensor_lag", READING),
    ("sensor_lag_second_order", READING),
    ("sensor_gain", READING),
    ("deformation_gain", READING),
    ("misalignment", READING),
    ("sensor_drift", READING),
    ("quantisation", READING),
    (
        "clock_skew",
        "MuJoCo has one clock: stretch the stamps of the readings.",
    ),
];

/// How MuJoCo holds the effect at its size.
///
/// # Panics
/// Where this file does not say it.
pub fn form(arm: &Arm, term: &Term) -> Form {
    let name = term.effect.name;
    if let Some((_, note)) = ABSENT.iter().find(|own| own.0 == name) {
        return Form::None(note);
    }
    let ways = [dry, smooth, structure, drive];
    let mut known = ways.iter().filter_map(|way| way(arm, name, &term.values));
    known
        .next()
        .unwrap_or_else(|| panic!("{}: how does MuJoCo hold {name}?", file!()))
}

fn same(mjcf: Mjcf) -> Option<Form> {
    Some(Form::Same(Box::new(mjcf)))
}

fn like(mjcf: Mjcf, note: &'static str) -> Option<Form> {
    Some(Form::Like(Box::new(mjcf), note))
}

/// Dry friction. Forces of a joint are told as the deformation that they cause.
fn dry(arm: &Arm, name: &str, p: &[f64]) -> Option<Form> {
    let base = plain(arm);
    let k = arm.model.mode().map_or(1.0, |_| stiffness(arm));
    let holds = |force: f64| {
        // As it is by default, the friction of MuJoCo creeps where it should stick.
        let solver = "solreffriction=\"0.002 1\" solimpfriction=\"0.999 0.999 0.001\"";
        let more = format!(" frictionloss=\"{}\"\n  {solver}", short(force * k));
        spring(arm, &[], &[], &more)
    };
    let bristles = |bent: [f64; 2], levels: [f64; 2], stribeck: f64| {
        let times = |values: [f64; 2]| values.map(|value| value * k);
        passive(
            "joint=\"transmission\"",
            &lugre(times(bent), times(levels), stribeck),
        )
    };
    match name {
        "coulomb_friction" => same(Mjcf {
            transmission: holds(p[0]),
            ..base
        }),
        "asymmetric_friction" => same(Mjcf {
            transmission: holds(p[0]),
            actuator: constant("transmission", -p[0] * p[1] * k),
            ..base
        }),
        "stribeck_friction" => like(
            Mjcf {
                actuator: bristles([100.0, 0.0], [p[0], p[0] * (1.0 + p[1])], p[2]),
                ..base
            },
            BRISTLES,
        ),
        "presliding_hysteresis" => same(Mjcf {
            actuator: bristles(
                [p[0] / p[1], p[4] * p[0] / p[1]],
                [p[0], p[0] * (1.0 + p[2])],
                p[3],
            ),
            ..base
        }),
        "stiction" => {
            let friction = passive(
                "joint=\"axis\"",
                &lugre([1e6, 0.0], [p[0] * p[1], p[0]], 1e-3),
            );
            like(
                Mjcf {
                    actuator: format!("{}\n{friction}", base.actuator),
                    ..base
                },
                BRISTLES,
            )
        }
        _ => None,
    }
}

/// Springs, dampers and forces that depend on the position.
fn smooth(arm: &Arm, name: &str, p: &[f64]) -> Option<Form> {
    arm.model.mode()?;
    let base = plain(arm);
    let k = stiffness(arm);
    match name {
        "cubic_stiffness" => same(Mjcf {
            transmission: spring(arm, &[0.0, p[0] * k], &[], ""),
            ..base
        }),
        "quadratic_damping" => same(Mjcf {
            transmission: spring(arm, &[], &[p[0] * k], ""),
            ..base
        }),
        "viscous_drag" => same(Mjcf {
            tendon: link(&format!(" damping=\"{}\"", short(p[0] * k)), ""),
            ..base
        }),
        "quadratic_drag" => same(Mjcf {
            tendon: link(&format!(" damping=\"0 {}\"", short(p[0] * k)), ""),
            ..base
        }),
        "cogging" => {
            // The law resists, the motor's torque drives.
            let law = [p[0] * k, p[1], p[2] + PI].map(short).join(" ");
            let actuator = passive("tendon=\"link\"", &format!("cogging=\"{law}\""));
            same(Mjcf { actuator, ..base })
        }
        "gravity_load" => {
            let lever = p[0] * k / 9.81;
            let [x, y] = [lever * p[1].cos(), lever * p[1].sin()].map(short);
            let own = short(1.0 - lever * lever);
            same(Mjcf {
                option: base
                    .option
                    .replace("<option ", "<option gravity=\"0 -9.81 0\" "),
                inertial: format!(
                    "<inertial pos=\"{x} {y} 0\" mass=\"1\" diaginertia=\"1 1 {own}\"/>"
                ),
                ..base
            })
        }
        _ => None,
    }
}

/// Play, stops, further modes, and the sensor.
fn structure(arm: &Arm, name: &str, p: &[f64]) -> Option<Form> {
    arm.model.mode()?;
    let base = plain(arm);
    let k = stiffness(arm);
    match name {
        "backlash" => {
            let (half, film) = (short(0.5 * p[0]), short(p[1] * damping(arm)));
            let gear = spring(arm, &[], &[], " armature=\"0.01\"");
            let gap = format!(
                "<joint name=\"gap\" axis=\"0 0 1\" range=\"-{half} {half}\" damping=\"{film}\"/>"
            );
            let mjcf = Mjcf {
                transmission: format!("{gear}\n{gap}"),
                tendon: link("", "<joint joint=\"gap\" coef=\"1\"/>\n"),
                ..base
            };
            like(
                mjcf,
                "A second joint has the play. Between both is a small inertia, `armature`: MuJoCo needs one.",
            )
        }
        "end_stop" => {
            let [end, spring, damper] = [p[1], p[0] * k, p[0] * p[2] * k].map(short);
            let range = match p[4] > 0.0 {
                true => format!("-10 {end}"),
                false => format!("{end} 10"),
            };
            let limit = format!(" range=\"{range}\" solreflimit=\"-{spring} -{damper}\"");
            like(
                Mjcf {
                    tendon: link(&limit, ""),
                    ..base
                },
                "A limit is a constraint: its stiffness is told as an acceleration, and MuJoCo scales it by `solimplimit`.",
            )
        }
        "second_mode" => {
            let i = short(p[0].abs());
            let carried = format!(
                "<body name=\"tool\">\n{}\n<inertial pos=\"0 0 0\" mass=\"{i}\" diaginertia=\"{i} {i} {i}\"/>\n</body>",
                resonance("tool", [p[0], p[1], p[2]], "")
            );
            like(
                Mjcf { carried, ..base },
                "How much the sensor sees of the mode follows from the inertia of the part that swings; here the inertia is the share.",
            )
        }
        "base_mode" => {
            let inertia = 1.0 / p[0].abs();
            let own = format!(" armature=\"{}\"", short(inertia));
            let joint = resonance("base", [inertia, p[1], p[2]], &own);
            like(
                Mjcf {
                    motor: format!("{joint}\n{}", base.motor),
                    ..base
                },
                "How much the sensor sees of the mode follows from the base's inertia, `armature`; here it is the link's over the share.",
            )
        }
        "sensor_delay" => {
            let samples = (p[0] / STEP).ceil() + 2.0;
            let delay = format!(
                "delay=\"{}\" nsample=\"{samples}\" interp=\"linear\"",
                short(p[0])
            );
            same(Mjcf {
                sensor: base.sensor.replace("/>", &format!(" {delay}/>")),
                ..base
            })
        }
        _ => None,
    }
}

/// What the axis has.
fn drive(arm: &Arm, name: &str, p: &[f64]) -> Option<Form> {
    let base = plain(arm);
    match name {
        "viscous_friction" => same(Mjcf {
            motor: axis(50.0 + p[0]),
            ..base
        }),
        "force_offset" => {
            let actuator = format!("{}\n{}", base.actuator, constant("axis", -p[0]));
            same(Mjcf { actuator, ..base })
        }
        "saturation" => {
            let limit = short(p[0]);
            same(Mjcf {
                actuator: servo(&format!(" forcerange=\"-{limit} {limit}\"")),
                ..base
            })
        }
        "drive_lag" => {
            let lag = short(p[0]);
            let actuator = format!(
                "<general name=\"drive\" joint=\"axis\" dyntype=\"filterexact\" dynprm=\"{lag}\"/>"
            );
            like(Mjcf { actuator, ..base }, LOOP)
        }
        "drive_delay" => {
            let (delay, samples) = (short(p[0]), (p[0] / STEP).ceil());
            let actuator = format!(
                "<motor name=\"drive\" joint=\"axis\" delay=\"{delay}\" nsample=\"{samples}\"/>"
            );
            like(Mjcf { actuator, ..base }, LOOP)
        }
        _ => None,
    }
}
