//! Channels from the topics of MCAP files.

use super::{Entry, Files, Numbers, Source, key};
use crate::mcap::McapFile;
use crate::{RecordingError, Role};
use std::path::PathBuf;

impl Source<'_> {
    /// Stamps and columns of an entry with an MCAP file.
    pub(super) fn messages(
        &self,
        entry: &Entry,
        role: Role,
        path: PathBuf,
        files: &mut Files,
    ) -> Result<Numbers, RecordingError> {
        let start = entry.role.span().start;
        let Some(topic) = &entry.topic else {
            return Err(self.at(start, key("topic", "an MCAP file needs topic = \"...\"")));
        };
        let of_table = entry.column.is_some() || entry.columns.is_some();
        if of_table || entry.rate_hz.is_some() || entry.time_wrap.is_some() {
            let reason = "an MCAP file has field or fields, and stamps of its own: no column, no rate_hz and no time_wrap";
            return Err(self.at(start, key("topic", reason)));
        }
        let keys = ["field", "fields"];
        let names = self.names(entry, role, keys, (&entry.field, &entry.fields))?;
        if !files.mcap.contains_key(&path) {
            files.mcap.insert(path.clone(), McapFile::open(&path)?);
        }
        let time = entry.time.as_ref().map(|time| time.get_ref().as_str());
        files.mcap[&path].numbers(topic.get_ref(), &names, time)
    }
}
