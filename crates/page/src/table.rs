//! Tables.

use super::colour::line;
use super::html::significant;
use super::prose::prose;
use maud::{Markup, html};

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number, shown with [`DIGITS`] significant digits; not finite shows as a dash.
    Number(f64),
    /// Words that lead to a file beside the page.
    Link {
        /// The words.
        text: String,
        /// The file, from the page's folder.
        file: String,
    },
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Self::Number(value.unwrap_or(f64::NAN))
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Text(value.to_string())
    }
}

/// A table with named columns; units stand below the names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    title: String,
    columns: Vec<Column>,
    rows: Vec<Row>,
    note: Option<String>,
}

/// Significant digits of a number. What is known better is given as text.
const DIGITS: usize = 3;

/// Most characters of a cell that is not broken into lines, as of an interval or of a place.
const SHORT: usize = 16;

#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    unit: String,
    text: bool,
}

#[derive(Clone, Debug, PartialEq)]
struct Row {
    cells: Vec<Cell>,
    /// Its class, where it is one to look at.
    mark: Option<&'static str>,
}

impl Table {
    /// An empty table.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// A column of words, set to the left. In the first column, a word that also names a curve of
    /// the page gets the curve's colour beside it.
    pub fn text_column(self, name: impl Into<String>) -> Self {
        self.push_column(name.into(), String::new(), true)
    }

    /// A column of numbers, set to the right, with their unit ("" if they have none).
    pub fn column(self, name: impl Into<String>, unit: impl Into<String>) -> Self {
        self.push_column(name.into(), unit.into(), false)
    }

    /// A row, from left to right; what is missing stays empty, what is too much is left out.
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        let cells = cells.into_iter().collect();
        self.rows.push(Row { cells, mark: None });
        self
    }

    /// Marks the last row as the one to look at.
    pub fn marked(self) -> Self {
        self.mark("marked")
    }

    /// Marks the last row, less firmly, as one that may stand in the place of the one to look at.
    pub fn perhaps(self) -> Self {
        self.mark("perhaps")
    }

    fn mark(mut self, class: &'static str) -> Self {
        if let Some(row) = self.rows.last_mut() {
            row.mark = Some(class);
        }
        self
    }

    /// A sentence below the table.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }

    fn push_column(mut self, name: String, unit: String, text: bool) -> Self {
        self.columns.push(Column { name, unit, text });
        self
    }

    pub(super) fn render(&self, colour: &dyn Fn(&str) -> Option<usize>) -> Markup {
        html! {
            figure.sheet {
                figcaption { (self.title) }
                div.wide {
                    table {
                        thead { tr { @for column in &self.columns { (column.render()) } } }
                        tbody { @for row in &self.rows { (self.render_row(row, colour)) } }
                    }
                }
                @if let Some(note) = &self.note { p.note { (prose(note)) } }
            }
        }
    }

    /// Numbers are set to the right. A few words beyond the first column stay on one line.
    fn class(&self, index: usize, row: &Row) -> Option<&'static str> {
        let own = self.columns.get(index).and_then(Column::class);
        let is_short = match row.cells.get(index) {
            Some(Cell::Text(text)) => index > 0 && text.chars().count() <= SHORT,
            _ => false,
        };
        own.or(is_short.then_some("short"))
    }

    fn render_row(&self, row: &Row, colour: &dyn Fn(&str) -> Option<usize>) -> Markup {
        let own = |index: usize, text: &str| (index == 0).then(|| colour(text)).flatten();
        html! {
            tr class=[row.mark] {
                @for index in 0..self.columns.len() {
                    td class=[self.class(index, row)] {
                        @match row.cells.get(index) {
                            Some(Cell::Link { text, file }) => { a href=(file) { (text) } }
                            Some(Cell::Text(text)) => {
                                @if let Some(slot) = own(index, text) { (line(slot)) }
                                (text)
                            }
                            Some(Cell::Number(value)) => { (significant(*value, DIGITS)) }
                            None => {}
                        }
                    }
                }
            }
        }
    }
}

impl Column {
    fn class(&self) -> Option<&'static str> {
        (!self.text).then_some("number")
    }

    fn render(&self) -> Markup {
        html! {
            th scope="col" class=[self.class()] {
                (self.name)
                @if !self.unit.is_empty() { small { (self.unit) } }
            }
        }
    }
}
