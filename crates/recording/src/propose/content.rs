//! A CSV file before its meaning is known.

use super::super::error::{Problem, RecordingError};
use super::super::layout::Layout;
use super::super::role::Role;
use super::super::stamp::TimeUnit;
use super::super::table::{self, Table, parquet};
use super::form;
use super::name::{self, Name};
use super::stand_in;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Usual cells for missing values.
const MISSING: &[&str] = &[
    "", "NaN", "nan", "NAN", "NA", "N/A", "null", "NULL", "None", "-",
];
/// Most lines that are read of a known form.
const HEAD: usize = 400;
/// Most sensors whose rows stand in turn.
const MOST_IN_TURN: usize = 20;
/// Most values of a column that tells tests apart.
const MOST_TESTS: usize = 1000;

/// A file, its form, and its columns.
pub struct Content {
    /// The file.
    pub path: PathBuf,
    /// Its form.
    pub layout: Layout,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Samples per second at the end of files of RepRapFirmware.
    pub told_rate_hz: Option<f64>,
}

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
    /// Its distinct cells in their order, if there are few.
    pub distinct: Vec<String>,
    /// The rows from which on these stand, counted from 0.
    pub begins: Vec<usize>,
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

impl Content {
    /// The first lines of a file of Klipper or RepRapFirmware, which are sufficient; `None` for other files.
    ///
    /// # Errors
    /// As [`Content::read`].
    pub fn known(path: &Path) -> Result<Option<Self>, RecordingError> {
        if parquet::is_one(path) {
            return Ok(None);
        }
        let text = table::text(path)?;
        let head: Vec<&str> = text.lines().take(HEAD).collect();
        let last = text.trim_end().lines().last().unwrap_or_default();
        if form::of(&text).is_none() {
            return Ok(None);
        }
        // What is wrong with these lines is told by the whole file, which has its line numbers.
        let Ok(content) = Self::of(path, head.join("\n") + "\n" + last) else {
            return Ok(None);
        };
        let is_known = content.is_klipper() || content.told_rate_hz.is_some();
        Ok(is_known.then_some(content))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// [`RecordingError`] where it cannot be read, or has no numbers.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        if parquet::is_one(path) {
            let table = Table::open(path)?;
            let titles = table.header().to_vec();
            return Self::of_table(&table, Layout::default(), &titles);
        }
        Self::of(path, table::text(path)?)
    }

    fn of(path: &Path, text: String) -> Result<Self, RecordingError> {
        if text.trim().is_empty() {
            return Err(Problem::Empty.in_file(path));
        }
        let form = form::of(&text).ok_or_else(|| Problem::NoNumbers.in_file(path))?;
        let layout = form.layout;
        let last = text.trim_end().lines().last().unwrap_or_default();
        let told_rate_hz = told_rate(last);
        let table = Table::from_text(path, text, &layout)?;
        let titles = form.names.unwrap_or_else(|| table.header().to_vec());
        Ok(Self {
            told_rate_hz,
            ..Self::of_table(&table, layout, &titles)?
        })
    }

    /// Content of a table in this layout, with a title for each column.
    fn of_table(
        table: &Table,
        mut layout: Layout,
        titles: &[String],
    ) -> Result<Self, RecordingError> {
        let path = table.path();
        let mut columns: Vec<Column> = Vec::new();
        for (called, title) in table.header().iter().zip(titles) {
            columns.push(Column::new(called, title));
        }
        let mut missing = BTreeSet::new();
        for row in table.rows() {
            for (column, cell) in columns.iter_mut().zip(&row?) {
                if column.take(cell.trim(), &layout) {
                    missing.insert(cell.trim().to_owned());
                }
            }
        }
        missing.extend(stand_ins(&mut columns, table, &layout)?);
        place(&mut columns, table);
        if columns
            .first()
            .is_none_or(|column| column.numbers.is_empty())
        {
            return Err(Problem::NoRows.in_file(path));
        }
        // Nulls in a Parquet file are always missing, so the manifest need not say it.
        if parquet::is_one(path) {
            missing.remove(parquet::NULL);
        }
        layout.missing = (!missing.is_empty()).then(|| missing.into_iter().collect());
        Ok(Self {
            path: path.into(),
            layout,
            columns,
            told_rate_hz: None,
        })
    }

    /// Whether it is Klipper's raw data of an accelerometer: s and mm/s^2.
    pub fn is_klipper(&self) -> bool {
        let titles = self.columns.iter().map(|column| column.title.as_str());
        titles.eq(["time", "accel_x", "accel_y", "accel_z"])
    }

    /// Whether the file's name is that of an accelerometer.
    pub fn is_called_accelerometer(&self) -> bool {
        let role = name::parse(&self.stem()).role();
        role.is_some_and(|(role, _)| role == Role::TipAcceleration)
    }

    /// The file's name without its endings.
    pub fn stem(&self) -> String {
        let name = self.path.file_name().unwrap_or_default().to_string_lossy();
        name.split('.').next().unwrap_or_default().into()
    }
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

/// Takes numbers that stand for missing samples for such, and gives their cells.
fn stand_ins(
    columns: &mut [Column],
    table: &Table,
    layout: &Layout,
) -> Result<BTreeSet<String>, RecordingError> {
    let found: Vec<_> = columns
        .iter()
        .map(|own| stand_in::of(&own.numbers))
        .collect();
    // A cell that is missing is so in all columns: none may have it for a value.
    let is_value = |mark: f64| {
        let others = columns.iter().zip(&found);
        let others = others.filter(|(_, own)| **own != Some(mark));
        let mut values = others.flat_map(|(own, _)| &own.numbers);
        values.any(|own| *own == mark)
    };
    let marks = found.iter().map(|own| own.filter(|mark| !is_value(*mark)));
    let marks: Vec<Option<f64>> = marks.collect();
    let mut cells = BTreeSet::new();
    if marks.iter().all(Option::is_none) {
        return Ok(cells);
    }
    for row in table.rows() {
        let row = row?;
        let marked = row.iter().zip(&marks);
        let found =
            marked.filter(|(cell, mark)| mark.is_some() && layout.number(cell.trim()) == **mark);
        cells.extend(found.map(|(cell, _)| cell.trim().to_owned()));
    }
    for (column, mark) in columns.iter_mut().zip(marks) {
        for number in column.numbers.iter_mut().filter(|own| Some(**own) == mark) {
            *number = f64::NAN;
        }
    }
    Ok(cells)
}

/// Tells where the bad cells of columns of numbers are.
fn place(columns: &mut [Column], table: &Table) {
    for (index, column) in columns.iter_mut().enumerate() {
        let is_wanted = column.is_mostly_numeric();
        let is_told = |bad: &&mut Bad| is_wanted || bad.is_hexadecimal();
        let bad = column.bad.as_mut().filter(is_told);
        for bad in bad.into_iter().chain(&mut column.grouped) {
            bad.place = table.place(bad.row, index);
        }
    }
}

impl Column {
    fn new(called: &str, title: &str) -> Self {
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
            distinct: Vec::new(),
            begins: Vec::new(),
        }
    }

    /// Adds a cell; returns whether it is missing.
    fn take(&mut self, cell: &str, layout: &Layout) -> bool {
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

/// `Rate 1344, overflows 0`
fn told_rate(line: &str) -> Option<f64> {
    let rate: f64 = line
        .strip_prefix("Rate ")?
        .split(',')
        .next()?
        .trim()
        .parse()
        .ok()?;
    (rate.is_finite() && rate > 0.0).then_some(rate)
}
