//! The text of a model file, with its tables, entries and their lines.

use super::ModelError;
use crate::Kind;
use quell_recording::{SyntaxError, nearest};
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A file's path and text.
pub struct Source<'a> {
    /// The path, for errors.
    pub file: &'a Path,
    /// The text.
    pub text: &'a str,
}

impl<'a> Source<'a> {
    fn line(&self, offset: usize) -> usize {
        let before = &self.text.as_bytes()[..offset.min(self.text.len())];
        1 + before.iter().filter(|&&byte| byte == b'\n').count()
    }

    fn column(&self, offset: usize) -> usize {
        let before = self.text.get(..offset).unwrap_or_default();
        1 + before.chars().rev().take_while(|c| *c != '\n').count()
    }

    /// The text as TOML.
    pub fn document(&self) -> Result<DeTable<'a>, ModelError> {
        let parsed = DeTable::parse(self.text).map_err(|error| {
            let told = SyntaxError::of(self.text, &error);
            ModelError::Syntax {
                file: self.file.to_path_buf(),
                line: told.line.unwrap_or(1),
                column: told.column.unwrap_or(1),
                reason: told.reason,
            }
        })?;
        Ok(parsed.into_inner())
    }

    fn refuse(&self, offset: usize, key: &str, reason: String) -> ModelError {
        ModelError::Key {
            file: self.file.to_path_buf(),
            line: self.line(offset),
            key: key.to_string(),
            reason,
        }
    }
}

/// A table whose entries are taken out one by one.
pub struct Table<'s> {
    /// The file.
    pub source: &'s Source<'s>,
    entries: Vec<Entry<'s>>,
    start: usize,
}

impl<'s> Table<'s> {
    /// All entries of a table.
    pub fn new(source: &'s Source<'s>, table: &'s DeTable<'s>) -> Self {
        let entry = |(key, value): (&'s Spanned<_>, &'s Spanned<_>)| Entry {
            key: AsRef::<str>::as_ref(key.get_ref()),
            index: None,
            start: key.span().start,
            value,
        };
        Self {
            source,
            entries: table.iter().map(entry).collect(),
            start: 0,
        }
    }

    /// Uses this entry's line for keys that are found missing from here on.
    pub fn anchor(&mut self, entry: &Entry) {
        self.start = entry.start;
    }

    /// Whether an entry of this name is left.
    pub fn holds(&self, key: &str) -> bool {
        self.entries.iter().any(|entry| entry.key == key)
    }

    /// Number of entries with none of these names.
    pub fn strays(&self, known: impl Iterator<Item = &'static str> + Clone) -> usize {
        let known = |entry: &&Entry| !known.clone().any(|key| key == entry.key);
        self.entries.iter().filter(known).count()
    }

    /// Removes the entry of this name from the table and returns it.
    pub fn take(&mut self, key: &str) -> Option<Entry<'s>> {
        let index = self.entries.iter().position(|entry| entry.key == key)?;
        Some(self.entries.swap_remove(index))
    }

    /// The error of a missing required key.
    pub fn missing(&self, key: &str) -> ModelError {
        self.source.refuse(self.start, key, "is missing".into())
    }

    /// The error of a missing key of a kind, with all that the kind needs.
    pub fn needed(&self, key: &str, kind: &Kind) -> ModelError {
        let needed = kind.keys.iter().filter(|key| key.default.is_none());
        let names: Vec<_> = needed
            .map(|key| format!("{} = a number", key.name))
            .collect();
        let reason = format!("is missing; {} needs {}", kind.name, names.join(", "));
        self.source.refuse(self.start, key, reason)
    }

    /// Refuses the first entry that was not taken.
    pub fn finish(&self, known: impl IntoIterator<Item = &'static str>) -> Result<(), ModelError> {
        let Some(entry) = self.entries.iter().min_by_key(|entry| entry.start) else {
            return Ok(());
        };
        let known: Vec<_> = known.into_iter().collect();
        let reason = format!("is no key here{}", advice(entry.key, known));
        Err(entry.refuse(self.source, reason))
    }
}

/// One entry of a table.
#[derive(Clone, Copy)]
pub struct Entry<'s> {
    key: &'s str,
    /// Number in the array that the key holds, from 1.
    index: Option<usize>,
    start: usize,
    value: &'s Spanned<DeValue<'s>>,
}

