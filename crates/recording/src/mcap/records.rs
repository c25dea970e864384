//! The records of an MCAP file in sequence, up to its end or cut.
//!
//! The index at the end of a file is not used: a recorder that was killed has not written one.

use super::chunk::Chunk;
use super::record::Record;
use ::mcap::MAGIC;
use ::mcap::records::op;

/// Opcode and length before the body.
const FRAME: usize = 9;

/// A file that ends before it is complete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Start of the incomplete record, bytes.
    pub at: usize,
    /// Length of the file, bytes.
    pub length: usize,
}

/// Position and reason of invalid bytes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Broken {
    pub byte: usize,
    pub reason: String,
}

/// One step along a file.
enum Step<'a> {
    /// Opcode, body, and start of the record.
    Record(u8, &'a [u8], usize),
    /// A record that is longer than the rest of the file.
    Cut(u8, &'a [u8], usize),
}

/// Steps over the records of a file or of a chunk.
struct Steps<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Iterator for Steps<'a> {
    type Item = Step<'a>;

    fn next(&mut self) -> Option<Step<'a>> {
        let (begin, rest) = (self.at, self.bytes.get(self.at..)?);
        if rest.is_empty() {
            return None;
        }
        self.at = self.bytes.len();
        let Some((&[code, ref length @ ..], body)) = rest.split_first_chunk::<FRAME>() else {
            return Some(Step::Cut(0, &[], begin));
        };
        let length = u64::from_le_bytes(*length);
        if length > body.len() as u64 {
            return Some(Step::Cut(code, body, begin));
        }
        let length = length as usize;
        self.at = begin + FRAME + length;
        Some(Step::Record(code, &body[..length], begin))
    }
}

/// Calls `visit` with every schema, channel and message. Returns the position of a cut, if there is one.
///
/// # Errors [`Broken`] where the bytes are damaged, and the errors of `visit`, with the byte of the record; in
/// a chunk, that of the chunk.
pub(super) fn visit(
    file: &[u8],
    mut visit: impl FnMut(Record) -> Result<(), String>,
) -> Result<Option<Cut>, Broken> {
    let cut = |at| Cut {
        at,
        length: file.len(),
    };
    if !file.starts_with(MAGIC) {
        return match MAGIC.starts_with(file) {
            true => Ok(Some(cut(0))),
            false => Err(broken(0, "the file does not begin as an MCAP file")),
        };
    }
    // A file with a proper end is complete, so that a record that does not fit is damaged.
    let may_be_cut = file.len() < 2 * MAGIC.len() || !file.ends_with(MAGIC);
    let mut steps = Steps {
        bytes: file,
        at: MAGIC.len(),
    };
    for step in &mut steps {
        match step {
            Step::Record(op::FOOTER | op::DATA_END, ..) => return Ok(None),
            Step::Record(op::CHUNK, body, at) => chunk(body, at, false, &mut visit)?,
            Step::Record(code, body, at) => record(code, body, at, &mut visit)?,
            Step::Cut(code, body, at) if may_be_cut => {
                if code == op::CHUNK {
                    chunk(body, at, true, &mut visit)?;
                }
                return Ok(Some(cut(at)));
            }
            Step::Cut(_, _, at) => return Err(broken(at, "a record is longer than the file")),
        }
    }
    Ok(Some(cut(file.len())))
}

fn chunk(
    body: &[u8],
    at: usize,
    is_cut: bool,
    visit: &mut impl FnMut(Record) -> Result<(), String>,
) -> Result<(), Broken> {
    let Some(chunk) = Chunk::parse(body, is_cut) else {
        return match is_cut {
            true => Ok(()),
            false => Err(broken(at, "a chunk is longer than its record")),
        };
    };
    let bytes = chunk.unpack().map_err(|reason| broken(at, reason))?;
    let steps = Steps {
        bytes: &bytes,
        at: 0,
    };
    for step in steps {
        match step {
            Step::Record(code, body, _) => record(code, body, at, visit)?,
            Step::Cut(..) if is_cut => break,
            Step::Cut(..) => return Err(broken(at, "a record is longer than its chunk")),
        }
    }
    Ok(())
}

fn record(
    code: u8,
    body: &[u8],
    at: usize,
    visit: &mut impl FnMut(Record) -> Result<(), String>,
) -> Result<(), Broken> {
    match code {
        0 => Err(broken(at, "there is no record")),
        op::SCHEMA | op::CHANNEL | op::MESSAGE => {
            let record = Record::parse(code, body);
            let record =
                record.ok_or_else(|| broken(at, "a record does not hold what it should"))?;
            visit(record).map_err(|reason| broken(at, reason))
        }
        _ => Ok(()),
    }
}

fn broken(byte: usize, reason: impl Into<String>) -> Broken {
    let reason = reason.into();
    Broken { byte, reason }
}
