//! The three records that a recording is made of: schemas, channels, messages.
//!
//! They are read here and not by the library that writes them (mcap 0.26). Its `parse_record` reserves up to 4
//! GiB for a wrong length of a text, and its `ChunkReader` has no limit. Its `LinearReader` does not give the
//! position of a record in the file and, to check a chunk before it is read, reserves the size that the chunk
//! claims.
//!
//! Source: MCAP format specification, version 0, "Records".

use ::mcap::records::op;

/// A record, as it stands in the file.
#[derive(Debug)]
pub(super) enum Record<'a> {
    Schema {
        id: u16,
        name: &'a str,
        encoding: &'a str,
        data: &'a [u8],
    },
    Channel {
        id: u16,
        schema: u16,
        topic: &'a str,
        encoding: &'a str,
    },
    Message(Message<'a>),
}

/// A message; times in ns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Message<'a> {
    pub channel: u16,
    pub sequence: u32,
    pub log_time: u64,
    pub publish_time: u64,
    pub data: &'a [u8],
}

impl<'a> Record<'a> {
    /// From opcode and body; `None` where the body ends too early or text is not UTF-8. Other records do not
    /// matter for a recording.
    pub(super) fn parse(code: u8, mut body: &'a [u8]) -> Option<Self> {
        let rest = &mut body;
        Some(match code {
            op::SCHEMA => Self::Schema {
                id: u16::from_le_bytes(take(rest)?),
                name: text(rest)?,
                encoding: text(rest)?,
                data: bytes(rest)?,
            },
            op::CHANNEL => Self::Channel {
                id: u16::from_le_bytes(take(rest)?),
                schema: u16::from_le_bytes(take(rest)?),
                topic: text(rest)?,
                encoding: text(rest)?,
            },
            op::MESSAGE => {
                let channel = u16::from_le_bytes(take(rest)?);
                Self::Message(Message {
                    channel,
                    sequence: u32::from_le_bytes(take(rest)?),
                    log_time: u64::from_le_bytes(take(rest)?),
                    publish_time: u64::from_le_bytes(take(rest)?),
                    data: rest,
                })
            }
            _ => return None,
        })
    }
}

/// The next `N` bytes.
pub(super) fn take<const N: usize>(rest: &mut &[u8]) -> Option<[u8; N]> {
    let (first, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(*first)
}

/// Bytes behind their length.
fn bytes<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = u32::from_le_bytes(take(rest)?) as usize;
    let (bytes, after) = rest.split_at_checked(length)?;
    *rest = after;
    Some(bytes)
}

/// Text behind its length.
pub(super) fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    core::str::from_utf8(bytes(rest)?).ok()
}
