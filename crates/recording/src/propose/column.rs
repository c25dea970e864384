//! A column of a CSV file before its meaning is known.

use super::super::layout::Layout;
use super::super::stamp::TimeUnit;
use super::super::stamp_wraps;
use super::name::{self, Name};
use super::units;
use crate::Wrap;
use std::cell::OnceCell;
use std::ops::Range;

/// Usual cells for missing values.
const MISSING: &[&str] = &[
    "", "NaN", "nan", "NAN", "NA", "N/A", "null", "NULL", "None", "-",
];
/// Most sensors whose rows stand in turn.
const MOST_IN_TURN: usize = 20;
/// Most values of a column that tells tests apart.
const MOST_TESTS: usize = 1000;

/// A column.
pub struct Column {
    /// Its name in a manifest.
    pub called: String,
    /// Its text in the header, if there is one.
    pub title: String,
    /// The parts of the title.
    pub name: Name,
    /// Its numbers; NaN for any other cell.
    pub numbers: Vec<f64>,
    /// Number of cells that are neither numbers nor missing.
    pub texts: usize,
    /// The first of these.
    pub bad: Option<Bad>,
    /// The first of these that has a separator of thousands, if all that is no number has one.
    pub grouped: Option<Bad>,
    /// The first cell.
    pub first: String,
    /// The unit of time behind its numbers, as in `0.004 sec`.
    pub durations: Option<TimeUnit>,
    /// The counter whose readings it has, if it has stamps of one that begins again; these go on then.
    pub wrap: Option<Wrap>,
    /// Its distinct cells in their order, if there are few.
    pub distinct: Vec<String>,
    /// The rows from which on these stand, counted from 0.
    pub begins: Vec<usize>,
    /// Its variance, once somebody has asked for it.
    variance: OnceCell<f64>,
}

/// A cell that is neither a number nor missing.
pub struct Bad {
    /// Its row, counted from 0 below the header.
    pub row: usize,
    /// Its text.
    pub text: String,
    /// Its line, or its row in a Parquet file, in words; known of columns that are numbers but for a few cells,
    /// and of hexadecimal ones.
    pub place: String,
}

impl Bad {
    /// Whether it is a number to the base 16.
    pub fn is_hexadecimal(&self) -> bool {
        let digits = self
            .text
            .strip_prefix("0x")
            .or_else(|| self.text.strip_prefix("0X"));
        digits.is_some_and(|own| !own.is_empty() && own.bytes().all(|b| b.is_ascii_hexdigit()))
    }
}

impl Column {
    pub fn new(called: &str, title: &str) -> Self {
        Self {
            called: called.into(),
            title: title.into(),
            name: name::parse(title),
            numbers: Vec::new(),
            texts: 0,
            bad: None,
            grouped: None,
            first: String::new(),
            durations: None,
            wrap: None,
            distinct: Vec::new(),
            begins: Vec::new(),
            variance: OnceCell::new(),
        }
    }

    /// Adds a cell; returns whether it is missing.
    pub fn take(&mut self, cell: &str, layout: &Layout) -> bool {
        if self.numbers.is_empty() {
            self.first = cell.into();
        }
        let number = layout.number(cell).or_else(|| self.duration(cell, layout));
        let number = number.filter(|number| number.is_finite());
        let missing = number.is_none() && MISSING.contains(&cell);
        if number.is_none() && !missing {
            self.texts += 1;
            let bad = || Bad {
                row: self.numbers.len(),
                text: cell.into(),
                place: String::new(),
            };
            match layout.is_grouped(cell) {
                true if self.bad.is_none() => self.grouped = Some(bad()),
                true => {}
                false => self.grouped = None,
            }
            self.bad.get_or_insert_with(bad);
        }
        self.numbers.push(number.unwrap_or(f64::NAN));
        let is_new = self.distinct.last().is_none_or(|last| last != cell);
        if is_new && self.distinct.len() <= MOST_TESTS {
            self.distinct.push(cell.into());
            self.begins.push(self.numbers.len() - 1);
        }
        missing
    }

    /// Lets stamps of a counter go on where it begins again.
    pub fn go_on(&mut self) {
        let unit = self.name.unit.as_deref().and_then(units::time_unit);
        let is_time = self.name.is_time() || unit.is_some() || self.durations.is_some();
        if !is_time || self.texts > 0 {
            return;
        }
        self.wrap = Wrap::of_stamps(&self.numbers);
        if let Some(wrap) = self.wrap {
            stamp_wraps::go_on(&mut self.numbers, wrap.period);
        }
    }

