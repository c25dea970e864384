//! Cells of a column, row by row.

use super::leaf::Leaf;
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::DataType;
use parquet::file::reader::RowGroupReader;
use std::fmt;

/// Rows in one read.
const BATCH: usize = 4096;

/// Cell, printed as in a CSV file, so that it is read back to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// Null.
    Missing,
    /// Signed integer; also a boolean, as 0 or 1.
    Integer(i64),
    /// Unsigned integer.
    Unsigned(u64),
    /// Floating-point number of 32 or 64 bits.
    Number(f64),
}

impl fmt::Display for Cell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Missing => f.write_str(super::NULL),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Unsigned(value) => write!(f, "{value}"),
            // `{:?}` writes 1e300 with an exponent, where `{}` writes 301 digits.
            Self::Number(value) => write!(f, "{value:?}"),
        }
    }
}

/// Cells of a column of the file.
#[derive(Default)]
pub struct Cells {
    /// All cells; the elements of lists row after row.
    cells: Vec<Cell>,
    /// Length of the list in each row, `None` for a null; empty for a column without lists.
    lengths: Vec<Option<usize>>,
}

/// Row whose list has another length than those before.
#[derive(Debug, PartialEq, Eq)]
pub struct Uneven {
    /// Row, counted from 0.
    pub row: usize,
    /// Elements in this row.
    pub length: usize,
    /// Elements in the rows before.
    pub usual: usize,
}

impl Cells {
    /// Adds the rows of a row group.
    ///
    /// # Errors
    /// The reader's reason where the group is damaged.
    pub fn add(
        &mut self,
        group: &dyn RowGroupReader,
        leaf: &Leaf,
        rows: usize,
    ) -> Result<(), String> {
        let integer = |signed: i64, unsigned: u64| match leaf.is_unsigned {
            true => Cell::Unsigned(unsigned),
            false => Cell::Integer(signed),
        };
        let reader = group.get_column_reader(leaf.index);
        let read = match reader.map_err(|error| error.to_string())? {
            ColumnReader::BoolColumnReader(own) => {
                self.take(own, leaf, rows, |v| Cell::Integer(i64::from(*v)))
            }
            ColumnReader::Int32ColumnReader(own) => self.take(own, leaf, rows, |v| {
                integer(i64::from(*v), u64::from(v.cast_unsigned()))
            }),
            ColumnReader::Int64ColumnReader(own) => {
                self.take(own, leaf, rows, |v| integer(*v, v.cast_unsigned()))
            }
            ColumnReader::FloatColumnReader(own) => {
                self.take(own, leaf, rows, |v| Cell::Number(f64::from(*v)))
            }
            ColumnReader::DoubleColumnReader(own) => {
                self.take(own, leaf, rows, |v| Cell::Number(*v))
            }
            _ => return Err("it holds no numbers".into()),
        }?;
        match read == rows {
            true => Ok(()),
            false => Err(format!("{read} rows are there of {rows}")),
        }
    }

    /// Adds all rows of a reader and counts them; stops once there are more than expected.
    fn take<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        leaf: &Leaf,
        rows: usize,
        cell: impl Fn(&T::T) -> Cell,
    ) -> Result<usize, String> {
        let (mut levels, mut repeated, mut values) = (Vec::new(), Vec::new(), Vec::new());
        let mut count = 0;
        while count <= rows {
            levels.clear();
            repeated.clear();
            values.clear();
            let (there, again) = (Some(&mut levels), Some(&mut repeated));
            let read = reader.read_records(BATCH, there, again, &mut values);
            let (records, _, slots) = read.map_err(|error| error.to_string())?;
            if records == 0 {
                break;
            }
            count += records;
            let mut left = values.iter();
            for slot in 0..slots {
                // A required column has no levels.
                let level = levels.get(slot).copied().unwrap_or(leaf.there);
                let value = if level == leaf.there {
                    left.next().map(&cell)
                } else {
                    None
                };
                let begins = repeated.get(slot).is_none_or(|level| *level == 0);
                self.slot(value.unwrap_or(Cell::Missing), level, leaf.element, begins);
            }
        }
        Ok(count)
    }

    /// Adds a number, an element of a list, or an empty or null list.
    fn slot(&mut self, cell: Cell, level: i16, element: Option<i16>, begins: bool) {
        let Some(element) = element else {
            return self.cells.push(cell);
        };
        let is_one = level >= element;
        if is_one {
            self.cells.push(cell);
        }
        match self.lengths.last_mut() {
            Some(length) if !begins => *length = Some(length.unwrap_or(0) + usize::from(is_one)),
            _ => self
                .lengths
                .push((level >= element - 1).then_some(usize::from(is_one))),
        }
    }

    /// Columns of the text with their names: one, or one for each element of the lists.
    ///
    /// # Errors
    /// The first row whose list has another length than those before.
    pub fn columns(self, leaf: &Leaf) -> Result<Vec<(String, Vec<Cell>)>, Uneven> {
        if leaf.element.is_none() {
            return Ok(vec![(leaf.name.clone(), self.cells)]);
        }
        let usual = self.lengths.iter().flatten().next().copied().unwrap_or(0);
        let name = |element: usize| (format!("{}[{element}]", leaf.name), Vec::new());
        let mut columns: Vec<_> = (0..usual).map(name).collect();
        let mut cells = self.cells.iter().copied();
        for (row, length) in self.lengths.iter().enumerate() {
            if let Some(length) = length.filter(|length| *length != usual) {
                return Err(Uneven { row, length, usual });
            }
            for (_, column) in &mut columns {
                let cell = length.and_then(|_| cells.next());
                column.push(cell.unwrap_or(Cell::Missing));
            }
        }
        Ok(columns)
    }
}
