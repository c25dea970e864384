//! Signed datagrams: HMAC-SHA256 with a shared key; each sequence number is accepted only once.

use hmac::{Hmac, Mac};
use sha2::Sha256;

/// The text before and after the signature, at the end of a datagram.
const BEFORE: &[u8] = b",\"sig\":\"";
const AFTER: &[u8] = b"\"}";
/// Bytes of a signature, and its characters in a datagram.
const BYTES: usize = 32;
const DIGITS: usize = 2 * BYTES;
/// Length of the whole trailer. A signature adds one byte less, since it replaces the closing brace.
const TRAILER: usize = BEFORE.len() + DIGITS + AFTER.len();
/// Sequence numbers at most this far behind the newest are accepted, once: datagrams may overtake each other.
const WINDOW: u64 = 64;

/// The key of a link.
///
/// A datagram is signed over all bytes before `,"sig":"`, and ends with the signature as 64 hexadecimal digits
/// and `"}`. So it stays one JSON object, and the sender needs no canonical form of JSON.
///
/// Source: HMAC, RFC 2104, with SHA-256, FIPS 180-4.
#[derive(Clone)]
pub struct Key(Hmac<Sha256>);

impl std::fmt::Debug for Key {
    /// Does not show the key.
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("Key")
    }
}

impl Key {
    /// A key of any length; below 32 bytes it is weaker than the signature.
    pub fn new(secret: &str) -> Option<Self> {
        Hmac::new_from_slice(secret.as_bytes()).ok().map(Self)
    }

    /// Signs the object in the first `length` bytes of a buffer, which must end with `}`; returns the new
    /// length. No allocation. `None` where the buffer is too short.
    pub fn sign(&self, buffer: &mut [u8], length: usize) -> Option<usize> {
        let signed = length.checked_sub(1)?;
        let (message, rest) = buffer.split_at_mut_checked(signed)?;
        let trailer = rest.get_mut(..TRAILER)?;
        let mac = self.0.clone().chain_update(message).finalize().into_bytes();
        let (before, rest) = trailer.split_at_mut(BEFORE.len());
        let (digits, after) = rest.split_at_mut(DIGITS);
        before.copy_from_slice(BEFORE);
        after.copy_from_slice(AFTER);
        for (pair, byte) in digits.chunks_exact_mut(2).zip(mac) {
            (pair[0], pair[1]) = (digit(byte >> 4), digit(byte & 15));
        }
        Some(signed + TRAILER)
    }

    /// Whether a datagram is signed with this key. The comparison takes constant time.
    pub fn has_signed(&self, datagram: &[u8]) -> bool {
        let Some((message, trailer)) = datagram.split_last_chunk::<TRAILER>() else {
            return false;
        };
        let digits = trailer.strip_prefix(BEFORE);
        let Some(digits) = digits.and_then(|rest| rest.strip_suffix(AFTER)) else {
            return false;
        };
        let mut given = [0; BYTES];
        for (byte, pair) in given.iter_mut().zip(digits.chunks_exact(2)) {
            let (Some(high), Some(low)) = (value(pair[0]), value(pair[1])) else {
                return false;
            };
            *byte = high << 4 | low;
        }
        let mac = self.0.clone().chain_update(message);
        mac.verify_slice(&given).is_ok()
    }
}

fn digit(value: u8) -> u8 {
    match value {
        0..=9 => b'0' + value,
        _ => b'a' + value - 10,
    }
}

fn value(digit: u8) -> Option<u8> {
    char::from(digit).to_digit(16).map(|value| value as u8)
}

/// Replay protection: each sequence number is accepted once, and those far behind the newest never.
///
/// Source: S. Kent, RFC 4303 (2005), section 3.4.3.
#[derive(Clone, Copy, Debug, Default)]
pub struct Replay {
    newest: Option<u64>,
    /// Bit `k` says that `newest - k` has come.
    seen: u64,
}

impl Replay {
    /// Whether a number is new; it is marked as seen.
    pub fn admits(&mut self, number: u64) -> bool {
        let Some(newest) = self.newest else {
            (self.newest, self.seen) = (Some(number), 1);
            return true;
        };
        if number > newest {
            let ahead = number - newest;
            let kept = if ahead < WINDOW {
                self.seen << ahead
            } else {
                0
            };
            (self.newest, self.seen) = (Some(number), kept | 1);
            return true;
        }
        let behind = newest - number;
        let new = behind < WINDOW && self.seen >> behind & 1 == 0;
        if new {
            self.seen |= 1 << behind;
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_a_signature_of_rfc_4231() {
        // Case 2: the key is "Jefe". The message is cut where the brace stands that a signature replaces.
        let key = Key::new("Jefe").expect("a key");
        let mut buffer = [0; 128];
        let message = b"what do ya want for nothing?}";
        buffer[..message.len()].copy_from_slice(message);
        let length = key.sign(&mut buffer, message.len()).expect("room");
        let signed = &buffer[..length];
        let text = std::str::from_utf8(signed).expect("text");
        let expected = "5bdcc146bf60754e6a042426089575c75a003f089d2739839dec58b964ec3843";
        assert_eq!(
            text,
            format!("what do ya want for nothing?,\"sig\":\"{expected}\"}}")
        );
        assert!(key.has_signed(signed));
        for index in 0..length {
            let mut changed = signed.to_vec();
            changed[index] ^= 1;
            assert!(!key.has_signed(&changed), "byte {index}");
        }
        assert!(!key.has_signed(message) && !key.has_signed(b""));
        let other = Key::new("jefe").expect("a key");
        assert!(!other.has_signed(signed));
        assert_eq!(key.sign(&mut [0; 40], 30), None);
    }

    #[test]
    fn a_number_is_taken_once_and_in_any_order_nearby() {
        let mut replay = Replay::default();
        let taken = [100, 102, 101, 102, 100, 39, 38, 400, 336, 337, 337, 101];
        let expected = [
            true, true, true, false, false, true, false, true, false, true, false, false,
        ];
        assert_eq!(taken.map(|number| replay.admits(number)), expected);
    }
}
