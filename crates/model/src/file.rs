//! Model files: `model.toml`, read with the line of each error.
//!
//! ```toml
//! kind = "rigid_axis"
//! mass = { value = 95.1, std = 2.0, bounds = [50.0, 150.0] }
//! viscous = 203.5               # a number alone is a value
//! input_hold = "zero_order"     # or "linear", "spline"
//!
//! [[effect]]
//! name = "coulomb_friction"     # a name of the catalogue
//! place = "drive"
//! [effect.parameters]
//! friction = { value = 20.4, fixed = true }
//!
//! [[effect]]
//! name = "learned_spring"       # a law whose shape is learned
//! place = "transmission"
//! [effect.parameters]
//! from = -0.01                  # the range over which the knots lie
//! to = 0.01
//! values = [-3.1, -1.2, ...]    # the law at the knots
//! ```

mod learned;
mod signs;
mod source;
mod write;

use super::{Hold, KINDS, Kind, Model, ModelEffect, Value};
use crate::effects::{EFFECTS, Effect, LEARNED, Place};
use signs::signs;
use source::{Entry, Source, Table, list};
use std::path::{Path, PathBuf};

/// Why a model file was refused.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("cannot read the model {}", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// The file is no TOML.
    #[error("{}:{line}:{column}: {reason}", file.display())]
    Syntax {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in it, in characters from 1.
        column: usize,
        /// The fault.
        reason: String,
    },
    /// A key is missing or unknown, or its value is of the wrong type or out of its range.
    #[error("{}:{line}: {key}: {reason}", file.display())]
    Key {
        /// The file.
        file: PathBuf,
        /// Line, from 1.
        line: usize,
        /// The key.
        key: String,
        /// The bad value, and what it should be.
        reason: String,
    },
}

/// The course of an input between samples, as files name it.
const HOLDS: &[(Hold, &str)] = &[
    (Hold::Spline, "spline"),
    (Hold::Linear, "linear"),
    (Hold::ZeroOrder, "zero_order"),
];

impl Model {
    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`] with the file, the line and the key.
    pub fn from_path(path: impl AsRef<Path>) -> Result<Self, ModelError> {
        let file = path.as_ref();
        let text = std::fs::read_to_string(file).map_err(|source| ModelError::Read {
            file: file.to_path_buf(),
            source,
        })?;
        Self::from_toml(&text, file)
    }

    /// Reads a model from the text of a file, which errors name.
    ///
    /// # Errors
    /// [`ModelError`] with the file, the line and the key.
    ///
    /// # Example
    /// ```
    /// use quell_model::Model;
    /// let text = "kind = \"rigid_axis\"\nmass = 95.1\nviscous = { value = 203.5, std = 4 }\n";
    /// let model = Model::from_toml(text, "model.toml").unwrap();
    /// assert_eq!(model.value("viscous"), Some(203.5));
    /// let error = Model::from_toml("kind = \"rigid_axes\"", "model.toml").err().unwrap();
    /// assert!(error.to_string().contains("did you mean \"rigid_axis\"?"));
    /// ```
    pub fn from_toml(text: &str, file: impl AsRef<Path>) -> Result<Self, ModelError> {
        let source = Source {
            file: file.as_ref(),
            text,
        };
        let document = source.document()?;
        let mut table = Table::new(&source, &document);
        let kind = kind(&mut table)?;
        let hold = hold(&mut table)?;
        let entries = kind.keys.iter().map(|key| table.take(key.name));
        let entries: Vec<Option<Entry>> = entries.collect();
        let effects = match table.take("effect") {
            Some(entry) => entry.tables(&source)?,
            None => Vec::new(),
        };
        table.finish(kind.keys.iter().map(|key| key.name))?;
        let mut model = Self {
            kind,
            values: Vec::new(),
            given: entries.iter().map(Option::is_some).collect(),
            hold,
            effects: Vec::new(),
        };
        for (index, (key, entry)) in kind.keys.iter().zip(entries).enumerate() {
            model.values.push(match (entry, key.default) {
                (Some(entry), Some(default)) if entry.is(default) => {
                    // A term that is switched off has no scale for a fit.
                    model.given[index] = key.range.0 <= default && default <= key.range.1;
                    default.into()
                }
                (Some(entry), _) => value(&source, &entry, key.range)?,
                (None, Some(default)) => default.into(),
                (None, None) => return Err(table.needed(key.name, kind)),
            });
        }
        for table in effects {
            model.effects.push(effect(&source, kind, table)?);
        }
        Ok(model)
    }

    /// Value of a key that the file gives.
    pub fn given(&self, name: &str) -> Option<f64> {
        let index = self.kind.keys.iter().position(|key| key.name == name)?;
        self.given[index].then_some(self.values[index].value)
    }
}

