//! Chunks: records packed together, compressed or not.

use super::record::{take, text};
use std::borrow::Cow;
use std::io::Read;

/// Largest unpacked size of a chunk, bytes: writers make chunks of a few MB.
const LARGEST: u64 = 1 << 30;

/// The packed records of a chunk, or of the available part of it.
#[derive(Debug)]
pub(super) struct Chunk<'a> {
    /// Their unpacked size, bytes.
    size: u64,
    /// CRC-32 of the unpacked bytes; 0 where it was not computed.
    crc: u32,
    compression: &'a str,
    data: &'a [u8],
    is_whole: bool,
}

impl<'a> Chunk<'a> {
    /// From the body of its record: first and last log time, size, CRC-32, compression, length, data.
    ///
    /// None where the body ends before the data does, unless `cut` says that the file does, too.
    pub(super) fn parse(body: &'a [u8], cut: bool) -> Option<Self> {
        let mut rest = body.get(16..)?;
        let size = u64::from_le_bytes(take(&mut rest)?);
        let crc = u32::from_le_bytes(take(&mut rest)?);
        let compression = text(&mut rest)?;
        let length = u64::from_le_bytes(take(&mut rest)?);
        let is_whole = length <= rest.len() as u64;
        let data = match is_whole {
            true => &rest[..length as usize],
            false if cut => rest,
            false => return None,
        };
        Some(Self {
            size,
            crc,
            compression,
            data,
            is_whole,
        })
    }

    /// The records, as far as they are available.
    ///
    /// # Errors
    /// A sentence, where a complete chunk does not unpack to its size and CRC.
    pub(super) fn unpack(&self) -> Result<Cow<'a, [u8]>, String> {
        if self.is_whole && self.size > LARGEST {
            return Err(format!("a chunk of {} bytes", self.size));
        }
        let unpacked = match self.compression {
            "" => Ok(Cow::Borrowed(self.data)),
            "zstd" => match zstd::Decoder::with_buffer(self.data) {
                Ok(decoder) => self.read(decoder),
                Err(error) => Err(error.to_string()),
            },
            "lz4" => self.read(lz4_flex::frame::FrameDecoder::new(self.data)),
            other => Err(format!("the compression \"{other}\" is not read")),
        }?;
        if !self.is_whole {
            return Ok(unpacked);
        }
        if unpacked.len() as u64 != self.size {
            let (size, found) = (self.size, unpacked.len());
            return Err(format!("a chunk of {size} bytes unpacks to {found}"));
        }
        match crc32fast::hash(&unpacked) {
            crc if crc == self.crc || self.crc == 0 => Ok(unpacked),
            crc => Err(format!("a chunk's CRC is {crc:08x}, not {:08x}", self.crc)),
        }
    }

    /// The output of a decoder, at most one byte more than the chunk's size. The decoder of a truncated chunk
    /// fails at the cut; its size may not have been written yet.
    fn read(&self, decoder: impl Read) -> Result<Cow<'a, [u8]>, String> {
        let mut unpacked = Vec::new();
        match decoder
            .take(self.size.min(LARGEST) + 1)
            .read_to_end(&mut unpacked)
        {
            Err(error) if self.is_whole => Err(format!("a chunk cannot be unpacked: {error}")),
            _ => Ok(Cow::Owned(unpacked)),
        }
    }
}
