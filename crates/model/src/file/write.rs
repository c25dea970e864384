//! A model as the text of its file.

use super::super::{Model, ModelEffect, Value};
use super::HOLDS;
use super::learned::VALUES;
use crate::effects::{ParameterRole, Quantity, Units};
use std::fmt::Write;

impl Model {
    /// The text of the model's file; [`Model::from_toml`] reads the same model back, to the bit.
    ///
    /// A key that has its default is left out unless the model's own file gave it.
    pub fn to_toml(&self) -> String {
        let mut text = format!("kind = \"{}\"\n", self.kind.name);
        if let Some((_, name)) = HOLDS.iter().find(|entry| Some(entry.0) == self.hold) {
            line(&mut text, "input_hold", &format!("\"{name}\""), None);
        }
        for (index, key) in self.kind.keys.iter().enumerate() {
            let value = &self.values[index];
            if self.given[index] || Some(*value) != key.default.map(Value::from) {
                // A name that ends in its unit needs no comment.
                let told = ["_hz", "_m", "_s"]
                    .iter()
                    .any(|unit| key.name.ends_with(unit));
                let unit = self.unit(key.quantity).filter(|_| !told);
                line(&mut text, key.name, &inline(value), unit);
            }
        }
        for effect in &self.effects {
            text.push_str("\n[[effect]]\n");
            line(
                &mut text,
                "name",
                &format!("\"{}\"", effect.effect.name),
                None,
            );
            line(
                &mut text,
                "place",
                &format!("\"{}\"", effect.place.name()),
                None,
            );
            text.push_str("[effect.parameters]\n");
            if effect.effect.is_learned() {
                self.write_learned(&mut text, effect);
                continue;
            }
            for (parameter, value) in effect.effect.parameters.iter().zip(&effect.parameters) {
                let unit = self.unit(parameter.quantity);
                line(&mut text, parameter.name, &inline(value), unit);
            }
        }
        text
    }

    /// A learned law: its range, and its values at the knots as one list.
    fn write_learned(&self, text: &mut String, effect: &ModelEffect) {
        let (mut values, mut unit) = (Vec::new(), None);
        for (parameter, value) in effect.effect.parameters.iter().zip(&effect.parameters) {
            if parameter.role != ParameterRole::Range {
                values.push(inline(value));
                unit = self.unit(parameter.quantity);
                continue;
            }
            // The end of a range is never fitted: it need not be said.
            let value = Value {
                fixed: false,
                ..*value
            };
            let unit = self.unit(parameter.quantity);
            line(text, parameter.name, &inline(&value), unit);
        }
        line(text, VALUES, &format!("[{}]", values.join(", ")), unit);
    }

    /// A unit in terms of the recording's; forces divided by a stiffness are positions.
    fn unit(&self, quantity: Quantity) -> Option<String> {
        let force = if self.kind.normalised {
            "position"
        } else {
            "force"
        };
        let unit = quantity.unit(&Units {
            force: force.into(),
            position: "position".into(),
            input: "input".into(),
        });
        (unit != "1").then_some(unit)
    }
}

fn line(text: &mut String, key: &str, value: &str, unit: Option<String>) {
    let comment = unit.map_or(String::new(), |unit| format!("  # {unit}"));
    // Writing to a string does not fail.
    let _ = writeln!(text, "{key} = {value}{comment}");
}

fn inline(value: &Value) -> String {
    let number = format!("{:?}", value.value);
    let mut parts = Vec::new();
    parts.extend(value.std.map(|std| format!("std = {std:?}")));
    let bounds = value.bounds;
    parts.extend(bounds.map(|(low, high)| format!("bounds = [{low:?}, {high:?}]")));
    parts.extend(value.fixed.then(|| "fixed = true".to_string()));
    match parts.is_empty() {
        true => number,
        false => format!("{{ value = {number}, {} }}", parts.join(", ")),
    }
}
