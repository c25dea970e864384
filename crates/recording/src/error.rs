//! Why a recording is refused: the place and the problem.

mod words;

pub use words::nearest;
pub(super) use words::shortened;

use std::fmt;
use std::path::{Path, PathBuf};
use words::{columns, hint, quoted, suggestion};

/// Why a recording cannot be read or written, with its place in the file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{place}{problem}")]
pub struct RecordingError {
    /// Where it was found.
    pub place: Place,
    /// The fault.
    pub problem: Problem,
}

/// File, line and column of a problem, as an editor shows them; byte, topic and field of an MCAP file; row, column or byte of
/// a Parquet file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The manifest, the CSV file, the MCAP file or the Parquet file.
    pub file: PathBuf,
    /// Line, counted from 1, where the problem has one.
    pub line: Option<usize>,
    /// Column of that line, in characters counted from 1, where a manifest is no TOML.
    pub character: Option<usize>,
    /// Row of a Parquet file, counted from 0, where the problem has one.
    pub row: Option<usize>,
    /// Name of the column of a CSV or Parquet file, where the problem has one.
    pub column: Option<String>,
    /// Byte of an MCAP or Parquet file, counted from 0, where the problem has one.
    pub byte: Option<usize>,
    /// Topic of an MCAP file, where the problem has one.
    pub topic: Option<String>,
    /// Field of the topic's messages, where the problem has one.
    pub field: Option<String>,
}

/// A fault of a manifest, a CSV, MCAP or Parquet file; carries the bad value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The file or folder is not there.
    #[error("no such file or folder")]
    Missing,
    /// The folder holds no `recording.toml`.
    #[error("this folder has no recording.toml")]
    NoManifest,
    /// A CSV file whose columns are not clear from the file.
    #[error("what its columns are is not certain: {open}")]
    Uncertain {
        /// The open questions, in a few words.
        open: String,
    },
    /// A known format that cannot be read.
    #[error("{} is not read: {}", .0.name, .0.remedy)]
    Foreign(super::foreign::Foreign),
    /// A cell is no time of this unit.
    #[error("{} is no time in {unit}", quoted(.text))]
    NotATime {
        /// The cell.
        text: String,
        /// The unit's name in a manifest.
        unit: &'static str,
    },
    /// The operating system refused to read or write it.
    #[error("{0}")]
    Io(String),
    /// The manifest is not TOML or a value has the wrong type.
    #[error("{0}")]
    Toml(String),
    /// A key that manifests do not have.
    #[error("unknown key \"{key}\"{advice}")]
    UnknownKey {
        /// The key.
        key: String,
        /// Where it belongs, or the known key it resembles.
        advice: String,
    },
    /// A role that is not in the table of roles.
    #[error("unknown role \"{role}\"{}", suggestion(.nearest))]
    UnknownRole {
        /// The role.
        role: String,
        /// The known role it resembles.
        nearest: Option<&'static str>,
    },
    /// A unit that is not in the table of units.
    #[error("unknown unit \"{unit}\"{}", suggestion(.nearest))]
    UnknownUnit {
        /// The unit.
        unit: String,
        /// The known unit it resembles.
        nearest: Option<&'static str>,
    },
    /// A key is missing, given twice in two forms, or its value is out of range.
    #[error("{key}: {reason}")]
    Key {
        /// The key.
        key: &'static str,
        /// The reason why it is refused.
        reason: String,
    },
    /// The file has no bytes, or only blank lines.
    #[error("the file is empty")]
    Empty,
    /// A text without rows of numbers.
    #[error("there are no rows of numbers in this file")]
    NoNumbers,
    /// The file has a header and no rows.
    #[error("the file has a header but no rows")]
    NoRows,
    /// The gzip stream ends early or is damaged.
    #[error("the gzip data cannot be read: {0}")]
    Gzip(String),
    /// A Parquet file is damaged, or has a compression that is not supported.
    #[error("the Parquet data cannot be read: {0}")]
    Parquet(String),
    /// A column of a Parquet file does not hold numbers.
    #[error("{0}")]
    NotNumbers(String),
    /// A list in a Parquet file has another length than those in the rows before.
    #[error("the list has {length} elements, but those before have {usual}")]
    Uneven {
        /// Elements in this row.
        length: usize,
        /// Elements in the rows before.
        usual: usize,
    },
    /// The bytes are not UTF-8 text.
    #[error("the text is not UTF-8")]
    NotUtf8,
    /// The column is not in the header.
    #[error("no such column; {}", columns(present))]
    NoColumn {
        /// The columns that are there.
        present: Vec<String>,
    },
    /// The header has the column more than once.
    #[error("the header has this column {0} times")]
    AmbiguousColumn(usize),
    /// A row has not as many cells as the header.
    #[error("{cells} cells where the header has {header}")]
    Ragged {
        /// Cells in the row.
        cells: usize,
        /// Cells in the header.
        header: usize,
    },
    /// A cell does not hold a number.
    #[error("{} is not a number{}", quoted(.text), hint(.text))]
    NotANumber {
        /// The cell.
        text: String,
    },
    /// A cell holds NaN or an infinity.
    #[error("{} is not a finite number", quoted(.text))]
    NotFinite {
        /// The cell.
        text: String,
    },
    /// A cell holds a number that is no measurement and no command.
    #[error("{} is beyond {:e}, which nothing measures: check unit and scale", quoted(.text), crate::carries::LARGEST)]
    Impossible {
        /// The cell.
        text: String,
    },
    /// The time of a row is not above the time of the row before.
    #[error(
        "time {} ({} after {} s)",
        if .repeats == &true { "repeats" } else { "runs backwards" },
        quoted(.text),
        super::plain(*.previous)
    )]
    Clock {
        /// The cell.
        text: String,
        /// Time of the row before, s.
        previous: f64,
        /// Whether it is the same time again.
        repeats: bool,
    },
    /// A stamp does not lie on the ticks of the rate that was given.
    #[error(
        "time \"{text}\" is {off:.2} ticks from its place at {rate_hz} Hz (the file runs at about \
         {own_rate_hz:.2} Hz)"
    )]
    Rate {
        /// The cell.
        text: String,
        /// Distance from the row's tick, ticks.
        off: f64,
        /// The rate that was given, Hz.
        rate_hz: f64,
        /// The rate by the median interval, Hz.
        own_rate_hz: f64,
    },
    /// An MCAP file is damaged, or does not have what is looked for.
    #[error("{0}")]
    Mcap(String),
    /// An MCAP file without a topic that says which role it has.
    #[error("none of its topics is known to have a role")]
    NoJoints,
    /// A channel that was to be written is not well formed.
    #[error("channel {role}: {reason}")]
    Channel {
        /// The channel's role.
        role: &'static str,
        /// The fault.
        reason: String,
    },
}

