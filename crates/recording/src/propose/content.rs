//! A CSV file before its meaning is known.

use super::super::error::{Problem, RecordingError};
use super::super::layout::Layout;
use super::super::role::Role;
use super::super::table::{self, Table, parquet};
use super::column::{Bad, Column};
use super::form;
use super::joint_states;
use super::name;
use super::preamble::Step;
use super::stand_in;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Most lines that are read of a known form.
const HEAD: usize = 400;

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
    /// The step of its samples that a line above its table tells.
    pub told_step: Option<Step>,
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
        let known = match layout.header {
            Some(false) => joint_states(&table),
            _ => None,
        };
        let titles = form.names.or(known);
        let titles = titles.unwrap_or_else(|| table.header().to_vec());
        Ok(Self {
            told_rate_hz,
            told_step: form.step,
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
        columns.iter_mut().for_each(Column::go_on);
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
            told_step: None,
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

/// The names of the columns of joint states that have no header, if the same ones stand in all rows.
fn joint_states(table: &Table) -> Option<Vec<String>> {
    let mut rows = table.rows();
    let cells = |row: &csv::StringRecord| row.iter().map(str::to_owned).collect::<Vec<_>>();
    let first = cells(&rows.next()?.ok()?);
    let names = joint_states::names(&first)?;
    let is_text = |k: &usize| *k > 2 && first[*k].trim().parse::<f64>().is_err();
    let texts: Vec<usize> = (0..first.len()).filter(is_text).collect();
    let same = |row: csv::StringRecord| texts.iter().all(|&k| row[k] == first[k]);
    rows.all(|row| row.is_ok_and(same)).then_some(names)
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
