//! A file as a table of all its columns, or of the wanted ones.

use super::NULL;
use super::caught::caught;
use super::cells::{Cell, Cells};
use super::leaf::Leaf;
use crate::error::{Place, Problem, RecordingError, from_io};
use crate::layout::Layout;
use crate::table::Table;
use parquet::basic::Compression;
use parquet::file::reader::{FileReader, SerializedFileReader};
use std::fmt::Write;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// First and last bytes of a file.
const MAGIC: &[u8] = b"PAR1";
/// Bytes of the smallest file: the magic bytes at both ends, and the length of the metadata.
const LEAST: u64 = 12;

/// The file as a table of the wanted columns, or of all that can be read.
///
/// Of the layout only `missing` and `only` apply. Null cells are always missing.
///
/// # Errors
/// [`RecordingError`] with column and row where the file is damaged, or a wanted column holds no numbers.
pub fn table(
    path: &Path,
    layout: &Layout,
    wanted: Option<&[&str]>,
) -> Result<Table, RecordingError> {
    let file = Parquet::open(path)?;
    let mut columns = Vec::new();
    for leaf in &file.leaves {
        let meant = |wanted: &[&str]| wanted.iter().any(|name| leaf.is_meant(name));
        let is_wanted = wanted.map(meant);
        if is_wanted == Some(false) {
            continue;
        }
        match file.columns(leaf) {
            Ok(more) => columns.extend(more),
            // A column that nobody named may hold anything, but damage is always an error.
            Err(error) if is_wanted.is_some() || is_damage(&error.problem) => return Err(error),
            Err(error) => tracing::warn!("left out: {error}"),
        }
    }
    let there = |name: &&str| columns.iter().any(|(own, _)| own == name);
    if wanted.is_some_and(|wanted| !wanted.iter().all(there)) {
        // With all columns, so that the error lists them.
        return table(path, layout, None);
    }
    if columns.is_empty() {
        return Err(Problem::NoNumbers.in_file(path));
    }
    let mut missing = layout.missing.clone().unwrap_or_default();
    missing.push(NULL.into());
    let layout = Layout {
        delimiter: Some(','),
        missing: Some(missing),
        only: layout.only.clone(),
        ..Layout::default()
    };
    Table::from_text(path, text(&columns), &layout)
}

/// Whether the column is damaged, and not only without numbers.
fn is_damage(problem: &Problem) -> bool {
    !matches!(problem, Problem::NotNumbers(_) | Problem::Uneven { .. })
}

/// Columns as the text of a CSV file.
fn text(columns: &[(String, Vec<Cell>)]) -> String {
    let quoted = |name: &str| {
        format!(
            "\"{}\"",
            name.replace(['\n', '\r'], " ").replace('"', "\"\"")
        )
    };
    let names: Vec<String> = columns.iter().map(|(name, _)| quoted(name)).collect();
    let mut text = names.join(",") + "\n";
    let rows = columns.iter().map(|(_, cells)| cells.len()).max();
    for row in 0..rows.unwrap_or(0) {
        for (column, (_, cells)) in columns.iter().enumerate() {
            let comma = if column > 0 { "," } else { "" };
            let cell = cells.get(row).copied().unwrap_or(Cell::Missing);
            // Writing to a string cannot fail.
            let _ = write!(text, "{comma}{cell}");
        }
        text.push('\n');
    }
    text
}

/// Open file.
struct Parquet<'a> {
    path: &'a Path,
    reader: SerializedFileReader<File>,
    leaves: Vec<Leaf>,
}

impl<'a> Parquet<'a> {
    fn open(path: &'a Path) -> Result<Self, RecordingError> {
        let file = whole(path)?;
        let read = caught(|| {
            let reader = SerializedFileReader::new(file).map_err(|error| error.to_string())?;
            let schema = reader.metadata().file_metadata().schema_descr();
            let columns = schema.columns().iter().enumerate();
            let leaves =
                columns.map(|(index, column)| Leaf::of(index, column, schema.root_schema()));
            let leaves = leaves.collect();
            Ok(Self {
                path,
                reader,
                leaves,
            })
        });
        read.map_err(|reason| Problem::Parquet(reason).in_file(path))
    }

