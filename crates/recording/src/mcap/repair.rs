//! Repair of an unfinished file, so that other tools open it.
//!
//! Readers need the summary and the footer at the end of a file. A writer that was killed has written neither,
//! and its last chunk may be truncated.

use super::file::McapFile;
use super::record::Record;
use super::records::visit;
use super::writer::{options, refused};
use crate::error::RecordingError;
use ::mcap::records::MessageHeader;
use ::mcap::write::NoSeek;
use ::mcap::{McapError, Writer};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// A complete file with the messages that were found in a damaged one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mended {
    /// The file, with index, summary and footer.
    pub bytes: Vec<u8>,
    /// Messages in it.
    pub messages: u64,
    /// The end of the messages if it was not the end of the file: a damaged record. The data behind it are not
    /// in `bytes`.
    pub damage: Option<String>,
}

impl McapFile {
    /// Copies the intact part of a file: schemas, channels and messages with their numbers and times.
    ///
    /// # Errors
    /// [`RecordingError`] where the file cannot be read. A file without messages gives an empty one.
    pub fn mended(path: &Path) -> Result<Mended, RecordingError> {
        let bytes = std::fs::read(path).map_err(|error| RecordingError::io(path, &error))?;
        let mut copy = Copy::new().map_err(|error| refused(path, error))?;
        let damage = visit(&bytes, |record| copy.take(record)).err();
        let messages = copy.messages;
        Ok(Mended {
            bytes: copy.finish().map_err(|error| refused(path, error))?,
            messages,
            damage: damage.map(|broken| format!("byte {}: {}", broken.byte, broken.reason)),
        })
    }
}

/// A file that is written from the records of another one.
struct Copy {
    out: Writer<NoSeek<Vec<u8>>>,
    schemas: HashMap<u16, u16>,
    channels: HashMap<u16, u16>,
    messages: u64,
}

impl Copy {
    fn new() -> Result<Self, McapError> {
        Ok(Self {
            out: options().create(NoSeek::new(Vec::new()))?,
            schemas: HashMap::new(),
            channels: HashMap::new(),
            messages: 0,
        })
    }

    fn take(&mut self, record: Record) -> Result<(), String> {
        match record {
            Record::Schema {
                id,
                name,
                encoding,
                data,
            } => {
                let new = self.out.add_schema(name, encoding, data);
                self.schemas.insert(id, new.map_err(words)?);
            }
            Record::Channel {
                id,
                schema,
                topic,
                encoding,
            } => {
                // No schema has the number 0, which means none.
                let schema = match schema {
                    0 => Some(&0),
                    schema => self.schemas.get(&schema),
                };
                let schema = *schema.ok_or("a channel of a type that is not announced")?;
                let new = self
                    .out
                    .add_channel(schema, topic, encoding, &BTreeMap::new());
                self.channels.insert(id, new.map_err(words)?);
            }
            Record::Message(message) => {
                let channel = self.channels.get(&message.channel);
                let header = MessageHeader {
                    channel_id: *channel.ok_or("a message of a channel that is not announced")?,
                    sequence: message.sequence,
                    log_time: message.log_time,
                    publish_time: message.publish_time,
                };
                let written = self.out.write_to_known_channel(&header, message.data);
                written.map_err(words)?;
                self.messages += 1;
            }
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<u8>, McapError> {
        self.out.finish()?;
        Ok(self.out.into_inner().into_inner())
    }
}

fn words(error: McapError) -> String {
    error.to_string()
}
