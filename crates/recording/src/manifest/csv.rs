//! Channels from the columns of CSV and Parquet files.

use super::{Entry, Files, Numbers, Source, key, start};
use crate::layout::Layout;
use crate::stamp::{Origin, TIME_UNITS, TimeUnit};
use crate::table::parquet;
use crate::{RecordingError, Role, Table};
use std::ops::Range;
use std::path::PathBuf;

impl Source<'_> {
    /// Stamps and columns of an entry with a CSV or Parquet file.
    pub(super) fn cells(
        &self,
        (entry, layout, rows): (&Entry, Option<&Layout>, Range<usize>),
        role: Role,
        path: PathBuf,
        files: &mut Files,
    ) -> Result<Numbers, RecordingError> {
        if let Some(topic) = &entry.topic {
            let problem = key("topic", "only MCAP files (.mcap) have topics");
            return Err(self.at(topic.span().start, problem));
        }
        let keys = ["column", "columns"];
        let names = self.names(entry, role, keys, (&entry.column, &entry.columns))?;
        let layout = layout.cloned().unwrap_or_default();
        if parquet::is_one(&path) {
            // Columns are read one by one, so only those of the entry.
            let time = entry.time.iter().map(|time| time.get_ref());
            let tests = layout.only.iter().flat_map(|only| only.keys());
            let others = time.chain(tests).map(String::as_str);
            let wanted: Vec<&str> = names.iter().copied().chain(others).collect();
            tracing::info!(file = %path.display(), "reading");
            let table = parquet::table(&path, &layout, Some(&wanted))?;
            return self.numbers((entry, rows), &names, &table, &mut files.origin);
        }
        if files.tables.get(&path).is_none_or(|held| held.0 != layout) {
            tracing::info!(file = %path.display(), "reading");
            let table = Table::open_as(&path, &layout)?;
            files.tables.insert(path.clone(), (layout, table));
        }
        let table = &files.tables[&path].1;
        self.numbers((entry, rows), &names, table, &mut files.origin)
    }

    /// Stamps and columns from the table of an entry's file.
    fn numbers(
        &self,
        (entry, rows): (&Entry, Range<usize>),
        names: &[&str],
        table: &Table,
        origin: &mut Origin,
    ) -> Result<Numbers, RecordingError> {
        let columns = table.numbers(names)?;
        let time = self.time((entry, rows), table, columns[0].len(), origin)?;
        Ok((time, columns))
    }

    fn time(
        &self,
        (entry, rows): (&Entry, Range<usize>),
        table: &Table,
        samples: usize,
        origin: &mut Origin,
    ) -> Result<Vec<f64>, RecordingError> {
        let wrap = self.positive("time_wrap", &entry.time_wrap)?;
        match (&entry.time, &entry.rate_hz) {
            (Some(name), None) => {
                let unit = self.time_unit(entry)?;
                let wrap =
                    wrap.map(|period| period * unit.unwrap_or(TimeUnit::Seconds).in_seconds());
                table.stamps_of(name.get_ref(), unit.map(|unit| (unit, origin)), wrap, rows)
            }
            (None, Some(_)) if wrap.is_some() => {
                let problem = key(
                    "time_wrap",
                    "it is of stamps, and rate_hz stands in their place",
                );
                Err(self.at(start(&entry.time_wrap), problem))
            }
            (None, Some(rate)) => {
                let rate_hz = *rate.get_ref();
                if !(rate_hz.is_finite() && rate_hz > 0.0) {
                    let problem = key("rate_hz", format!("{rate_hz} is not a rate above 0"));
                    return Err(self.at(rate.span().start, problem));
                }
                Ok((0..samples).map(|sample| sample as f64 / rate_hz).collect())
            }
            _ => {
                let problem = key(
                    "time",
                    "give either time = \"<column>\" or rate_hz = <number>",
                );
                Err(self.at(entry.role.span().start, problem))
            }
        }
    }

    /// The unit of an entry's stamps, if it tells one.
    fn time_unit(&self, entry: &Entry) -> Result<Option<TimeUnit>, RecordingError> {
        let Some(unit) = &entry.time_unit else {
            return Ok(None);
        };
        let known = TimeUnit::from_name(unit.get_ref()).ok_or_else(|| {
            let names: Vec<_> = TIME_UNITS.iter().map(|line| line.1).collect();
            let reason = format!("\"{}\" is none of {}", unit.get_ref(), names.join(", "));
            self.at(unit.span().start, key("time_unit", reason))
        })?;
        if known.is_text() && entry.time_wrap.is_some() {
            let reason = format!("stamps in {:?} are no numbers of a counter", known.name());
            return Err(self.at(start(&entry.time_wrap), key("time_wrap", reason)));
        }
        Ok(Some(known))
    }
}
