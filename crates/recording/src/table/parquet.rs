//! Parquet files, read into the text of a CSV file: what works for one works for the other.
//!
//! A list in each row, such as the state of a robot, becomes the columns `name[0]`, `name[1]`; a field of a group is `group.field`.
//! A null cell is a missing sample. For a manifest only the columns that it names are read.
//!
//! Source: Apache Parquet, file format, logical types, nested encoding.

#[cfg(feature = "parquet")]
mod caught;
#[cfg(feature = "parquet")]
mod cells;
#[cfg(feature = "parquet")]
mod file;
#[cfg(feature = "parquet")]
mod leaf;

#[cfg(feature = "parquet")]
pub use file::table;

use crate::foreign::PARQUET;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Text of a null cell.
pub const NULL: &str = "null";

/// Whether the file is Parquet by its extension or first bytes, and this build reads Parquet.
pub fn is_one(path: &Path) -> bool {
    let begins = || {
        let mut first = [0; 4];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut first));
        read.is_ok() && PARQUET.begins(&first)
    };
    cfg!(feature = "parquet") && (is_called(path) || begins())
}

/// Whether the extension is that of a Parquet file, and this build reads Parquet.
pub fn is_called(path: &Path) -> bool {
    cfg!(feature = "parquet") && PARQUET.is_called(path)
}

/// Stand-in of a build without the feature; it is never called, because `is_one` is false.
///
/// # Errors
/// Always, with the remedy.
#[cfg(not(feature = "parquet"))]
pub fn table(
    path: &Path,
    _: &crate::Layout,
    _: Option<&[&str]>,
) -> Result<crate::Table, crate::RecordingError> {
    Err(crate::Problem::Foreign(PARQUET).in_file(path))
}
