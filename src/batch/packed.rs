//! A recording as one piece, as it is sent about.

use super::hash::hash;

/// A recording that can be sent.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Packed {
    /// The archive.
    pub bytes: Vec<u8>,
    /// The entry to be read: the manifest, or the MCAP file with the joint.
    pub entry: String,
    /// SHA-256 of the archive, in hexadecimal.
    pub hash: String,
}

impl Packed {
    /// An archive, and what is to be read of it.
    pub fn new(bytes: Vec<u8>, entry: String) -> Self {
        Self {
            entry,
            hash: hash(&bytes),
            bytes,
        }
    }
}
