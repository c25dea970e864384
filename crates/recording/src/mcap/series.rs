//! The numbers of a topic over time.

use super::definition::Layout;
use super::file::{McapFile, at_byte};
use super::record::Message;
use super::records::Broken;
use super::value::{self, Path, Value};
use crate::error::{Place, Problem, RecordingError};

/// Distance of stamps from their log times, ns, above which they are of another clock: longer than the delay of
/// a bus, shorter than the offset of unsynchronised clocks.
const DELAY: i64 = 1_000_000_000;

/// Stamps and columns of a topic in the order of the messages.
#[derive(Debug, Default)]
pub(super) struct Series {
    /// Stamps on the clock of the file, ns.
    pub stamps: Vec<i64>,
    pub columns: Vec<Vec<f64>>,
}

/// The source of a message's stamp.
#[derive(Debug)]
pub(super) enum Clock {
    /// Seconds and nanoseconds of a field.
    Field(Path, Path),
    Log,
    Publish,
}

impl Clock {
    /// `log_time`, `publish_time` or the name of a field; by default the header's stamp where there is one.
    fn parse(time: Option<&str>, layout: &Layout) -> Result<Self, String> {
        let field = |name: &str| -> Result<Self, String> {
            let path = |part| Path::parse(&format!("{name}.{part}"), layout);
            Ok(Self::Field(path("sec")?, path("nanosec")?))
        };
        match time {
            None => Ok(field("header.stamp").unwrap_or(Self::Log)),
            Some("log_time") => Ok(Self::Log),
            Some("publish_time") => Ok(Self::Publish),
            Some(name) => field(name),
        }
    }

    fn roots(&self) -> Vec<usize> {
        match self {
            Self::Field(seconds, rest) => seconds.roots().chain(rest.roots()).collect(),
            _ => Vec::new(),
        }
    }

    fn stamp(&self, message: &Message, value: &Value) -> Result<i64, String> {
        let time = match self {
            Self::Field(seconds, rest) => {
                let number = |path: &Path| Ok::<_, String>(path.pick(value)?.unwrap_or(0.0) as i64);
                let seconds = number(seconds)?.saturating_mul(1_000_000_000);
                return Ok(seconds.saturating_add(number(rest)?));
            }
            Self::Log => message.log_time,
            Self::Publish => message.publish_time,
        };
        i64::try_from(time).map_err(|_| format!("its time of {time} ns is after the year 2262"))
    }
}

impl McapFile {
    /// Stamps and numbers of fields of a topic; `None` if no message has them.
    pub(super) fn series(
        &self,
        topic: &str,
        fields: &[&str],
        time: Option<&str>,
    ) -> Result<Series, RecordingError> {
        let place = |field: Option<&str>| Place {
            file: self.path.clone(),
            topic: Some(topic.into()),
            field: field.map(str::to_owned),
            ..Place::default()
        };
        let refuse = |field, reason| RecordingError {
            place: place(field),
            problem: Problem::Mcap(reason),
        };
        let entry = self.topics.iter().find(|entry| entry.name == topic);
        let entry = entry.ok_or_else(|| {
            let names: Vec<_> = self.topics.iter().map(|topic| &*topic.name).collect();
            let reason = format!(
                "there is no such topic; the topics are: {}",
                names.join(", ")
            );
            refuse(None, reason)
        })?;
        let layout = entry.layout.as_ref();
        let layout = layout.map_err(|reason| refuse(None, reason.clone()))?;
        let paths = fields
            .iter()
            .map(|field| Path::parse(field, layout).map_err(|reason| refuse(Some(field), reason)));
        let paths: Vec<_> = paths.collect::<Result<_, _>>()?;
        let clock = Clock::parse(time, layout).map_err(|reason| refuse(time, reason))?;
        let found = series(self, topic, layout, &paths, &clock);
        found.map_err(|(broken, field)| {
            let field = field.map(|index| fields[index]);
            at_byte(&self.path, broken, Some((topic, field)))
        })
    }
}

