//! Whether intervals contain the true parameters.

use crate::truth::Truth;
use crate::verdict::Verdict;
use serde::Serialize;

/// One parameter held against the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Covered {
    /// The effect.
    pub effect: String,
    /// The parameter, as the catalogue names it.
    pub parameter: String,
    /// Its true value.
    pub truth: f64,
    /// The diagnosis's interval.
    pub ci95: [f64; 2],
    /// Whether the interval holds the truth.
    pub inside: bool,
}

/// Parameters that are the same physical quantity in the catalogue and in a generator: the effect, the
/// catalogue's name, the names in the truth. What a generator shapes otherwise than the catalogue (the
/// bristles of LuGre, the oil in a play, a damped stop) is not here.
const SAME: &[(&str, &str, &[&str])] = &[
    ("coulomb_friction", "friction", &["friction"]),
    ("smooth_coulomb_friction", "friction", &["friction"]),
    (
        "smooth_coulomb_friction",
        "transition_velocity",
        &["transition_velocity"],
    ),
    ("stribeck_friction", "friction", &["friction"]),
    ("stribeck_friction", "excess", &["excess"]),
    (
        "stribeck_friction",
        "stribeck_velocity",
        &["stribeck_velocity"],
    ),
    ("asymmetric_friction", "friction", &["friction"]),
    ("asymmetric_friction", "asymmetry", &["asymmetry"]),
    ("presliding_hysteresis", "friction", &["friction"]),
    (
        "presliding_hysteresis",
        "presliding_distance",
        &["presliding_distance"],
    ),
    ("hysteretic_stiffness", "share", &["share"]),
    (
        "hysteretic_stiffness",
        "yield_deformation",
        &["yield_deformation"],
    ),
    ("backlash", "gap", &["gap", "gap_rad"]),
    ("cubic_stiffness", "k3", &["k3"]),
    ("bilinear_stiffness", "knee", &["knee"]),
    ("quadratic_damping", "coefficient", &["coefficient"]),
    (
        "transmission_ripple",
        "amplitude",
        &["amplitude", "amp_rad"],
    ),
    ("transmission_ripple", "order", &["order", "cycles_per_rad"]),
    (
        "viscoelastic_creep",
        "relative_stiffness",
        &["relative_stiffness"],
    ),
    ("viscoelastic_creep", "time_constant", &["time_constant"]),
    ("viscous_drag", "viscous", &["viscous"]),
    ("quadratic_drag", "coefficient", &["coefficient"]),
    ("gravity_load", "amplitude", &["amplitude"]),
    ("second_mode", "natural_frequency", &["natural_frequency"]),
    ("swinging_load", "mass_ratio", &["mass_ratio"]),
    ("swinging_load", "natural_frequency", &["natural_frequency"]),
    ("payload_change", "time", &["time", "at_s"]),
    ("payload_change", "change", &["change"]),
    (
        "external_disturbance",
        "time",
        &["time", "time_2", "time_3"],
    ),
    ("external_disturbance", "jump", &["jump"]),
    ("harmonic_disturbance", "amplitude", &["amplitude"]),
    ("harmonic_disturbance", "frequency", &["frequency"]),
    ("sensor_lag", "time_constant", &["time_constant", "tau_s"]),
    (
        "sensor_lag_second_order",
        "time_constant",
        &["time_constant"],
    ),
    ("sensor_gain", "error", &["error"]),
    ("deformation_gain", "error", &["error"]),
    ("misalignment", "amplitude", &["amplitude"]),
    ("sensor_drift", "rate", &["rate"]),
    ("clock_skew", "skew", &["skew"]),
    ("force_offset", "force", &["force"]),
    ("cogging", "amplitude", &["amplitude"]),
    ("cogging", "order", &["order"]),
    ("dead_zone", "half_width", &["half_width"]),
    ("saturation", "limit", &["limit"]),
    ("drive_lag", "time_constant", &["time_constant"]),
    ("drive_delay", "delay", &["delay"]),
];

/// Effects that change the inertia on which a knock acts: the velocity then does not jump by what the
/// nominal inertia says, as the truth tells it.
const INERTIAS: &[&str] = &["pose_dependent_frequency", "payload_change"];

/// The comparable parameters of all correctly named effects.
pub(super) fn covered(truth: &Truth, verdict: &Verdict) -> Vec<Covered> {
    let mut found = Vec::new();
    let hides = |name: &&str| truth.effects.iter().any(|hidden| hidden.effect == *name);
    let other_inertia = INERTIAS.iter().any(hides);
    for hidden in &truth.effects {
        let named = verdict
            .findings
            .iter()
            .find(|finding| finding.effect == hidden.effect);
        let mut told = vec![false; hidden.parameters.len()];
        for parameter in named.iter().flat_map(|finding| &finding.parameters) {
            let name = once(&parameter.name);
            let same = SAME
                .iter()
                .find(|entry| entry.0 == hidden.effect && entry.1 == name);
            let same = same.filter(|entry| !(entry.1 == "jump" && other_inertia));
            let known = |name: &str| same.is_some_and(|entry| entry.2.contains(&name));
            // Of several events the nearest that is not yet told.
            let off = |k: &usize| (hidden.parameters[*k].1 - parameter.value).abs();
            let open = (0..told.len()).filter(|&k| !told[k] && known(&hidden.parameters[k].0));
            let Some(index) = open.min_by(|a, b| off(a).total_cmp(&off(b))) else {
                continue;
            };
            told[index] = true;
            let value = hidden.parameters[index].1;
            let [low, high] = parameter.ci95;
            found.push(Covered {
                effect: hidden.effect.clone(),
                parameter: parameter.name.clone(),
                truth: value,
                ci95: parameter.ci95,
                inside: low <= value && value <= high,
            });
        }
    }
    found
}

/// A parameter's name without the number of its event: `time` of `time_2`.
fn once(name: &str) -> &str {
    match name.rsplit_once('_') {
        Some((name, number)) if number.parse::<u32>().is_ok() => name,
        _ => name,
    }
}
