//! A shaped copy of a command file: all columns kept, the named ones shaped.

use super::Args;
use crate::cli::out::Out;
use crate::cli::{CliError, shaping, time_column::time_column};
use crate::recording::{Table, to_nanosecond, to_scale};
use flate2::{Compression, write::GzEncoder};
use quell_shapers::GridTrain;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The written file.
pub struct ShapedFile {
    /// The file.
    pub path: PathBuf,
    /// Its rows without the header.
    pub rows: usize,
    /// Number of rows after the command's own last row.
    pub appended: usize,
}

/// Reads the command, shapes it and writes the copy into the folder of `--out`.
pub fn shape(file: &Path, args: &Args, train: &GridTrain) -> Result<ShapedFile, CliError> {
    let name = shaped_name(file);
    let out = Out::open(&args.out, ("shape", args.force), &[file], [&name])?;
    let table = Table::open(file)?;
    let clock = clock(&table, args)?;
    let names: Vec<&str> = args.column.iter().map(String::as_str).collect();
    let indices = names
        .iter()
        .map(|name| table.index(name))
        .collect::<Result<Vec<_>, _>>()?;
    let columns = table.numbers(&names)?;
    table.possible(&names, &columns)?;
    let shaped = shaping::shaped(&columns, train).map_err(CliError::input)?;
    let (given, rows) = (columns[0].len(), shaped[0].len());
    let path = args.out.join(&name);
    let text = text(&table, &indices, &shaped, &clock)?;
    let stage = out.stage()?;
    stage.file(&name, compressed(&path, text)?)?;
    stage.put()?;
    Ok(ShapedFile {
        path,
        rows,
        appended: rows - given,
    })
}

/// The file's clock, checked against the rate.
fn clock(table: &Table, args: &Args) -> Result<Clock, CliError> {
    let rate = args.rate;
    let Some(name) = time_column(table, args.time.as_deref(), &args.column)? else {
        return Ok(Clock { time: None, rate });
    };
    let end = table.stamps_at_rate(name, rate)?.last().copied();
    Ok(Clock {
        time: Some((table.index(name)?, end.unwrap_or(0.0))),
        rate,
    })
}

/// The index of the time column and its last stamp, s, if there is one; the rate, Hz.
struct Clock {
    time: Option<(usize, f64)>,
    rate: f64,
}

/// The table with the shaped columns in place; rows past its end repeat its last row.
fn text(
    table: &Table,
    indices: &[usize],
    shaped: &[Vec<f64>],
    clock: &Clock,
) -> Result<Vec<u8>, CliError> {
    let mut out = csv::WriterBuilder::new()
        .delimiter(table.delimiter())
        .from_writer(Vec::new());
    out.write_record(table.header())
        .map_err(CliError::failure)?;
    let largest = |column: &Vec<f64>| column.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let scales: Vec<_> = shaped.iter().map(largest).collect();
    let mut cells: Vec<String> = Vec::new();
    let mut rows = table.rows();
    let mut past_end = 0;
    for sample in 0..shaped[0].len() {
        match rows.next() {
            Some(row) => cells = row?.iter().map(str::to_owned).collect(),
            None => past_end += 1,
        }
        for ((&index, column), &scale) in indices.iter().zip(shaped).zip(&scales) {
            cells[index] = format!("{:?}", to_scale(column[sample], scale));
        }
        if let Some((index, end)) = clock.time.filter(|_| past_end > 0) {
            let time = end + f64::from(past_end) / clock.rate;
            cells[index] = format!("{:?}", to_nanosecond(time));
        }
        out.write_record(&cells).map_err(CliError::failure)?;
    }
    out.into_inner().map_err(CliError::failure)
}

/// `command.csv.gz` as `command_shaped.csv.gz`.
fn shaped_name(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match name.find(".csv") {
        Some(end) => format!("{}_shaped{}", &name[..end], &name[end..]),
        None => format!("{name}_shaped.csv"),
    }
}

fn compressed(path: &Path, text: Vec<u8>) -> Result<Vec<u8>, CliError> {
    if path.extension().is_none_or(|extension| extension != "gz") {
        return Ok(text);
    }
    let mut out = GzEncoder::new(Vec::new(), Compression::default());
    out.write_all(&text)?;
    Ok(out.finish()?)
}
