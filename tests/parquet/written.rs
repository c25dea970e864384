//! Parquet files for the tests.

use parquet::basic::Compression;
use parquet::data_type::{ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use std::sync::Arc;

/// A list in a row, or null; its elements may be null.
pub type List = Option<Vec<Option<f32>>>;

/// A column; a cell may be null.
#[derive(Clone)]
pub enum Column {
    Double(Vec<Option<f64>>),
    Float(Vec<Option<f32>>),
    Int32(Vec<Option<i32>>),
    Int64(Vec<Option<i64>>),
    /// Unsigned integers, by their bits.
    Unsigned(Vec<Option<i64>>),
    Text(Vec<Option<&'static str>>),
    Lists(Vec<List>),
}

use Column::{Double, Float, Int32, Int64, Lists, Text, Unsigned};

/// Bytes of a file with so many rows in each row group.
pub fn written(
    columns: &[(&str, Column)],
    compression: Compression,
    rows_of_group: usize,
) -> Vec<u8> {
    let fields: String = columns.iter().map(field).collect();
    let schema = parse_message_type(&format!("message schema {{ {fields} }}")).unwrap();
    let properties = WriterProperties::builder().set_compression(compression);
    let properties = Arc::new(properties.build());
    let mut writer = SerializedFileWriter::new(Vec::new(), Arc::new(schema), properties).unwrap();
    let rows = columns
        .iter()
        .map(|(_, column)| column.len())
        .max()
        .unwrap();
    for first in (0..rows).step_by(rows_of_group) {
        let mut group = writer.next_row_group().unwrap();
        for (_, column) in columns {
            column.write(first, (first + rows_of_group).min(rows), &mut group);
        }
        group.close().unwrap();
    }
    writer.into_inner().unwrap()
}

fn field((name, column): &(&str, Column)) -> String {
    let kind = match column {
        Double(_) => "double",
        Float(_) => "float",
        Int32(_) => "int32",
        Int64(_) => "int64",
        Unsigned(_) => return format!("optional int64 {name} (UINT_64); "),
        Text(_) => return format!("optional binary {name} (UTF8); "),
        Lists(_) => {
            return format!(
                "optional group {name} (LIST) {{ repeated group list {{ optional float element; }} }} "
            );
        }
    };
    format!("optional {kind} {name}; ")
}

impl Column {
    fn len(&self) -> usize {
        match self {
            Double(cells) => cells.len(),
            Float(cells) => cells.len(),
            Int32(cells) => cells.len(),
            Int64(cells) | Unsigned(cells) => cells.len(),
            Text(cells) => cells.len(),
            Lists(rows) => rows.len(),
        }
    }

    fn write(&self, first: usize, last: usize, group: &mut SerializedRowGroupWriter<Vec<u8>>) {
        match self {
            Double(cells) => flat::<DoubleType>(&cells[first..last], group),
            Float(cells) => flat::<FloatType>(&cells[first..last], group),
            Int32(cells) => flat::<Int32Type>(&cells[first..last], group),
            Int64(cells) | Unsigned(cells) => flat::<Int64Type>(&cells[first..last], group),
            Text(cells) => {
                let bytes = cells[first..last].iter().map(|cell| cell.map(Into::into));
                flat::<ByteArrayType>(&bytes.collect::<Vec<_>>(), group);
            }
            Lists(rows) => lists(&rows[first..last], group),
        }
    }
}

fn flat<T: DataType>(cells: &[Option<T::T>], group: &mut SerializedRowGroupWriter<Vec<u8>>) {
    let levels: Vec<i16> = cells.iter().map(|cell| i16::from(cell.is_some())).collect();
    let values: Vec<T::T> = cells.iter().flatten().cloned().collect();
    let mut column = group.next_column().unwrap().unwrap();
    let typed = column.typed::<T>();
    typed.write_batch(&values, Some(&levels), None).unwrap();
    column.close().unwrap();
}

/// Definition levels: 0 a null list, 1 an empty list, 2 a null element, 3 a number.
fn lists(rows: &[List], group: &mut SerializedRowGroupWriter<Vec<u8>>) {
    let (mut levels, mut again, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for row in rows {
        let elements = row.as_deref().unwrap_or_default();
        if elements.is_empty() {
            levels.push(i16::from(row.is_some()));
            again.push(0);
        }
        for (index, element) in elements.iter().enumerate() {
            levels.push(2 + i16::from(element.is_some()));
            again.push(i16::from(index > 0));
            values.extend(element);
        }
    }
    let mut column = group.next_column().unwrap().unwrap();
    let typed = column.typed::<FloatType>();
    typed
        .write_batch(&values, Some(&levels), Some(&again))
        .unwrap();
    column.close().unwrap();
}
