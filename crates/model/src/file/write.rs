//! A model as the text of its file.

use super::super::{Model, ModelEffect, Value};
use super::HOLDS;
use super::learned::VALUES;
use crate::effects::{ParameterRole, Quantity, Units};
use std::fmt::Write;

impl Model {
    /// The text of the model's file; [`Model::from_toml`] reads back the identical model.
    ///
    /// A key that has its default is left out unless the model's own file gave it.
    pub fn to_toml(&self) -> String {
        let force = if self.kind.normalised {
            "position"
        } else {
            "force"
        };
        self.to_toml_in(&Units {
            force: force.into(),
            position: "position".into(),
            input: "input".into(),
            reference: "input".into(),
        })
    }

    /// The same with the units of a recording in its comments.
    pub fn to_toml_in(&self, units: &Units) -> String {
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
                let unit = unit(key.quantity, units).filter(|_| !told);
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
                write_learned(&mut text, effect, units);
                continue;
            }
            let pairs = effect.effect.parameters.iter().zip(&effect.parameters);
            for (index, (parameter, value)) in pairs.enumerate() {
                if effect.effect.is_without(index, value.value) {
                    continue;
                }
                let unit = unit(parameter.quantity, units);
                line(&mut text, parameter.name, &inline(value), unit);
            }
        }
        text
    }
}

/// The unit of a quantity; none of a number.
fn unit(quantity: Quantity, units: &Units) -> Option<String> {
    let unit = quantity.unit(units);
    (unit != "1").then_some(unit)
}

/// A learned law: its range, and its values at the knots as one list.
fn write_learned(text: &mut String, effect: &ModelEffect, units: &Units) {
    let (mut values, mut of_values) = (Vec::new(), None);
    for (parameter, value) in effect.effect.parameters.iter().zip(&effect.parameters) {
        if parameter.role != ParameterRole::Range {
            values.push(inline(value));
            of_values = unit(parameter.quantity, units);
            continue;
        }
        // The end of a range is never fitted, so that `fixed` is omitted.
        let value = Value {
            fixed: false,
            ..*value
        };
        line(
            text,
            parameter.name,
            &inline(&value),
            unit(parameter.quantity, units),
        );
    }
    line(text, VALUES, &format!("[{}]", values.join(", ")), of_values);
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
