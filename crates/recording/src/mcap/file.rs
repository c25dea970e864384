//! An MCAP file and its topics.

use super::definition::Layout;
use super::record::{Message, Record};
use super::records::{Broken, Cut, visit};
use crate::error::{Place, Problem, RecordingError};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// An MCAP file in memory, with its content.
#[derive(Debug)]
pub struct McapFile {
    pub(super) path: PathBuf,
    bytes: Vec<u8>,
    pub(super) topics: Vec<Topic>,
    cut: Option<Cut>,
}

/// One topic of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Topic {
    /// Its name.
    pub name: String,
    /// Type of its messages, such as `sensor_msgs/msg/JointState`; empty where the file does not have it.
    pub kind: String,
    /// Messages in the file.
    pub messages: usize,
    /// First and last log time, ns.
    pub logged: Option<[u64; 2]>,
    /// Names of the elements in the first message, as in joint states.
    pub names: Vec<String>,
    /// The layout of its messages, or why they cannot be read; topics may share one.
    pub(super) layout: Result<Arc<Layout>, String>,
}

impl McapFile {
    /// Whether a path names an MCAP file, by its extension.
    pub fn is_named(path: &Path) -> bool {
        path.extension()
            .is_some_and(|extension| extension == "mcap")
    }

    /// Reads a file; a truncated one up to the cut.
    ///
    /// # Errors
    /// [`RecordingError`] with the byte where the file is damaged.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        tracing::info!(file = %path.display(), "reading");
        let bytes = std::fs::read(path).map_err(|error| RecordingError::io(path, &error))?;
        Self::of(path, bytes)
    }

    /// As [`Self::open`], from the bytes of a file; `path` is for errors.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub fn of(path: &Path, bytes: Vec<u8>) -> Result<Self, RecordingError> {
        if bytes.is_empty() {
            return Err(Problem::Empty.in_file(path));
        }
        let mut index = Index::default();
        let cut = visit(&bytes, |record| index.take(record));
        let cut = cut.map_err(|broken| at_byte(path, broken, None))?;
        let file = Self {
            path: path.into(),
            bytes,
            topics: index.topics,
            cut,
        };
        file.remarks()
            .iter()
            .for_each(|remark| tracing::warn!("{remark}"));
        Ok(file)
    }

    /// The topics in the order in which the file announces them.
    pub fn topics(&self) -> &[Topic] {
        &self.topics
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The position of the cut, if it is truncated.
    pub fn cut(&self) -> Option<Cut> {
        self.cut
    }

    /// Remarks on the file as a whole: that it is truncated, and where.
    pub fn remarks(&self) -> Vec<String> {
        let words = |cut: Cut| {
            let (file, Cut { at, length }) = (self.path.display(), cut);
            format!("{file} is cut: what follows byte {at} of {length} is no whole record")
        };
        self.cut.map(words).into_iter().collect()
    }

    /// Calls `take` with every message of a topic.
    pub(super) fn messages(
        &self,
        topic: &str,
        mut take: impl FnMut(&Message) -> Result<(), String>,
    ) -> Result<(), Broken> {
        let mut ids = Vec::new();
        let walk = visit(&self.bytes, |record| match record {
            Record::Channel {
                id, topic: name, ..
            } if name == topic => {
                ids.push(id);
                Ok(())
            }
            Record::Message(message) if ids.contains(&message.channel) => take(&message),
            _ => Ok(()),
        });
        walk.map(|_| ())
    }
}

impl Topic {
    /// Fields of its messages with numbers, `[]` for sequences; empty where they cannot be read.
    pub fn fields(&self) -> Vec<String> {
        self.layout
            .as_ref()
            .map_or_else(|_| Vec::new(), |layout| layout.numbers())
    }

    /// Messages per second of log time.
    pub fn rate_hz(&self) -> Option<f64> {
        let [first, last] = self.logged?;
        let span = last.saturating_sub(first) as f64 / 1e9;
        (span > 0.0).then(|| (self.messages.saturating_sub(1)) as f64 / span)
    }
}

/// Results of the first pass over a file.
#[derive(Default)]
struct Index {
    schemas: HashMap<u16, (String, Result<Arc<Layout>, String>)>,
    topics: Vec<Topic>,
    /// Index of the topic of a channel.
    channels: HashMap<u16, usize>,
}

impl Index {
    fn take(&mut self, record: Record) -> Result<(), String> {
        match record {
            Record::Schema {
                id,
                name,
                encoding,
                data,
            } => {
                let layout = match encoding {
                    "ros2msg" => Layout::parse(name, &String::from_utf8_lossy(data)).map(Arc::new),
                    other => Err(format!(
                        "definitions in \"{other}\" are not read, ros2msg is"
                    )),
                };
                self.schemas.insert(id, (name.into(), layout));
            }
            Record::Channel {
                id,
                schema,
                topic,
                encoding,
            } => {
                let known = self.topics.iter().position(|known| known.name == topic);
                let index = known.unwrap_or_else(|| {
                    self.topics.push(self.topic(topic, schema, encoding));
                    self.topics.len() - 1
                });
                self.channels.insert(id, index);
            }
            Record::Message(message) => {
                let index = self.channels.get(&message.channel);
                let index = index.ok_or("a message of a channel that is not announced")?;
                self.topics[*index].count(&message);
            }
        }
        Ok(())
    }

    fn topic(&self, name: &str, schema: u16, encoding: &str) -> Topic {
        let unknown = || Err("its type is not defined in the file".into());
        let schema = self.schemas.get(&schema).cloned();
        let (kind, layout) = schema.unwrap_or_else(|| (String::new(), unknown()));
        let layout = match encoding {
            "cdr" => layout,
            other => Err(format!("messages in \"{other}\" are not read, CDR is")),
        };
        Topic {
            name: name.into(),
            kind,
            messages: 0,
            logged: None,
            names: Vec::new(),
            layout,
        }
    }
}

impl Topic {
    fn count(&mut self, message: &Message) {
        if let Ok(layout) = &self.layout
            && self.messages == 0
        {
            self.names = super::value::names(layout, message.data);
        }
        let time = message.log_time;
        let [first, last] = self.logged.unwrap_or([time, time]);
        self.logged = Some([first.min(time), last.max(time)]);
        self.messages += 1;
    }
}

/// An error at a byte of a file, with the field of a topic if there is one.
pub(super) fn at_byte(
    path: &Path,
    broken: Broken,
    of: Option<(&str, Option<&str>)>,
) -> RecordingError {
    RecordingError {
        place: Place {
            file: path.into(),
            byte: Some(broken.byte),
            topic: of.map(|(topic, _)| topic.into()),
            field: of.and_then(|(_, field)| field).map(str::to_owned),
            ..Place::default()
        },
        problem: Problem::Mcap(broken.reason),
    }
}
