//! The truth of a case, as its file `truth.json` tells it.

use super::families::{OUTSIDE, family};
use serde_json::{Map, Value, json};

/// One hidden effect.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HiddenEffect {
    /// Name in the catalogue of effects, or a generator's own name for what is not in it.
    pub effect: String,
    /// Where it sits; empty where the truth does not say.
    pub place: String,
    /// Its parameters.
    pub parameters: Vec<(String, f64)>,
}

/// The truth of a case.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Truth {
    /// The hidden effects; none in a clean case.
    pub effects: Vec<HiddenEffect>,
    /// Names that no motion distinguishes from the truth, if the generator knows such.
    pub equivalents: Vec<String>,
    /// Whether a catalogue of the usual physics holds all of them.
    pub in_catalogue: bool,
    /// True natural frequency, Hz (flexible joints).
    pub natural_frequency_hz: Option<f64>,
    /// True damping ratio (flexible joints).
    pub damping_ratio: Option<f64>,
    /// Standard deviation of the noise, in the SI unit of the output.
    pub noise: f64,
    /// That unit.
    pub noise_unit: String,
    /// Reading of the sensor's clock at the encoder's zero, s.
    pub clock_offset_s: Option<f64>,
    /// Rms over the noise that a refit of the nominal structure leaves.
    pub baseline_residual_over_noise: Option<f64>,
    /// Other keys of a generator.
    pub more: Map<String, Value>,
}

/// Names of other generators, and ours.
const SYNONYMS: &[(&str, &str)] = &[
    ("hardening_stiffness", "cubic_stiffness"),
    ("softening_stiffness", "cubic_stiffness"),
    ("bouc_wen", "hysteretic_stiffness"),
    ("gravity_tilt", "gravity_load"),
    ("gravity", "gravity_load"),
    ("transmission_error", "transmission_ripple"),
    ("fluid_drag", "quadratic_drag"),
    ("aerodynamic_drag", "quadratic_drag"),
    ("base_compliance", "base_mode"),
    ("lugre_friction", "presliding_hysteresis"),
    ("dahl_friction", "presliding_hysteresis"),
    ("dry_friction", "coulomb_friction"),
    ("payload", "payload_change"),
    ("sensor_scale", "sensor_gain"),
    ("knock", "external_disturbance"),
    ("knocks", "external_disturbance"),
    ("sensor_misalignment", "misalignment"),
];

/// The catalogue's name of an effect that another generator hid.
pub fn our_name(name: &str) -> &str {
    SYNONYMS
        .iter()
        .find(|pair| pair.0 == name)
        .map_or(name, |pair| pair.1)
}

impl Truth {
    /// Names of the effects joined by `+`, `none` for a clean case.
    pub fn name(&self) -> String {
        if self.effects.is_empty() {
            return "none".into();
        }
        let names: Vec<&str> = self.effects.iter().map(|e| e.effect.as_str()).collect();
        names.join("+")
    }

    /// As in `truth.json`.
    pub fn to_json(&self) -> Value {
        let mut parameters = Map::new();
        for effect in &self.effects {
            for (name, value) in &effect.parameters {
                let taken = parameters.contains_key(name);
                let key = if taken {
                    format!("{}.{name}", effect.effect)
                } else {
                    name.clone()
                };
                parameters.insert(key, json!(value));
            }
        }
        let places: Vec<&str> = self.effects.iter().map(|e| e.place.as_str()).collect();
        let effects: Vec<Value> = self.effects.iter().map(HiddenEffect::to_json).collect();
        let mut object = self.more.clone();
        object.insert("effect".into(), json!(self.name()));
        object.insert("place".into(), json!(places.join("+")));
        object.insert("parameters".into(), Value::Object(parameters));
        object.insert("effects".into(), Value::Array(effects));
        if !self.equivalents.is_empty() {
            object.insert("equivalents".into(), json!(self.equivalents));
        }
        object.insert("in_catalogue".into(), json!(self.in_catalogue));
        object.insert(
            "natural_frequency_hz".into(),
            json!(self.natural_frequency_hz),
        );
        object.insert("damping_ratio".into(), json!(self.damping_ratio));
        object.insert("noise_std".into(), json!(self.noise));
        object.insert("noise_unit".into(), json!(self.noise_unit));
        if self.noise_unit == "m" {
            object.insert("tracker_noise_m".into(), json!(self.noise));
        }
        object.insert("clock_offset_s".into(), json!(self.clock_offset_s));
        let residual = json!(self.baseline_residual_over_noise);
        object.insert("baseline_residual_over_noise".into(), residual);
        Value::Object(object)
    }