    /// Columns of the text for a column of the file.
    fn columns(&self, leaf: &Leaf) -> Result<Vec<(String, Vec<Cell>)>, RecordingError> {
        if let Some(reason) = &leaf.refused {
            return Err(self.at(leaf, None, Problem::NotNumbers(reason.clone())));
        }
        let mut cells = Cells::default();
        for number in 0..self.reader.num_row_groups() {
            let read = caught(|| self.group(number, leaf, &mut cells));
            read.map_err(|reason| {
                let place = format!("row group {number}: {reason}");
                self.at(leaf, None, Problem::Parquet(place))
            })?;
        }
        cells.columns(leaf).map_err(|uneven| {
            let (length, usual) = (uneven.length, uneven.usual);
            self.at(leaf, Some(uneven.row), Problem::Uneven { length, usual })
        })
    }

    fn group(&self, number: usize, leaf: &Leaf, cells: &mut Cells) -> Result<(), String> {
        let of = self.reader.metadata().row_group(number);
        let column = of
            .columns()
            .get(leaf.index)
            .ok_or("the column is missing")?;
        supported(column.compression())?;
        let rows = usize::try_from(of.num_rows()).map_err(|_| "its number of rows is negative")?;
        let group = self.reader.get_row_group(number);
        let group = group.map_err(|error| error.to_string())?;
        cells.add(group.as_ref(), leaf, rows)
    }

    fn at(&self, leaf: &Leaf, row: Option<usize>, problem: Problem) -> RecordingError {
        let place = Place {
            file: self.path.into(),
            column: Some(leaf.name.clone()),
            row,
            ..Place::default()
        };
        RecordingError { place, problem }
    }
}

/// Refuses a compression that this build does not decode.
fn supported(codec: Compression) -> Result<(), String> {
    use Compression::{GZIP, SNAPPY, UNCOMPRESSED, ZSTD};
    if matches!(codec, UNCOMPRESSED | SNAPPY | GZIP(_) | ZSTD(_)) {
        return Ok(());
    }
    // Without the level in brackets.
    let words = codec.to_string();
    let name = words.split('(').next().unwrap_or_default();
    Err(format!(
        "compression {name} is not read: write the file with snappy, gzip or zstd"
    ))
}

/// Opens a file, and checks the magic bytes at both ends.
fn whole(path: &Path) -> Result<File, RecordingError> {
    let ends = || -> std::io::Result<(File, u64, [[u8; MAGIC.len()]; 2])> {
        let mut file = File::open(path)?;
        let length = file.metadata()?.len();
        let mut ends = [[0; MAGIC.len()]; 2];
        if length >= LEAST {
            file.read_exact(&mut ends[0])?;
            file.seek(SeekFrom::End(-(MAGIC.len() as i64)))?;
            file.read_exact(&mut ends[1])?;
        }
        Ok((file, length, ends))
    };
    let (file, length, [first, last]) = ends().map_err(|error| from_io(&error).in_file(path))?;
    let at = |byte: u64, problem: Problem| {
        let place = Place {
            file: path.into(),
            byte: usize::try_from(byte).ok(),
            ..Place::default()
        };
        Err(RecordingError { place, problem })
    };
    match length {
        0 => Err(Problem::Empty.in_file(path)),
        _ if length >= LEAST && first != MAGIC => at(
            0,
            Problem::Parquet("it does not begin with PAR1: it is not a Parquet file".into()),
        ),
        _ if last != MAGIC => at(
            length,
            Problem::Parquet(
                "it ends without PAR1: it was cut off, or is not a Parquet file".into(),
            ),
        ),
        _ => Ok(file),
    }
}