/// The kind that has this name and takes these keys.
fn kind(table: &mut Table) -> Result<&'static Kind, ModelError> {
    let entry = table.take("kind").ok_or_else(|| table.missing("kind"))?;
    let name = entry.text(table.source)?;
    let named: Vec<&'static Kind> = KINDS.iter().copied().filter(|k| k.name == name).collect();
    let names = || KINDS.iter().map(|kind| kind.name);
    if named.is_empty() {
        return Err(entry.unknown(table.source, name, names()));
    }
    table.anchor(&entry);
    // Two kinds of one name differ in their required keys.
    let missing = |kind: &&&Kind| {
        let keys = kind.keys.iter();
        let needed = keys.filter(|key| key.default.is_none() && !table.holds(key.name));
        needed.count()
    };
    let stray = |kind: &&&Kind| table.strays(kind.keys.iter().map(|key| key.name));
    let best = named.iter().min_by_key(|k| (stray(k), missing(k)));
    Ok(best.copied().unwrap_or(named[0]))
}

fn hold(table: &mut Table) -> Result<Option<Hold>, ModelError> {
    let Some(entry) = table.take("input_hold") else {
        return Ok(None);
    };
    let name = entry.text(table.source)?;
    match HOLDS.iter().find(|hold| hold.1 == name) {
        Some(hold) => Ok(Some(hold.0)),
        None => Err(entry.unknown(table.source, name, HOLDS.iter().map(|hold| hold.1))),
    }
}

/// A number, or a table of what is known of it, within a range.
fn value(source: &Source, entry: &Entry, range: (f64, f64)) -> Result<Value, ModelError> {
    let check = |entry: &Entry, number: f64| match range.0 <= number && number <= range.1 {
        true => Ok(number),
        false => Err(entry.refuse(
            source,
            format!("{number:?} is not within {:?} ... {:?}", range.0, range.1),
        )),
    };
    if !entry.is_table() {
        return Ok(check(entry, entry.number(source)?)?.into());
    }
    let mut table = entry.table(source)?;
    table.anchor(entry);
    let (number, std) = (table.take("value"), table.take("std"));
    let (bounds, fixed) = (table.take("bounds"), table.take("fixed"));
    table.finish(["value", "std", "bounds", "fixed"])?;
    let number = number.ok_or_else(|| table.missing("value"))?;
    let mut value = Value::from(check(&number, number.number(source)?)?);
    if let Some(entry) = std {
        let std = entry.number(source)?;
        if !(std > 0.0 && std.is_finite()) {
            return Err(entry.refuse(source, format!("{std:?} is not a finite number above 0")));
        }
        value.std = Some(std);
    }
    if let Some(entry) = bounds {
        let (low, high) = entry.pair(source)?;
        if !(low < high && low <= value.value && value.value <= high) {
            let wanted = "the first must be below the second, and the value between them";
            return Err(entry.refuse(source, format!("[{low:?}, {high:?}]: {wanted}")));
        }
        // A wide bound does not allow a meaningless value either.
        value.bounds = Some((low.max(range.0), high.min(range.1)));
    }
    if let Some(entry) = fixed {
        value.fixed = entry.truth(source)?;
    }
    Ok(value)
}

fn effect(
    source: &Source,
    kind: &'static Kind,
    mut table: Table,
) -> Result<ModelEffect, ModelError> {
    let entry = table.take("name").ok_or_else(|| table.missing("name"))?;
    table.anchor(&entry);
    let name = entry.text(source)?;
    let names = || EFFECTS.iter().chain(LEARNED).map(|effect| effect.name);
    let effect = Effect::from_name(name).ok_or_else(|| entry.unknown(source, name, names()))?;
    let place = place(source, kind, effect, &mut table)?;
    let given = table.take("parameters");
    table.finish(["name", "place", "parameters"])?;
    let given = given.ok_or_else(|| table.missing("parameters"))?;
    let mut given_table = given.table(source)?;
    given_table.anchor(&entry);
    if effect.is_learned() {
        let (effect, parameters) = learned::parameters(source, effect, given_table)?;
        return Ok(ModelEffect {
            effect,
            place,
            parameters,
        });
    }
    let mut parameters = Vec::new();
    for parameter in effect.parameters {
        parameters.push(match given_table.take(parameter.name) {
            Some(entry) => value(source, &entry, signs(parameter))?,
            None if effect.is_optional(parameter) => Value::from(parameter.neutral),
            None => return Err(given_table.missing(parameter.name)),
        });
    }
    given_table.finish(effect.parameters.iter().map(|parameter| parameter.name))?;
    Ok(ModelEffect {
        effect,
        place,
        parameters,
    })
}

/// The place in the file, or the first place of the effect that this kind has.
fn place(
    source: &Source,
    kind: &Kind,
    effect: &Effect,
    table: &mut Table,
) -> Result<Place, ModelError> {
    let has = |place: Place| {
        let places = |&input: &_| (kind.places)(input).contains(&place);
        kind.inputs.iter().any(places)
    };
    let possible: Vec<Place> = effect.places.iter().copied().filter(|p| has(*p)).collect();
    let names = possible.iter().map(|place| place.name());
    let Some(entry) = table.take("place") else {
        let first = possible.first().copied();
        return first.ok_or_else(|| table.missing("place"));
    };
    let name = entry.text(source)?;
    match Place::from_name(name) {
        Some(place) if possible.contains(&place) => Ok(place),
        Some(_) => {
            let (kind, effect) = (kind.name, effect.name);
            let possible = list(names);
            let reason =
                format!("\"{name}\" is no place of {effect} in a {kind}; possible: {possible}");
            Err(entry.refuse(source, reason))
        }
        None => Err(entry.unknown(source, name, names)),
    }
}