    /// The variance of its numbers, with the square of their unit; 0 without any. They are read once, so it is for a whole column.
    pub fn variance(&self) -> f64 {
        *self.variance.get_or_init(|| {
            let there = || self.numbers.iter().filter(|own| !own.is_nan());
            let count = there().count().max(1) as f64;
            let mean = there().sum::<f64>() / count;
            there().map(|own| (own - mean).powi(2)).sum::<f64>() / count
        })
    }

    /// The number of a cell with a unit of time behind it, which is then that of the column.
    fn duration(&mut self, cell: &str, layout: &Layout) -> Option<f64> {
        let (number, unit) = TimeUnit::in_cell(cell)?;
        let value = layout.number(number)?;
        let of_column = self.durations.get_or_insert(unit);
        (*of_column == unit).then_some(value)
    }

    /// Its name in a manifest, with its title where that is another one.
    pub fn told(&self) -> String {
        match self.called == self.title || self.title.is_empty() {
            true if self.called.is_empty() => "one without a name".into(),
            true => self.called.clone(),
            false => format!("{} ({})", self.called, self.title),
        }
    }

    /// Whether a text is its name in the header, where a unit may stand in a row of its own.
    pub fn is_called(&self, text: &str) -> bool {
        let rest = self.title.strip_prefix(text);
        !text.is_empty() && rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(" ["))
    }

    /// Whether it has neither a name nor a cell, as where each line ends with a separator.
    pub fn is_empty(&self) -> bool {
        let has_name = !self.title.is_empty() && self.title != self.called;
        !has_name && self.texts == 0 && self.numbers.iter().all(|number| number.is_nan())
    }

    /// Whether its cells are numbers, or missing.
    pub fn is_numeric(&self) -> bool {
        self.texts == 0 && self.numbers.iter().any(|number| number.is_finite())
    }

    /// Whether most cells are numbers, and some are neither numbers nor missing.
    pub fn is_mostly_numeric(&self) -> bool {
        let numbers = self.numbers.iter().filter(|number| number.is_finite());
        self.texts > 0 && numbers.count() > self.texts
    }

    /// Whether it is read as numbers: a cell that is none is told with its place.
    pub fn has_numbers(&self) -> bool {
        self.is_numeric() || self.is_mostly_numeric()
    }

    /// Whether its numbers are neither a counter's nor stamps.
    pub fn is_measured(&self) -> bool {
        self.has_numbers() && !self.name.is_count() && !self.name.is_time()
    }

    /// Its words, if each row has one of a few, and most rows another one than the row above.
    pub fn in_turn(&self) -> Option<Vec<String>> {
        let last = *self.begins.last()?;
        let is_text = self.texts == self.numbers.len();
        let mut words = self.distinct.clone();
        words.sort();
        words.dedup();
        let is_few =
            (2..=MOST_IN_TURN).contains(&words.len()) && self.begins.len() > 2 * words.len();
        (is_text && is_few && 2 * self.begins.len() > last).then_some(words)
    }

    /// The one cell of these rows, if they have one.
    pub fn one_of(&self, rows: Range<usize>) -> Option<&str> {
        let block = self
            .begins
            .partition_point(|row| *row <= rows.start)
            .checked_sub(1)?;
        let ends = self.begins.get(block + 1).copied();
        let is_one =
            ends.unwrap_or(self.numbers.len()) >= rows.end && self.distinct.len() <= MOST_TESTS;
        is_one.then(|| self.distinct[block].as_str())
    }

    /// The rows in which a value stands, of values that each stand in one block.
    pub fn rows_of(&self, value: &str) -> Option<Range<usize>> {
        let block = self.distinct.iter().position(|own| own == value)?;
        let ends = self.begins.get(block + 1).copied();
        Some(self.begins[block]..ends.unwrap_or(self.numbers.len()))
    }

    /// Whether it has several values, and each stands in one block of rows.
    pub fn is_of_blocks(&self) -> bool {
        let mut values: Vec<&String> = self.distinct.iter().collect();
        values.sort();
        values.dedup();
        let count = self.distinct.len();
        values.len() == count && (2..=MOST_TESTS).contains(&count) && count < self.numbers.len()
    }

    /// Whether the numbers of these rows grow from each to the next.
    pub fn grows(&self, rows: impl Iterator<Item = usize>) -> bool {
        let mut before = f64::NEG_INFINITY;
        for value in rows
            .map(|row| self.numbers[row])
            .filter(|value| !value.is_nan())
        {
            if value <= before {
                return false;
            }
            before = value;
        }
        before.is_finite()
    }
}
