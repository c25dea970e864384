//! The hash that names a piece of content.

use sha2::{Digest, Sha256};

/// SHA-256 of bytes, in hexadecimal.
pub fn hash(bytes: &[u8]) -> String {
    format!("{:x}", Sha256::digest(bytes))
}
