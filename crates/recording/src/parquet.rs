//! Parquet files as the text of a CSV file, so that all that is known of one holds for the other.
//!
//! A column of numbers is a column; a list in each row, as the states of a robot, is `name[0]`, `name[1]`; a field of a
//! group is `group.field`. A cell that is null is empty. Texts and bytes are left out.
//!
//! Source: Apache Parquet, file format and logical types.

use super::error::Problem;
use ::parquet::file::reader::{FileReader, SerializedFileReader};
use ::parquet::record::Field;
use bytes::Bytes;
use std::fmt::Write;

/// The first bytes of a Parquet file.
pub const MAGIC: &[u8] = b"PAR1";

/// The text.
///
/// # Errors
/// [`Problem::Parquet`] where the file is damaged, its lists differ in length, or it has no numbers.
pub fn csv(file: Vec<u8>) -> Result<String, Problem> {
    let refused = |error: &dyn std::fmt::Display| Problem::Parquet(error.to_string());
    let reader = SerializedFileReader::new(Bytes::from(file)).map_err(|error| refused(&error))?;
    let rows = reader.get_row_iter(None).map_err(|error| refused(&error))?;
    let mut text = String::new();
    let mut names: Vec<String> = Vec::new();
    for (number, row) in rows.enumerate() {
        let row = row.map_err(|error| refused(&error))?;
        let mut cells = Cells::default();
        for (name, field) in row.get_column_iter() {
            cells.add(name, field);
        }
        if number == 0 {
            names.clone_from(&cells.names);
            let quoted = names
                .iter()
                .map(|name| format!("\"{}\"", name.replace('"', "\"\"")));
            text = quoted.collect::<Vec<_>>().join(",") + "\n";
        } else if cells.names != names {
            let other = cells.names.iter().find(|name| !names.contains(name));
            let other = other.or(names.iter().find(|name| !cells.names.contains(name)));
            let other = other.map_or("a list", String::as_str);
            return Err(Problem::Parquet(format!(
                "row {number} and row 0 differ: {other} is not in both"
            )));
        }
        text += &cells.text;
        text.push('\n');
    }
    match names.is_empty() {
        true => Err(Problem::Parquet("it has no numbers".into())),
        false => Ok(text),
    }
}

/// The cells of a row.
#[derive(Default)]
struct Cells {
    names: Vec<String>,
    text: String,
}

impl Cells {
    fn add(&mut self, name: &str, field: &Field) {
        match field {
            Field::Group(row) => {
                for (own, field) in row.get_column_iter() {
                    self.add(&format!("{name}.{own}"), field);
                }
            }
            Field::ListInternal(list) => {
                for (index, field) in list.elements().iter().enumerate() {
                    self.add(&format!("{name}[{index}]"), field);
                }
            }
            Field::Null => self.cell(name, &""),
            Field::Bool(value) => self.cell(name, &u8::from(*value)),
            Field::Byte(value) => self.cell(name, value),
            Field::Short(value) => self.cell(name, value),
            Field::Int(value) => self.cell(name, value),
            Field::Long(value) => self.cell(name, value),
            Field::UByte(value) => self.cell(name, value),
            Field::UShort(value) => self.cell(name, value),
            Field::UInt(value) => self.cell(name, value),
            Field::ULong(value) => self.cell(name, value),
            Field::Float16(value) => self.cell(name, value),
            Field::Float(value) => self.cell(name, value),
            Field::Double(value) => self.cell(name, value),
            Field::TimestampMillis(value) | Field::TimestampMicros(value) => self.cell(name, value),
            // Texts, dates, decimals, maps: no sensor's values.
            _ => {}
        }
    }

    fn cell(&mut self, name: &str, value: &dyn std::fmt::Display) {
        if !self.names.is_empty() {
            self.text.push(',');
        }
        self.names.push(name.into());
        // Writing to a string does not fail.
        let _ = write!(self.text, "{value}");
    }
}
