//! Key figures.

use super::html::number;
use super::prose::prose;
use maud::{Markup, html};

/// A key figure: one number with its unit, and what it means.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    name: String,
    value: String,
    unit: String,
    note: String,
}

impl Figure {
    /// A number, shown with four significant digits, with its unit ("" if it has none).
    pub fn new(name: impl Into<String>, value: f64, unit: impl Into<String>) -> Self {
        Self {
            unit: unit.into(),
            ..Self::text(name, number(value))
        }
    }

    /// A value that is already text, as "8.12 ± 0.03".
    pub fn text(name: impl Into<String>, value: impl Into<String>) -> Self {
        let (unit, note) = (String::new(), String::new());
        Self {
            name: name.into(),
            value: value.into(),
            unit,
            note,
        }
    }

    /// The unit of a value that is text.
    pub fn unit(mut self, unit: impl Into<String>) -> Self {
        self.unit = unit.into();
        self
    }

    /// A few words below the number: against what it is to be held.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = note.into();
        self
    }

    pub(super) fn render(&self) -> Markup {
        html! {
            div {
                dt { (self.name) }
                dd.value { (self.value) " " small { (self.unit) } }
                @if !self.note.is_empty() { dd.note { (prose(&self.note)) } }
            }
        }
    }
}