impl RecordingError {
    /// The operating system's error on a file.
    pub fn io(file: &Path, error: &std::io::Error) -> Self {
        from_io(error).in_file(file)
    }

    /// Whether the operating system refused; otherwise the recording is invalid.
    pub fn is_io(&self) -> bool {
        matches!(self.problem, Problem::Io(_) | Problem::Missing)
    }
}

/// The operating system's error, with "missing" told apart.
pub(super) fn from_io(error: &std::io::Error) -> Problem {
    match error.kind() {
        std::io::ErrorKind::NotFound => Problem::Missing,
        _ => Problem::Io(error.to_string()),
    }
}

impl Problem {
    /// The problem in a file, without a line.
    pub fn in_file(self, file: &Path) -> RecordingError {
        RecordingError {
            place: Place {
                file: file.into(),
                ..Place::default()
            },
            problem: self,
        }
    }

    /// The problem at a line of a file.
    pub fn at_line(self, file: &Path, line: usize) -> RecordingError {
        let place = Place {
            file: file.into(),
            line: Some(line),
            ..Place::default()
        };
        RecordingError {
            place,
            problem: self,
        }
    }

    /// The problem at a cell of a CSV file.
    pub fn at_cell(self, file: &Path, line: usize, column: &str) -> RecordingError {
        let place = Place {
            file: file.into(),
            line: Some(line),
            column: Some(column.into()),
            ..Place::default()
        };
        RecordingError {
            place,
            problem: self,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Data in memory have no file.
        if *self == Self::default() {
            return Ok(());
        }
        write!(f, "{}:", self.file.display())?;
        for number in self.line.iter().chain(&self.character) {
            write!(f, "{number}:")?;
        }
        if let Some(row) = self.row {
            write!(f, " row {row}:")?;
        }
        if let Some(column) = &self.column {
            write!(f, " column \"{column}\":")?;
        }
        if let Some(byte) = self.byte {
            write!(f, " byte {byte}:")?;
        }
        for (what, name) in [("topic", &self.topic), ("field", &self.field)] {
            if let Some(name) = name {
                write!(f, " {what} \"{name}\":")?;
            }
        }
        f.write_str(" ")
    }
}