impl<'s> Entry<'s> {
    /// An error at the entry.
    pub fn refuse(&self, source: &Source, reason: String) -> ModelError {
        match self.index {
            None => source.refuse(self.start, self.key, reason),
            Some(index) => {
                let column = source.column(self.start);
                let reason = format!("value {index}, column {column}: {reason}");
                source.refuse(self.start, self.key, reason)
            }
        }
    }

    /// The error of an unknown name.
    pub fn unknown(
        &self,
        source: &Source,
        name: &str,
        known: impl Iterator<Item = &'static str>,
    ) -> ModelError {
        let known: Vec<_> = known.collect();
        self.refuse(
            source,
            format!("\"{name}\" is unknown{}", advice(name, known)),
        )
    }

    fn wrong(&self, source: &Source, wanted: &str) -> ModelError {
        let found = self.value.get_ref().type_str();
        self.refuse(
            source,
            format!("{wanted} is wanted, not a value of type {found}"),
        )
    }

    /// A string.
    pub fn text(&self, source: &Source) -> Result<&'s str, ModelError> {
        let text = self.value.get_ref().as_str();
        text.ok_or_else(|| self.wrong(source, "a string"))
    }

    /// A number.
    pub fn number(&self, source: &Source) -> Result<f64, ModelError> {
        number(self.value.get_ref()).ok_or_else(|| self.wrong(source, "a number"))
    }

    /// Whether it is this number.
    pub fn is(&self, wanted: f64) -> bool {
        number(self.value.get_ref()) == Some(wanted)
    }

    /// Two numbers.
    pub fn pair(&self, source: &Source) -> Result<(f64, f64), ModelError> {
        let wrong = || self.wrong(source, "an array of two numbers");
        let array = self.value.get_ref().as_array().ok_or_else(wrong)?;
        let numbers: Vec<f64> = array.iter().filter_map(|v| number(v.get_ref())).collect();
        match (&numbers[..], array.len()) {
            (&[low, high], 2) => Ok((low, high)),
            _ => Err(wrong()),
        }
    }

    /// The entries of an array; errors name the array's key and the number, from 1.
    pub fn list(&self, source: &Source) -> Result<Vec<Entry<'s>>, ModelError> {
        let wrong = || self.wrong(source, "an array of numbers");
        let array = self.value.get_ref().as_array().ok_or_else(wrong)?;
        let entry = |(index, value): (usize, &'s Spanned<DeValue<'s>>)| Entry {
            key: self.key,
            index: Some(index + 1),
            start: value.span().start,
            value,
        };
        Ok(array.iter().enumerate().map(entry).collect())
    }

    /// A boolean.
    pub fn truth(&self, source: &Source) -> Result<bool, ModelError> {
        let truth = self.value.get_ref().as_bool();
        truth.ok_or_else(|| self.wrong(source, "true or false"))
    }

    /// Whether it is a table.
    pub fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    /// A table.
    pub fn table(&self, source: &'s Source<'s>) -> Result<Table<'s>, ModelError> {
        let table = self.value.get_ref().as_table();
        let table = table.ok_or_else(|| self.wrong(source, "a table"))?;
        Ok(Table::new(source, table))
    }

    /// An array of tables.
    pub fn tables(&self, source: &'s Source<'s>) -> Result<Vec<Table<'s>>, ModelError> {
        let wrong = || self.wrong(source, "[[effect]], an array of tables,");
        let array = self.value.get_ref().as_array().ok_or_else(wrong)?;
        let table = |value: &'s Spanned<DeValue<'s>>| {
            let table = value.get_ref().as_table().ok_or_else(wrong)?;
            let mut table = Table::new(source, table);
            table.start = value.span().start;
            Ok(table)
        };
        array.iter().map(table).collect()
    }
}

fn number(value: &DeValue) -> Option<f64> {
    // A radix other than 10 is not allowed for a physical quantity.
    let text = match value {
        DeValue::Float(float) => float.as_str(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str(),
        _ => return None,
    };
    text.parse().ok()
}

fn advice(name: &str, mut known: Vec<&'static str>) -> String {
    // Two kinds may be told apart by their keys alone.
    let mut seen = std::collections::BTreeSet::new();
    known.retain(|name| seen.insert(*name));
    match nearest(name, known.iter().copied()) {
        Some(near) => format!("; did you mean \"{near}\"?"),
        None => format!("; known: {}", list(known.into_iter())),
    }
}

/// Names separated by commas.
pub fn list<'a>(names: impl Iterator<Item = &'a str>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