    /// Reads one case of a `truth.json`; `None` where it does not say what was hidden.
    pub fn from_json(value: &Value) -> Option<Self> {
        let mut more = value.as_object()?.clone();
        let named = more.remove("effect")?.as_str()?.to_string();
        let place = text(more.remove("place"));
        let parameters = more.remove("parameters").map_or(vec![], |p| numbers(&p));
        let effects = match more.remove("effects") {
            Some(Value::Array(list)) => list.iter().filter_map(HiddenEffect::from_json).collect(),
            _ => joined(&named, &place, &parameters),
        };
        let equivalents = match more.remove("equivalents") {
            Some(Value::Array(list)) => list.into_iter().map(|name| text(Some(name))).collect(),
            _ => Vec::new(),
        };
        let number = |value: Option<Value>| value.and_then(|value| value.as_f64());
        let unknown = effects
            .iter()
            .any(|e: &HiddenEffect| family(&e.effect) == OUTSIDE);
        let metres = more.remove("tracker_noise_m");
        let noise = more.remove("noise_std").or(metres);
        let told = more
            .remove("in_catalogue")
            .and_then(|value| value.as_bool());
        Some(Self {
            in_catalogue: told.unwrap_or(!unknown),
            effects,
            equivalents,
            natural_frequency_hz: number(more.remove("natural_frequency_hz")),
            damping_ratio: number(more.remove("damping_ratio")),
            noise: number(noise).unwrap_or(f64::NAN),
            noise_unit: match more.remove("noise_unit") {
                Some(unit) => text(Some(unit)),
                None => "m".into(),
            },
            clock_offset_s: number(more.remove("clock_offset_s")),
            baseline_residual_over_noise: number(more.remove("baseline_residual_over_noise")),
            more,
        })
    }
}

impl HiddenEffect {
    fn to_json(&self) -> Value {
        let parameters = self
            .parameters
            .iter()
            .map(|(name, value)| (name.clone(), json!(value)));
        json!({
            "effect": self.effect,
            "place": self.place,
            "parameters": parameters.collect::<Map<_, _>>(),
        })
    }

    fn from_json(value: &Value) -> Option<Self> {
        Some(Self {
            effect: our_name(value.get("effect")?.as_str()?).into(),
            place: text(value.get("place").cloned()),
            parameters: value.get("parameters").map_or(vec![], numbers),
        })
    }
}

/// Effects from names joined by `+`. With several effects the owner of each parameter is not known.
fn joined(named: &str, place: &str, parameters: &[(String, f64)]) -> Vec<HiddenEffect> {
    let names = named.split('+').map(str::trim);
    let names: Vec<&str> = names.filter(|name| !["none", ""].contains(name)).collect();
    let places: Vec<&str> = place.split('+').collect();
    let effect = |(index, name): (usize, &&str)| HiddenEffect {
        effect: our_name(name).into(),
        place: places.get(index).copied().unwrap_or_default().into(),
        parameters: parameters.to_vec(),
    };
    names.iter().enumerate().map(effect).collect()
}

fn text(value: Option<Value>) -> String {
    value
        .and_then(|value| value.as_str().map(String::from))
        .unwrap_or_default()
}

fn numbers(value: &Value) -> Vec<(String, f64)> {
    let entries = value.as_object().into_iter().flatten();
    entries
        .filter_map(|(name, value)| Some((name.clone(), value.as_f64()?)))
        .collect()
}