/// Position of an unreadable message, and the index of the field if there is one.
type Unread = (Broken, Option<usize>);

/// Reads the fields in all messages of a topic; messages without an element of that name are left out.
fn series(
    file: &McapFile,
    topic: &str,
    layout: &Layout,
    fields: &[Path],
    clock: &Clock,
) -> Result<Series, Unread> {
    let mut wanted: Vec<_> = fields.iter().flat_map(Path::roots).collect();
    wanted.extend(clock.roots());
    let mut series = Series {
        stamps: Vec::new(),
        columns: vec![Vec::new(); fields.len()],
    };
    let (mut logs, mut at_field) = (Vec::new(), None);
    let walk = file.messages(topic, |message| {
        at_field = None;
        let value = value::message(layout, message.data, &wanted);
        let value = value.map_err(|d| format!("byte {} of a message: {}", d.offset, d.what))?;
        let Some(row) = row(fields, &value, &mut at_field)? else {
            return Ok(());
        };
        series.stamps.push(clock.stamp(message, &value)?);
        logs.push(i64::try_from(message.log_time).unwrap_or(i64::MAX));
        for (column, number) in series.columns.iter_mut().zip(row) {
            column.push(number);
        }
        Ok(())
    });
    walk.map_err(|broken| (broken, at_field))?;
    series.onto_the_files_clock(topic, &logs);
    Ok(series)
}

/// The numbers of a message; `None` if it does not have an element of that name. `at_field` is set to the field
/// of an error.
fn row(
    fields: &[Path],
    value: &Value,
    at_field: &mut Option<usize>,
) -> Result<Option<Vec<f64>>, String> {
    let mut row = Vec::with_capacity(fields.len());
    for (index, field) in fields.iter().enumerate() {
        *at_field = Some(index);
        match field.pick(value)? {
            Some(number) if number.is_finite() => row.push(number),
            Some(number) => return Err(format!("{number} is not a finite number")),
            None => {
                *at_field = None;
                return Ok(None);
            }
        }
    }
    *at_field = None;
    Ok(Some(row))
}

impl Series {
    /// Converts stamps of another clock to that of the file, by the message of least delay.
    fn onto_the_files_clock(&mut self, topic: &str, logs: &[i64]) {
        if self.stamps.iter().all(|stamp| *stamp == 0) {
            // These headers were not stamped.
            self.stamps = logs.into();
        }
        let delays = || {
            logs.iter()
                .zip(&self.stamps)
                .map(|(log, stamp)| log.saturating_sub(*stamp))
        };
        let span = match (logs.iter().min(), logs.iter().max()) {
            (Some(first), Some(last)) => last - first,
            _ => return,
        };
        let least = delays().min().unwrap_or(0);
        let is_near = delays().any(|delay| delay.saturating_abs() <= span.saturating_add(DELAY));
        if !is_near {
            tracing::warn!(
                "{topic}: its stamps are of another clock, {} s from that of the file; they are shifted",
                least as f64 / 1e9
            );
            for stamp in &mut self.stamps {
                *stamp = stamp.saturating_add(least);
            }
        }
    }

    /// Time in s from an instant on, strictly increasing, with the columns: sorted, and without messages of
    /// equal stamps.
    pub(super) fn since(self, topic: &str, zero: i64) -> (Vec<f64>, Vec<Vec<f64>>) {
        let seconds = |index: &usize| self.stamps[*index].saturating_sub(zero) as f64 / 1e9;
        let mut order: Vec<usize> = (0..self.stamps.len()).collect();
        order.sort_by_key(|index| self.stamps[*index]);
        order.dedup_by(|after, before| seconds(after) == seconds(before));
        let twice = self.stamps.len() - order.len();
        if twice > 0 {
            tracing::warn!(
                "{topic}: {twice} messages have the stamp of another one, and are left out"
            );
        }
        let time = order.iter().map(seconds).collect();
        let ordered = |column: &Vec<f64>| order.iter().map(|index| column[*index]).collect();
        (time, self.columns.iter().map(ordered).collect())
    }
}
