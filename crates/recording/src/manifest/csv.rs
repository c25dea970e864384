//! Channels from the columns of CSV files.

use super::{Entry, Files, Numbers, Source, key};
use crate::{RecordingError, Role, Table};
use std::path::PathBuf;

impl Source<'_> {
    /// Stamps and columns of an entry with a CSV file.
    pub(super) fn cells(
        &self,
        entry: &Entry,
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
        if !files.tables.contains_key(&path) {
            tracing::info!(file = %path.display(), "reading");
            files.tables.insert(path.clone(), Table::open(&path)?);
        }
        let table = &files.tables[&path];
        let columns = table.numbers(&names)?;
        Ok((self.time(entry, table, columns[0].len())?, columns))
    }

    fn time(
        &self,
        entry: &Entry,
        table: &Table,
        samples: usize,
    ) -> Result<Vec<f64>, RecordingError> {
        match (&entry.time, &entry.rate_hz) {
            (Some(name), None) => table.stamps(name.get_ref()),
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
}
