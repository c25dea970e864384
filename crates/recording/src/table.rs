//! CSV and gzipped CSV as a table of text, and its columns as numbers.

use super::error::{Problem, RecordingError, from_io};
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// The first two bytes of a gzip stream (RFC 1952).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// A CSV file in memory: a header, and rows that are read when asked for.
///
/// The separator is the one of `,` `;` and tab that the header has most of. A byte order mark is
/// dropped and blank lines are skipped.
#[derive(Clone, Debug)]
pub struct Table {
    path: PathBuf,
    text: String,
    delimiter: u8,
    header: Vec<String>,
}

/// Where a row begins in the text; its line is counted only for an error.
type Offset = usize;

impl Table {
    /// Reads a `.csv` or `.csv.gz` file; gzip is known by its first bytes, not by the name.
    ///
    /// # Errors
    /// [`RecordingError`] where the file is missing, empty, damaged or not UTF-8.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let bytes = bytes(path).map_err(|problem| problem.in_file(path))?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
            Problem::NotUtf8.at_line(path, 1 + count_line_ends(valid))
        })?;
        let mut text = text;
        if let Some(marked) = text.strip_prefix('\u{feff}') {
            text.drain(..text.len() - marked.len());
        }
        Self::from_text(path, text)
    }

    fn from_text(path: &Path, text: String) -> Result<Self, RecordingError> {
        let first = text.lines().find(|line| !line.trim().is_empty());
        let first = first.ok_or_else(|| Problem::Empty.in_file(path))?;
        let delimiter = delimiter(first);
        let mut table = Self {
            path: path.into(),
            text,
            delimiter,
            header: Vec::new(),
        };
        let header = table
            .records()
            .next()
            .unwrap_or_else(|| Err(Problem::Empty.in_file(path)))?
            .1;
        table.header = header.iter().map(|cell| cell.trim().to_owned()).collect();
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

    /// Columns as finite numbers, in the order of `names`.
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

    /// A column as strictly increasing stamps, s.
    ///
    /// # Errors
    /// As [`Self::numbers`], and where time repeats or runs backwards.
    pub fn stamps(&self, name: &str) -> Result<Vec<f64>, RecordingError> {
        let index = self.index(name)?;
        let stamps = self.numbers(&[name])?.swap_remove(0);
        if let Some(after) = stamps.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (previous, repeats) = (stamps[after], stamps[after + 1] == stamps[after]);
            let problem = |text| Problem::Clock {
                text,
                previous,
                repeats,
            };
            return Err(self.at_row(after + 1, index, problem));
        }
        Ok(stamps)
    }

    /// A column as stamps that lie within half a tick of the ticks of a rate in Hz, counted from
    /// the first one.
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
        problem(text).at_cell(&self.path, line, &self.header[column])
    }

    /// Where a column is in the header.
    ///
    /// # Errors
    /// [`RecordingError`] where the header does not have it, or has it more than once.
    pub fn index(&self, name: &str) -> Result<usize, RecordingError> {
        let at_header = |problem: Problem| {
            let offset = self
                .records()
                .next()
                .and_then(Result::ok)
                .map_or(0, |row| row.0);
            Err(problem.at_cell(&self.path, self.line(offset), name))
        };
        let count = self.header.iter().filter(|column| *column == name).count();
        match self.header.iter().position(|column| column == name) {
            Some(index) if count == 1 => Ok(index),
            Some(_) => at_header(Problem::AmbiguousColumn(count)),
            None => at_header(Problem::NoColumn {
                present: self.header.clone(),
            }),
        }
    }

    fn body(&self) -> impl Iterator<Item = Result<(Offset, csv::StringRecord), RecordingError>> {
        self.records().skip(1).map(|row| {
            let (offset, record) = row?;
            let (cells, header) = (record.len(), self.header.len());
            if cells == header {
                Ok((offset, record))
            } else {
                let problem = Problem::Ragged { cells, header };
                Err(problem.at_line(&self.path, self.line(offset)))
            }
        })
    }

    /// The header and the rows, each with the place where it begins.
    fn records(&self) -> impl Iterator<Item = Result<(Offset, csv::StringRecord), RecordingError>> {
        csv::ReaderBuilder::new()
            .delimiter(self.delimiter)
            .has_headers(false)
            .flexible(true)
            .from_reader(self.text.as_bytes())
            .into_records()
            .filter(|record| !matches!(record, Ok(record) if is_blank(record)))
            .map(|record| match record {
                Ok(record) => Ok((record.position().map_or(0, |p| p.byte() as usize), record)),
                Err(error) => Err(Problem::Io(error.to_string()).in_file(&self.path)),
            })
    }

    fn number(&self, offset: Offset, column: usize, cell: &str) -> Result<f64, RecordingError> {
        let text = cell.trim();
        let problem = match text.parse::<f64>() {
            Ok(value) if value.is_finite() => return Ok(value),
            Ok(_) => Problem::NotFinite { text: text.into() },
            Err(_) => Problem::NotANumber { text: text.into() },
        };
        Err(problem.at_cell(&self.path, self.line(offset), &self.header[column]))
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

fn count_line_ends(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}

fn delimiter(header: &str) -> u8 {
    // The last of equals wins, so a header with none of them counts as comma-separated.
    let count = |delimiter: &u8| header.bytes().filter(|byte| byte == delimiter).count();
    [b'\t', b';', b',']
        .into_iter()
        .max_by_key(count)
        .unwrap_or(b',')
}

fn bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(|error| from_io(&error))?;
    file.read_to_end(&mut bytes)
        .map_err(|error| from_io(&error))?;
    let is_named_gzip = path.extension().is_some_and(|extension| extension == "gz");
    if bytes.is_empty() || !(is_named_gzip || bytes.starts_with(&GZIP)) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    match MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut text) {
        Ok(_) => Ok(text),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            Err(Problem::Gzip("it ends early, the file is cut off".into()))
        }
        Err(error) => Err(Problem::Gzip(error.to_string())),
    }
}
