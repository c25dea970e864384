//! CSV, gzipped CSV and Parquet as a table of text, and its columns as numbers.

pub(super) mod parquet;
mod text;

pub(super) use text::text;

use super::carries::LARGEST;
use super::error::{Problem, RecordingError};
use super::layout::Layout;
use super::stamp::{Origin, TimeUnit};
use super::stamp_wraps;
use std::ops::Range;
use std::path::{Path, PathBuf};
use text::{count_line_ends, first_row, line_start, single_spaces};

/// A CSV file in memory: a header, and rows that are parsed on demand.
///
/// A byte order mark is dropped, blank lines are skipped, and a `#` before the first name of the header is
/// ignored.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    text: String,
    layout: Layout,
    delimiter: u8,
    header: Vec<String>,
    /// Line of the header, counted from 1.
    header_line: usize,
    /// Start of the rows.
    body: Offset,
    /// Columns, and the required cells of a row in them; other rows are left out.
    only: Vec<(usize, String)>,
}

/// Start of a row in the text; its line is counted only for an error.
type Offset = usize;

impl Table {
    /// Reads a `.csv` or `.csv.gz` file, and with the feature `parquet` a Parquet file. Gzip is detected by its first bytes, not by
    /// the name.
    ///
    /// # Errors
    /// [`RecordingError`] where the file is missing, empty, damaged or not UTF-8.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        Self::open_as(path, &Layout::default())
    }

    /// The same for a file in this layout.
    ///
    /// # Errors
    /// As [`Table::open`], and where the layout names a missing column.
    pub fn open_as(path: &Path, layout: &Layout) -> Result<Self, RecordingError> {
        match parquet::is_one(path) {
            true => parquet::table(path, layout, None),
            false => Self::from_text(path, text(path)?, layout),
        }
    }

    /// A table from a text in memory.
    ///
    /// # Errors
    /// As [`Table::open_as`].
    pub(super) fn from_text(
        path: &Path,
        mut text: String,
        layout: &Layout,
    ) -> Result<Self, RecordingError> {
        if layout.delimiter == Some(' ') {
            text = single_spaces(&text);
        }
        let empty = || Problem::Empty.in_file(path);
        let named = layout.header_line(&text);
        let first = named
            .or_else(|| first_row(&text, layout))
            .ok_or_else(empty)?;
        let line = text.lines().nth(first).ok_or_else(empty)?;
        let below = first + usize::from(named.is_some());
        let delimiter = layout.delimiter_of(line);
        let mut table = Self {
            path: path.into(),
            delimiter: delimiter as u8,
            layout: layout.clone(),
            header: Vec::new(),
            header_line: 1 + first,
            body: line_start(&text, below),
            only: Vec::new(),
            // A separator at the start is of an empty cell.
            text: line
                .trim_start_matches(|letter: char| letter.is_whitespace() && letter != delimiter)
                .trim_start_matches(marks(layout))
                .to_owned(),
        };
        let row = table.records(0).next().unwrap_or_else(|| Err(empty()))?.1;
        table.header = match named {
            Some(_) => row.iter().map(|cell| cell.trim().to_owned()).collect(),
            None => (1..=row.len()).map(|column| column.to_string()).collect(),
        };
        table.text = text;
        for (column, cell) in layout.only.iter().flatten() {
            let index = table.index(column)?;
            table.only.push((index, cell.clone()));
        }
        Ok(table)
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The separator of the cells.
    pub fn delimiter(&self) -> u8 {
        self.delimiter
    }

    /// The names of the columns.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// The rows below the header as text, each as wide as the header.
    ///
    /// # Errors
    /// The row's [`RecordingError`] where it is not.
    pub fn rows(&self) -> impl Iterator<Item = Result<csv::StringRecord, RecordingError>> + '_ {
        self.body().map(|row| row.map(|(_, record)| record))
    }

    /// Columns as finite numbers, in the order of `names`; NaN for a missing cell.
    ///
    /// # Errors
    /// [`RecordingError`] with line and column.
    pub fn numbers(&self, names: &[&str]) -> Result<Vec<Vec<f64>>, RecordingError> {
        let indices: Vec<usize> = names
            .iter()
            .map(|name| self.index(name))
            .collect::<Result<_, _>>()?;
        let mut columns = vec![Vec::new(); names.len()];
        for row in self.body() {
            let (offset, record) = row?;
            for (column, &index) in columns.iter_mut().zip(&indices) {
                column.push(self.number(offset, index, &record[index])?);
            }
        }
        match columns.first() {
            Some(column) if column.is_empty() => Err(Problem::NoRows.in_file(&self.path)),
            _ => Ok(columns),
        }
    }

    /// Refuses the first value of columns that is no measurement and no command: beyond 1e27.
    ///
    /// # Errors
    /// [`RecordingError`] with line and column.
    pub fn possible(&self, names: &[&str], columns: &[Vec<f64>]) -> Result<(), RecordingError> {
        for (name, values) in names.iter().zip(columns) {
            if let Some(row) = values.iter().position(|value| value.abs() > LARGEST) {
                let problem = |text| Problem::Impossible { text };
                return Err(self.at_row(row, self.index(name)?, problem));
            }
        }
        Ok(())
    }

    /// A column as strictly increasing stamps, s.
    ///
    /// # Errors
    /// As [`Self::numbers`], and where time repeats or runs backwards.
    pub fn stamps(&self, name: &str) -> Result<Vec<f64>, RecordingError> {
        let index = self.index(name)?;
        let stamps = self.numbers(&[name])?.swap_remove(0);
        self.advances(index, &stamps, 0..stamps.len())?;
        Ok(stamps)
    }

    /// The same where only some rows are used, and only these need to advance: the time may begin again with each test. In a
    /// unit of time, if it is given; stamps since an epoch are then relative to `origin`, which the first file sets. Where they are of a
    /// counter, they go on where it begins again, after `wrap` s.
    ///
    /// # Errors
    /// As [`Self::stamps`].
    pub(super) fn stamps_of(
        &self,
        name: &str,
        unit: Option<(TimeUnit, &mut Origin)>,
        wrap: Option<f64>,
        rows: Range<usize>,
    ) -> Result<Vec<f64>, RecordingError> {
        let mut stamps = match unit {
            None => self.numbers(&[name])?.swap_remove(0),
            Some((unit, origin)) => self.told_in(name, unit, origin)?,
        };
        if let Some(period) = wrap {
            stamp_wraps::go_on(&mut stamps, period);
        }
        self.advances(self.index(name)?, &stamps, rows)?;
        Ok(stamps)
    }

    /// A column as stamps in a unit of time. Stamps since an epoch are relative to `origin`, which the first
    /// file sets.
    ///
    /// # Errors
    /// As [`Self::numbers`].
    fn told_in(
        &self,
        name: &str,
        unit: TimeUnit,
        origin: &mut Origin,
    ) -> Result<Vec<f64>, RecordingError> {
        let index = self.index(name)?;
        let (mut stamps, mut previous) = (Vec::new(), 0.0);
        for row in self.body() {
            let (offset, record) = row?;
            let cell = record[index].trim();
            if self.layout.is_missing(cell) {
                stamps.push(f64::NAN);
                continue;
            }
            let point = self.layout.decimal == Some(',');
            let cell = if point { &cell.replace(',', ".") } else { cell };
            let stamp = unit.seconds(cell, origin).ok_or_else(|| {
                let unit = unit.name();
                let text = cell.into();
                let problem = Problem::NotATime { text, unit };
                self.at_cell(problem, self.line(offset), &self.header[index])
            })?;
            previous = unit.after(previous, stamp, cell);
            stamps.push(previous);
        }
        Ok(stamps)
    }

    /// Checks that each present stamp of these rows is above the one before.
    fn advances(
        &self,
        index: usize,
        stamps: &[f64],
        rows: Range<usize>,
    ) -> Result<(), RecordingError> {
        let mut previous = f64::NEG_INFINITY;
        let used = stamps.iter().enumerate().take(rows.end).skip(rows.start);
        for (row, &stamp) in used.filter(|(_, stamp)| !stamp.is_nan()) {
            if stamp <= previous {
                let repeats = stamp == previous;
                let problem = |text| Problem::Clock {
                    text,
                    previous,
                    repeats,
                };
                return Err(self.at_row(row, index, problem));
            }
            previous = stamp;
        }
        Ok(())
    }

    /// A column as stamps that lie within half a tick of the ticks of a rate in Hz, counted from the first one.
    ///
    /// # Errors
    /// As [`Self::stamps`], and where a stamp does not lie there.
    pub fn stamps_at_rate(&self, name: &str, rate_hz: f64) -> Result<Vec<f64>, RecordingError> {
        let stamps = self.stamps(name)?;
        let ticks = |row: usize| (stamps[row] - stamps[0]) * rate_hz - row as f64;
        if let Some(row) = (0..stamps.len()).find(|&row| ticks(row).abs() > 0.5) {
            let own_rate_hz = super::health::clock(&stamps).rate().unwrap_or(0.0);
            let off = ticks(row);
            let problem = |text| Problem::Rate {
                text,
                off,
                rate_hz,
                own_rate_hz,
            };
            return Err(self.at_row(row, self.index(name)?, problem));
        }
        Ok(stamps)
    }

    /// A problem with the cell of a row, counted from 0 below the header.
    fn at_row(
        &self,
        row: usize,
        column: usize,
        problem: impl FnOnce(String) -> Problem,
    ) -> RecordingError {
        let (line, text) = match self.body().nth(row) {
            Some(Ok((offset, record))) => (self.line(offset), record[column].trim().to_owned()),
            _ => (1, String::new()),
        };
        self.at_cell(problem(text), line, &self.header[column])
    }

    /// The place of a row, counted from 0 below the header, in words; in a Parquet file it has no line.
    pub(super) fn place(&self, row: usize, column: usize) -> String {
        let problem = |text| Problem::NotANumber { text };
        match self.at_row(row, column, problem).place.line {
            Some(line) => format!("line {line}"),
            None => format!("row {row}"),
        }
    }

    /// A problem at a cell: with its line, or in a Parquet file with its row.
    fn at_cell(&self, problem: Problem, line: usize, column: &str) -> RecordingError {
        let mut error = problem.at_cell(&self.path, line, column);
        if parquet::is_one(&self.path) {
            error.place.line = None;
            error.place.row = line.checked_sub(1 + self.header_line);
        }
        error
    }

    /// Index of a column in the header; a `#` before the first name is optional.
    ///
    /// # Errors
    /// [`RecordingError`] where the header does not have it, or has it more than once.
    pub fn index(&self, name: &str) -> Result<usize, RecordingError> {
        let at_header = |problem: Problem| Err(self.at_cell(problem, self.header_line, name));
        let bare = name.trim_start_matches(marks(&self.layout));
        let is_named = |column: &String| column == name || column == bare;
        let count = self.header.iter().filter(|column| is_named(column)).count();
        match self.header.iter().position(is_named) {
            Some(index) if count == 1 => Ok(index),
            Some(_) => at_header(Problem::AmbiguousColumn(count)),
            None => at_header(Problem::NoColumn {
                present: self.header.clone(),
            }),
        }
    }

    /// The rows that are not filtered out.
    fn body(&self) -> impl Iterator<Item = Result<(Offset, csv::StringRecord), RecordingError>> {
        let is_meant = |record: &csv::StringRecord| {
            let holds = |(index, cell): &(usize, String)| record[*index].trim() == cell;
            self.only.iter().all(holds)
        };
        let rows = self.records(self.body).map(|row| {
            let (offset, record) = row?;
            let (cells, header) = (record.len(), self.header.len());
            if cells == header {
                Ok((offset, record))
            } else {
                let problem = Problem::Ragged { cells, header };
                Err(problem.at_line(&self.path, self.line(offset)))
            }
        });
        rows.filter(move |row| row.as_ref().map_or(true, |(_, record)| is_meant(record)))
    }

    /// The rows from an offset on, each with its start.
    fn records(
        &self,
        from: Offset,
    ) -> impl Iterator<Item = Result<(Offset, csv::StringRecord), RecordingError>> {
        csv::ReaderBuilder::new()
            .delimiter(self.delimiter)
            .comment(self.layout.comment.map(|mark| mark as u8))
            .has_headers(false)
            .flexible(true)
            .from_reader(&self.text.as_bytes()[from..])
            .into_records()
            .filter(|record| !matches!(record, Ok(record) if is_blank(record)))
            .map(move |record| match record {
                Ok(record) => {
                    let place = record.position().map_or(0, |p| p.byte() as usize);
                    Ok((from + place, record))
                }
                Err(error) => Err(Problem::Io(error.to_string()).in_file(&self.path)),
            })
    }

    fn number(&self, offset: Offset, column: usize, cell: &str) -> Result<f64, RecordingError> {
        let text = cell.trim();
        if self.layout.is_missing(text) {
            return Ok(f64::NAN);
        }
        let problem = match self.layout.number(text) {
            Some(value) if value.is_finite() => return Ok(value),
            Some(_) => Problem::NotFinite { text: text.into() },
            None => Problem::NotANumber { text: text.into() },
        };
        Err(self.at_cell(problem, self.line(offset), &self.header[column]))
    }

    /// The line, counted from 1, of the record at an offset. The parser's offset lies before the
    /// line ends and blank lines that it skips, which an editor counts.
    fn line(&self, offset: Offset) -> usize {
        let bytes = self.text.as_bytes();
        let skipped = bytes[offset..]
            .iter()
            .take_while(|byte| b"\r\n".contains(byte))
            .count();
        1 + count_line_ends(&bytes[..offset + skipped])
    }
}

/// A line of spaces only is one cell of spaces to the parser.
fn is_blank(record: &csv::StringRecord) -> bool {
    record.len() == 1 && record[0].trim().is_empty()
}

/// Characters before the first name of a header that are ignored.
fn marks(layout: &Layout) -> impl Fn(char) -> bool + Copy {
    let comment = layout.comment;
    move |letter: char| letter == '#' || Some(letter) == comment || letter == ' '
}
