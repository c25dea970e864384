//! A file with what is proposed of it: its clock, its channels, its tests, and what is open.

use super::clock::{self, Clock};
use super::column::Column;
use super::columns::{self, Channels};
use super::content::Content;
use super::{restarts, roles, unreadable};
use std::ops::Range;

/// A file with its proposal.
pub struct Read<'a> {
    /// The file.
    pub content: &'a Content,
    /// Its clock.
    pub clock: Clock,
    /// The column that tells its tests apart.
    pub tests: Option<usize>,
    /// The rows of each test, where its time begins again and no column tells them apart.
    pub parts: Vec<Range<usize>>,
    /// Its channels.
    pub channels: Channels,
}

/// One test of a file with several.
#[derive(Clone)]
pub enum Test {
    /// All rows with this cell in the column of the tests.
    Called(String),
    /// Rows below the header.
    Rows(Range<usize>),
}

pub fn read(content: &Content) -> Read<'_> {
    let clock = clock::of(content);
    let is_signal = |index| roles::role(content, index).is_some_and(|(_, certain)| certain);
    let tests = clock::tests(content, &clock, is_signal);
    let parts = match tests {
        None => restarts::parts(content, &clock),
        Some(_) => Vec::new(),
    };
    let channels = columns::of(content, &clock, tests);
    Read {
        content,
        clock,
        tests,
        parts,
        channels,
    }
}

impl Read<'_> {
    /// Open questions that matter.
    pub fn open(&self) -> Vec<String> {
        // What else is open is so for that reason.
        let unreadable = unreadable::of(self.content, &self.channels);
        if !unreadable.is_empty() {
            return unreadable;
        }
        let mut open = self.channels.open.clone();
        match &self.clock {
            Clock::None => open.push("no column has the time: rate_hz is needed".into()),
            Clock::Counted(column) => open.push(clock::counted(&self.content.columns[*column])),
            Clock::Stamps {
                open: Some(why), ..
            } => open.push(why.clone()),
            Clock::Split(split) => open.extend(split.open(self.content)),
            _ => {}
        }
        if self.several().is_empty() {
            open.extend(restarts::told(self.content, &self.clock));
        }
        open
    }

    /// The tests of a file with several, each with what it is called.
    pub fn several(&self) -> Vec<(String, Test)> {
        match self.tests {
            Some(index) => {
                let called = self.content.columns[index].distinct.iter();
                let one = |test: &String| (test.clone(), Test::Called(test.clone()));
                called.map(one).collect()
            }
            None => {
                let parts = self.parts.iter().cloned().enumerate();
                let one = |(k, rows): (usize, _)| ((k + 1).to_string(), Test::Rows(rows));
                parts.map(one).collect()
            }
        }
    }

    /// The column of the tests, the test, and why it is one.
    pub fn only(&self, test: Option<&Test>) -> Option<(String, String, &'static str)> {
        let Some(index) = self.tests else {
            return self.first_in_turn();
        };
        let column = &self.content.columns[index];
        let Some(Test::Called(test)) = test else {
            return None;
        };
        let why = match column.name.is_payload() {
            true => "each payload is a recording of its own",
            false => "the time begins again with each",
        };
        Some((column.called.clone(), test.clone(), why))
    }

    /// The column of several sensors whose rows stand in turn, and the first sensor.
    fn first_in_turn(&self) -> Option<(String, String, &'static str)> {
        let (column, names) = unreadable::in_turn(self.content, &self.channels)?;
        let why = "the first of several sensors whose rows stand in turn";
        Some((column.called.clone(), names[0].clone(), why))
    }

    /// The payload throughout a test, or the file, and its column.
    pub fn payload(&self, test: Option<&Test>) -> Option<(&Column, String)> {
        let content = self.content;
        let column = content.columns.iter().find(|own| own.name.is_payload())?;
        let rows = match (self.tests, test) {
            (Some(index), Some(Test::Called(test))) => content.columns[index].rows_of(test)?,
            (_, Some(Test::Rows(rows))) => rows.clone(),
            _ => 0..column.numbers.len(),
        };
        let cell = column.one_of(rows).filter(|cell| !cell.is_empty())?;
        let unit = column.name.unit.iter().map(|unit| format!(" {unit}"));
        Some((column, cell.to_owned() + &unit.collect::<String>()))
    }
}
