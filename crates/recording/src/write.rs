//! Writing a recording as a folder: a manifest and one CSV file a channel.

use super::error::{Problem, RecordingError};
use super::sink::Sink;
use super::{Channel, MANIFEST, Recording};
use flate2::{Compression, write::GzEncoder};
use serde::Serialize;
use std::collections::HashMap;
use std::io::{self, BufWriter, Write};
use std::path::Path;

#[derive(Serialize)]
struct Manifest<'a> {
    name: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    payload: Option<&'a str>,
    channel: Vec<Entry<'a>>,
}

#[derive(Serialize)]
struct Entry<'a> {
    role: &'a str,
    file: String,
    time: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    column: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    columns: Option<Vec<String>>,
    unit: &'a str,
}

/// The source of files to write into.
type Create<'a> = dyn FnMut(&Path) -> io::Result<Sink> + 'a;

/// Refuses a recording that could not be read back unchanged.
pub(super) fn checked(recording: &Recording, folder: &Path) -> Result<(), RecordingError> {
    recording.channels.iter().try_for_each(|channel| {
        channel.check().map_err(|reason| {
            Problem::Channel {
                role: channel.role.name(),
                reason,
            }
            .in_file(folder)
        })
    })
}

/// Writes `recording.toml` and the channels' files into an existing folder.
pub(super) fn write(
    recording: &Recording,
    folder: &Path,
    compress: bool,
    create: &mut Create,
) -> Result<(), RecordingError> {
    let mut seen = HashMap::new();
    let mut manifest = Manifest {
        name: &recording.name,
        payload: recording.payload.as_deref(),
        channel: Vec::new(),
    };
    for channel in &recording.channels {
        let count = seen
            .entry(channel.role)
            .and_modify(|count| *count += 1)
            .or_insert(1);
        let entry = entry(channel, *count, compress);
        let path = folder.join(&entry.file);
        let written = create(&path).and_then(|file| csv(channel, &entry, file, compress));
        written.map_err(|error| RecordingError::io(&path, &error))?;
        manifest.channel.push(entry);
    }
    tracing::info!(folder = %folder.display(), channels = manifest.channel.len(), "written");
    let path = folder.join(MANIFEST);
    let text = toml::to_string(&manifest)
        .map_err(|error| Problem::Toml(error.to_string()).in_file(&path))?;
    let written = create(&path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.flush()
    });
    written.map_err(|error| RecordingError::io(&path, &error))
}

/// The manifest's lines for the `count`-th channel of its role.
fn entry(channel: &Channel, count: usize, compress: bool) -> Entry<'_> {
    let role = channel.role.name();
    let suffix = if count == 1 {
        String::new()
    } else {
        format!("_{count}")
    };
    let extension = if compress { "csv.gz" } else { "csv" };
    let unit = channel.unit.as_str();
    let scalar = channel.columns.len() == 1;
    Entry {
        role,
        file: format!("{role}{suffix}.{extension}"),
        time: "time_s",
        column: scalar.then(|| format!("{role}_{unit}")),
        columns: (!scalar).then(|| ["x", "y", "z"].map(|axis| format!("{axis}_{unit}")).into()),
        unit,
    }
}

fn csv(channel: &Channel, entry: &Entry, mut file: Sink, compress: bool) -> io::Result<()> {
    if compress {
        let mut out = GzEncoder::new(&mut file, Compression::default());
        rows(channel, entry, &mut out)?;
        out.finish()?;
        return file.flush();
    }
    let mut out = BufWriter::new(file);
    rows(channel, entry, &mut out)?;
    out.flush()
}

/// Numbers have as many digits as are needed to read back the same value.
fn rows(channel: &Channel, entry: &Entry, out: &mut impl Write) -> io::Result<()> {
    let names = entry.column.iter().chain(entry.columns.iter().flatten());
    let mut out = csv::Writer::from_writer(out);
    out.write_record([entry.time].into_iter().chain(names.map(String::as_str)))?;
    for (sample, time) in channel.time.iter().enumerate() {
        let values = channel.columns.iter().map(|column| column[sample]);
        out.write_record(
            [*time]
                .into_iter()
                .chain(values)
                .map(|value| format!("{value:?}")),
        )?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ROLES;
    use proptest::prelude::*;

    fn channel() -> impl Strategy<Value = Channel> {
        let units = || {
            super::super::UNITS
                .iter()
                .filter(|unit| unit.names[0] == unit.si)
        };
        let unit = proptest::sample::select(units().map(|unit| unit.si).collect::<Vec<_>>());
        let finite = || proptest::num::f64::NORMAL | proptest::num::f64::SUBNORMAL;
        (proptest::sample::select(ROLES), unit, 1..20_usize).prop_flat_map(
            move |(entry, unit, samples)| {
                let column = proptest::collection::vec(finite(), samples);
                let columns = proptest::collection::vec(column, entry.columns[0]);
                let time = proptest::collection::btree_set(-1_000_000..1_000_000_i32, samples);
                (columns, time).prop_map(move |(columns, time)| Channel {
                    role: entry.role,
                    unit: unit.into(),
                    time: time
                        .into_iter()
                        .map(|tick| f64::from(tick) / 333.0)
                        .collect(),
                    columns,
                })
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn what_is_written_is_read_back_to_the_bit(
            name in "\\PC{0,12}",
            payload in proptest::option::of("\\PC{0,12}"),
            mut channels in proptest::collection::vec(channel(), 1..4),
            compress: bool,
        ) {
            // A recording has one channel of each role.
            let mut seen = std::collections::HashSet::new();
            channels.retain(|own| seen.insert(own.role));
            let recording = Recording { name, payload, channels };
            let folder = tempfile::TempDir::new()?;
            recording.write(folder.path(), compress)?;
            prop_assert_eq!(Recording::from_path(folder.path())?, recording);
        }
    }
}
