//! Values of a manifest's keys, each in its range.

use super::{Entry, Rows, Source, key, start};
use crate::error::{Problem, RecordingError, nearest};
use crate::role::{ROLES, Role};
use crate::unit::{UNITS, Unit};
use std::collections::BTreeSet;
use toml::Spanned;

impl Source<'_> {
    pub(super) fn role(&self, name: &Spanned<String>) -> Result<Role, RecordingError> {
        Role::from_name(name.get_ref()).ok_or_else(|| {
            let nearest = nearest(name.get_ref(), ROLES.iter().map(|entry| entry.name));
            let problem = Problem::UnknownRole {
                role: name.get_ref().clone(),
                nearest,
            };
            self.at(name.span().start, problem)
        })
    }

    /// Refuses a second channel of a role: it would never be used.
    pub(super) fn each_role_once<'a>(
        &self,
        entries: impl Iterator<Item = &'a Entry>,
    ) -> Result<(), RecordingError> {
        let mut seen = BTreeSet::new();
        for role in entries.map(|entry| &entry.role) {
            if !seen.insert(role.get_ref()) {
                let reason = format!(
                    "{:?} stands twice, and a recording has one of each; give each joint its own with joint = \"...\"",
                    role.get_ref()
                );
                return Err(self.at(role.span().start, key("role", reason)));
            }
        }
        Ok(())
    }

    pub(super) fn unit(&self, name: &Spanned<String>) -> Result<&'static Unit, RecordingError> {
        Unit::from_name(name.get_ref()).ok_or_else(|| {
            let names = UNITS.iter().flat_map(|unit| unit.names.iter().copied());
            let nearest = nearest(name.get_ref(), names);
            let problem = Problem::UnknownUnit {
                unit: name.get_ref().clone(),
                nearest,
            };
            self.at(name.span().start, problem)
        })
    }

    pub(super) fn finite(
        &self,
        name: &'static str,
        value: &Option<Spanned<f64>>,
    ) -> Result<Option<f64>, RecordingError> {
        match value.as_ref().map(|value| *value.get_ref()) {
            Some(number) if !number.is_finite() => Err(self.at(
                start(value),
                key(name, format!("{number} is not a finite number")),
            )),
            number => Ok(number),
        }
    }

    pub(super) fn positive(
        &self,
        name: &'static str,
        value: &Option<Spanned<f64>>,
    ) -> Result<Option<f64>, RecordingError> {
        match self.finite(name, value)? {
            Some(number) if number <= 0.0 => {
                Err(self.at(start(value), key(name, format!("{number} is not above 0"))))
            }
            number => Ok(number),
        }
    }

    /// The range, where it lies in a file of so many rows.
    pub(super) fn rows(&self, rows: &Rows, count: usize) -> Result<[usize; 2], RecordingError> {
        let [first, last] = *rows.get_ref();
        let reason = if first >= last {
            format!("from row {first} up to before row {last} there is no row")
        } else if last > count {
            format!("the file has {count} rows, so it ends before row {last}")
        } else {
            return Ok([first, last]);
        };
        Err(self.at(rows.span().start, key("rows", reason)))
    }

    /// The names of a channel's columns or fields, under the one key or the other.
    pub(super) fn names<'e>(
        &self,
        entry: &'e Entry,
        role: Role,
        [one, many]: [&'static str; 2],
        names: (&'e Option<String>, &'e Option<Vec<String>>),
    ) -> Result<Vec<&'e str>, RecordingError> {
        let names: Vec<&str> = match names {
            (Some(name), None) => vec![name],
            (None, Some(names)) => names.iter().map(String::as_str).collect(),
            _ => {
                let reason = format!("give either {one} = \"...\" or {many} = [...]");
                return Err(self.at(entry.role.span().start, key(one, reason)));
            }
        };
        let allowed = role.entry().columns;
        if allowed.contains(&names.len()) {
            return Ok(names);
        }
        let allowed: Vec<String> = allowed.iter().map(usize::to_string).collect();
        let reason = format!(
            "{role} takes {} {one}(s), not {}",
            allowed.join(" or "),
            names.len()
        );
        Err(self.at(entry.role.span().start, key(many, reason)))
    }
}
